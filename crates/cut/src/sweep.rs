//! The surface that a blade's edge sweeps between two frames (the paper's Figure 1).

use crate::error::CutError;
use incise_mesh::geometry::{area_vector, to_f32, to_f64};
use incise_mesh::{Aabb, Vec3};
use robust::{Coord3D, orient3d};

/// The two triangles that a blade's edge spans between two frames.
///
/// Their corners are previous start, previous end, current end, and previous start, current end,
/// current start. They share the diagonal and need not lie in one plane. If the blade turned over
/// they overlap: the overlap is cut twice, and a piece without volume is left between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sweep {
    corners: [[f32; 3]; 4],
}

impl Sweep {
    /// Makes the sweep of a blade's edge (start, end) \[m\] from `previous` to `current`.
    ///
    /// # Errors
    /// [`CutError::SweepNotFinite`], and [`CutError::BladeDegenerate`] when neither triangle has an
    /// area.
    pub fn new(previous: [[f32; 3]; 2], current: [[f32; 3]; 2]) -> Result<Self, CutError> {
        let corners = [previous[0], previous[1], current[1], current[0]];
        if let Some(corner) = corners
            .iter()
            .position(|p| p.iter().any(|x| !x.is_finite()))
        {
            return Err(CutError::SweepNotFinite { corner });
        }
        let sweep = Self { corners };
        // Not the sum: in a bow tie, a blade that turned over, the two cancel.
        if sweep
            .triangles()
            .iter()
            .all(|&t| area_vector(t).norm() == 0.0)
        {
            return Err(CutError::BladeDegenerate);
        }
        Ok(sweep)
    }

    /// Makes a flat sweep along the plane `normal . x = d` that cuts everything in `bounds`.
    ///
    /// It is one large triangle, since four rounded corners would not lie in one plane. The last
    /// corner repeats the third, so the second triangle has no area.
    ///
    /// # Errors
    /// [`CutError::BladeDegenerate`] for a normal without a direction, [`CutError::SweepNotFinite`]
    /// for numbers that are not finite or boxes at the end of the range of `f32`.
    pub fn from_plane(normal: [f64; 3], d: f64, bounds: &Aabb) -> Result<Self, CutError> {
        let normal = Vec3::from(normal);
        // Scaled first, so that neither tiny nor huge normals under- or overflow.
        let largest = normal.amax();
        if largest == 0.0 {
            return Err(CutError::BladeDegenerate);
        }
        if !largest.is_finite() || !d.is_finite() {
            return Err(CutError::SweepNotFinite { corner: 0 });
        }
        let scaled = normal / largest;
        let length = scaled.norm();
        let n = scaled / length;
        let d = d / largest / length;
        let center = bounds.center();
        let reach = bounds.diagonal().max(f64::from(f32::MIN_POSITIVE));
        // A plane far off the box would leave the range of coordinates; any plane off it misses.
        let distance = (d - n.dot(&center)).clamp(-2.0 * reach, 2.0 * reach);
        let on_plane = center + n * distance;
        let side = Vec3::ith(n.iamin(), 1.0);
        let u = n.cross(&side).normalize();
        let v = n.cross(&u);
        // The projection of the box has a radius of at most half a diagonal; the incircle of the
        // triangle is half as wide again.
        let inradius = 0.75 * reach;
        let corner = |s: f64, t: f64| to_f32(on_plane + (u * s + v * t) * inradius);
        let root = 3.0_f64.sqrt();
        let top = corner(0.0, 2.0);
        Self::new([corner(-root, -1.0), corner(root, -1.0)], [top, top])
    }

    /// Returns the corners \[m\]: previous start, previous end, current end, current start.
    ///
    /// Those of [`Self::from_plane`] end with the same corner twice.
    #[must_use]
    pub const fn corners(&self) -> [[f32; 3]; 4] {
        self.corners
    }

    /// Returns the two triangles \[m\]. The shared diagonal runs from the first to the third
    /// corner.
    #[must_use]
    pub fn triangles(&self) -> [[Vec3; 3]; 2] {
        let [a, b, c, d] = self.corners.map(to_f64);
        [[a, b, c], [a, c, d]]
    }

