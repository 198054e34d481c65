//! The surface that a blade's edge sweeps between two frames (the paper's Figure 1).

use crate::error::CutError;
use incise_mesh::geometry::{area_vector, to_f32, to_f64};
use incise_mesh::{Aabb, Vec3};
use robust::{Coord3D, orient3d};
use smallvec::SmallVec;

/// The strip of triangles that a blade's edge spans between two frames.
///
/// The edge is a polyline of n points, two for a straight blade. Points i and i + 1 of both
/// frames span two triangles, which share the diagonal from the previous point i to the current
/// point i + 1 and need not lie in one plane. If the blade turned over they overlap: the overlap
/// is cut twice, and a piece without volume is left between.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sweep {
    /// The points of the previous frame, then those of the current one.
    #[cfg_attr(feature = "serde", serde(with = "points"))]
    points: SmallVec<[[f32; 3]; 4]>,
}

/// Saves points like a `Vec`.
#[cfg(feature = "serde")]
mod points {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use smallvec::SmallVec;

    type Points = SmallVec<[[f32; 3]; 4]>;

    pub(super) fn serialize<S: Serializer>(points: &Points, to: S) -> Result<S::Ok, S::Error> {
        points.as_slice().serialize(to)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Points, D::Error> {
        Vec::deserialize(from).map(SmallVec::from_vec)
    }
}

/// Checks the numbers of points of a polyline, see [`Sweep::strip`].
fn check_lengths(previous: &[[f32; 3]], current: &[[f32; 3]]) -> Result<(), CutError> {
    let (previous, current) = (previous.len(), current.len());
    if previous < 2 || previous != current {
        return Err(CutError::PolylineLength { previous, current });
    }
    Ok(())
}

impl Sweep {
    /// Makes the sweep of a straight blade's edge (start, end) \[m\] from `previous` to `current`.
    ///
    /// # Errors
    /// As [`Self::strip`].
    pub fn new(previous: [[f32; 3]; 2], current: [[f32; 3]; 2]) -> Result<Self, CutError> {
        Self::strip(&previous, &current)
    }

    /// Makes the sweep of a polyline \[m\] from `previous` to `current`.
    ///
    /// # Errors
    /// [`CutError::PolylineLength`] unless both have the same number of points, at least two;
    /// [`CutError::SweepNotFinite`]; and [`CutError::BladeDegenerate`] when no triangle has an
    /// area.
    pub fn strip(previous: &[[f32; 3]], current: &[[f32; 3]]) -> Result<Self, CutError> {
        check_lengths(previous, current)?;
        let sweep = Self {
            points: previous.iter().chain(current).copied().collect(),
        };
        sweep.check()?;
        Ok(sweep)
    }

    /// Checks the points, see [`Self::strip`].
    pub(crate) fn check(&self) -> Result<(), CutError> {
        let (previous, current) = self.points.split_at(self.points.len() / 2);
        check_lengths(previous, current)?;
        if let Some(corner) = (self.points.iter()).position(|p| p.iter().any(|x| !x.is_finite())) {
            return Err(CutError::SweepNotFinite { corner });
        }
        // Not the sum: in a bow tie, a blade that turned over, the two cancel.
        if (self.triangles()).all(|t| area_vector(t).norm() == 0.0) {
            return Err(CutError::BladeDegenerate);
        }
        Ok(())
    }

    /// Returns the sweep that ends displaced by `length` \[m\], off its plane and along its motion.
    ///
    /// Points that stand still, and those for which `is_fixed` holds, keep their places.
    ///
    /// # Errors
    /// As [`Self::strip`].
    pub(crate) fn displaced(
        &self,
        length: f64,
        is_fixed: impl Fn(usize) -> bool,
    ) -> Result<Self, CutError> {
        let (_, normal) = self.plane();
        let (from, to) = (self.previous(), self.current());
        let motion: Vec3 = from
            .iter()
            .zip(to)
            .map(|(&p, &q)| to_f64(q) - to_f64(p))
            .sum();
        let along = motion.try_normalize(0.0).unwrap_or_default();
        // Not in any plane of the sweep or across it, which may be those of mesh edges.
        let offset = (normal + along * 0.6).normalize() * length;
        let moved = (0..to.len()).map(|i| {
            if to[i] == from[i] || is_fixed(i) {
                to[i]
            } else {
                to_f32(to_f64(to[i]) + offset)
            }
        });
        Self::strip(from, &moved.collect::<Vec<_>>())
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

    /// Returns the blade's points in the previous frame \[m\].
    #[must_use]
    pub fn previous(&self) -> &[[f32; 3]] {
        &self.points[..self.points.len() / 2]
    }

    /// Returns the blade's points in the current frame \[m\].
    ///
    /// Those of [`Self::from_plane`] are equal.
    #[must_use]
    pub fn current(&self) -> &[[f32; 3]] {
        &self.points[self.points.len() / 2..]
    }

    /// Returns the ends of the blade's edge in the previous and in the current frame \[m\].
    #[must_use]
    pub fn ends(&self) -> [[[f32; 3]; 2]; 2] {
        [self.previous(), self.current()].map(|edge| [edge[0], edge[edge.len() - 1]])
    }

    /// Returns the previous points, then the current ones \[m\].
    #[must_use]
    pub fn points(&self) -> &[[f32; 3]] {
        &self.points
    }

    /// Iterates over the triangles \[m\]: two between each two neighbors of the polyline.
    ///
    /// Of points a and b and their current positions c and d these are a, b, d and a, d, c.
    pub fn triangles(&self) -> impl Iterator<Item = [Vec3; 3]> + '_ {
        let n = self.points.len() / 2;
        let point = |i: usize| to_f64(self.points[i]);
        (0..n - 1).flat_map(move |i| {
            let [a, b, c, d] = [i, i + 1, n + i, n + i + 1].map(point);
            [[a, b, d], [a, d, c]]
        })
    }

    /// Returns the bounding box.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::around(self.points.iter().copied())
    }

    /// Returns whether the segment between two points intersects or touches the sweep.
    ///
    /// Decided by exact predicates.
    #[must_use]
    pub fn intersects_segment(&self, from: [f32; 3], to: [f32; 3]) -> bool {
        let point = |p: Vec3| Coord3D {
            x: p.x,
            y: p.y,
            z: p.z,
        };
        let (p, q) = (point(to_f64(from)), point(to_f64(to)));
        self.triangles().any(|triangle| {
            let [a, b, c] = triangle.map(point);
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
    /// The normal of a bent sweep is the mean of the triangles' weighted by area, or the first
    /// one's if they cancel.
    #[must_use]
    pub fn plane(&self) -> (Vec3, Vec3) {
        let sum: Vec3 = self.triangles().map(area_vector).sum();
        let mut normals = self.triangles().map(|t| area_vector(t).try_normalize(0.0));
        let normal = (sum.try_normalize(0.0)).or_else(|| normals.find_map(|normal| normal));
        let points = self.points.iter().map(|&p| to_f64(p));
        (
            points.sum::<Vec3>() / self.points.len() as f64,
            normal.expect("a triangle of the sweep has an area"),
        )
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
            let triangles: Vec<_> = sweep.triangles().collect();
            let ([a, b, c], none) = (triangles[0], triangles[1]);
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
        assert_eq!(nan, Err(CutError::SweepNotFinite { corner: 3 }));
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