    /// Returns the bounding box.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::around(self.corners)
    }

    /// Returns whether the segment between two points intersects or touches the sweep.
    ///
    /// Decided by exact predicates.
    #[must_use]
    pub fn intersects_segment(&self, from: [f32; 3], to: [f32; 3]) -> bool {
        let point = |p: [f32; 3]| {
            let [x, y, z] = p.map(f64::from);
            Coord3D { x, y, z }
        };
        let [a, b, c, d] = self.corners.map(point);
        let (p, q) = (point(from), point(to));
        [[a, b, c], [a, c, d]].into_iter().any(|[a, b, c]| {
            let sides = [p, q].map(|end| orient3d(a, b, c, end));
            let turns = [(a, b), (b, c), (c, a)].map(|(s, t)| orient3d(p, q, s, t));
            let is_one_side =
                |signs: &[f64]| signs.iter().all(|&s| s >= 0.0) || signs.iter().all(|&s| s <= 0.0);
            // All turns are zero if the segment lies in the plane, where nothing is cut, or if the
            // triangle has no area.
            let is_crossed = sides[0] * sides[1] <= 0.0 && turns.iter().any(|&t| t != 0.0);
            is_crossed && is_one_side(&turns)
        })
    }

    /// Returns the cutting plane of Algorithm 2, lines 15 and 16: a point and the unit normal.
    ///
    /// The normal of a bent sweep is the mean of the two triangles' weighted by area, or the first
    /// one's if they cancel.
    #[must_use]
    pub fn plane(&self) -> (Vec3, Vec3) {
        let [a, b, c, d] = self.corners.map(to_f64);
        let sum = (c - a).cross(&(d - b));
        let normal = sum.try_normalize(0.0);
        let normal = normal.unwrap_or_else(|| area_vector([a, b, c]).normalize());
        ((a + b + c + d) / 4.0, normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_across_a_box_covers_it_at_any_scale() {
        for scale in [1e-15f32, 1.0, 1e9] {
            let bounds = Aabb::around([[-scale; 3], [2.0 * scale, scale, scale]]);
            let n = [0.3, -2.0, 0.5];
            let sweep = Sweep::from_plane(n, 0.1 * f64::from(scale), &bounds).unwrap();
            let (p, unit) = sweep.plane();
            assert!((unit - Vec3::from(n).normalize()).norm() < 1e-6);
            assert!(
                (Vec3::from(n).dot(&p) - 0.1 * f64::from(scale)).abs() < 1e-6 * f64::from(scale)
            );
        }
    }

    #[test]
    fn a_plane_across_a_box_is_one_triangle_around_its_shadow() {
        let bounds = Aabb::around([[-1.0, 3.0, 0.5], [2.0, 4.0, 7.0]]);
        for n in [[1.0, 0.0, 0.0], [0.3, -2.0, 0.5], [-1.0, 1.0, 1.0]] {
            let n = Vec3::from(n).normalize();
            let sweep = Sweep::from_plane(n.into(), n.dot(&bounds.center()), &bounds).unwrap();
            let [[a, b, c], none] = sweep.triangles();
            assert_eq!(none[1], none[2], "the second triangle has no area");
            for i in 0..8 {
                let pick = |k: usize| [bounds.min, bounds.max][i >> k & 1][k];
                let corner = to_f64(std::array::from_fn(pick));
                for (p, q) in [(a, b), (b, c), (c, a)] {
                    // Along the normal nothing changes, so the corner need not be on the plane.
                    let inside = (q - p).cross(&(corner - p)).dot(&n) / (q - p).norm();
                    assert!(inside > 0.1 * bounds.diagonal(), "{inside} beside an edge");
                }
            }
        }
    }

    #[test]
    fn a_plane_far_away_misses_and_is_no_error() {
        for scale in [1e-20f32, 1.0] {
            let bounds = Aabb::around([[-scale; 3], [scale; 3]]);
            for d in [-1e300, -1e9, 0.01, 1e39] {
                let sweep = Sweep::from_plane([0.3, 1.0, 0.2], d, &bounds).unwrap();
                assert_eq!(sweep.bounds().overlaps(&bounds), d == 0.01 && scale == 1.0);
            }
        }
    }

    #[test]
    fn a_sweep_without_area_is_refused() {
        let bounds = Aabb::around([[0.0; 3], [1.0; 3]]);
        let none = Sweep::from_plane([0.0; 3], 1.0, &bounds);
        assert_eq!(none, Err(CutError::BladeDegenerate));
        let edge = [[0.0; 3], [1.0, 0.0, 0.0]];
        assert_eq!(Sweep::new(edge, edge), Err(CutError::BladeDegenerate));
        let nan = Sweep::new(edge, [[0.0, 1.0, 0.0], [f32::NAN, 1.0, 0.0]]);
        assert_eq!(nan, Err(CutError::SweepNotFinite { corner: 2 }));
        let line = Sweep::new(edge, [[3.0, 0.0, 0.0], [5.0, 0.0, 0.0]]);
        assert_eq!(line, Err(CutError::BladeDegenerate));
    }

    #[test]
    fn a_bow_tie_has_the_plane_of_its_triangles() {
        let bow_tie = Sweep::new(
            [[-1.0, 0.5, -1.0], [-1.0, 0.5, 1.0]],
            [[1.0, 0.5, 1.0], [1.0, 0.5, -1.0]],
        );
        let (point, normal) = bow_tie.unwrap().plane();
        assert_eq!((point.y, normal), (0.5, Vec3::new(0.0, 1.0, 0.0)));
    }
}
