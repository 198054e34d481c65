//! Folds: edges at which a surface lies flat on itself.

use super::Surface;
use crate::geometry::{Vec3, area_vector};
use crate::ids::{HalfEdge, VertexId};

/// Maximum distance of coplanar neighbors from the plane of one of them \[longest side\].
///
/// About a hundred roundings of coordinates as large as that side.
const MAX_HEIGHT: f64 = 1e-5;

/// Maximum error of a distance by the rounding of four points \[largest coordinate\].
///
/// Each is off by at most half an epsilon along each axis, so by less than one in all.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

/// Maximum error of the angle at an edge, above which it is unknown \[rad\].
///
/// Half a degree: the angle of a fold is 180 degrees, and that of the sharpest edge of a mesh is
/// smaller by more than this.
const MAX_ANGLE_ERROR: f64 = 1e-2;

impl Surface {
    /// Iterates over the edges at which the surface is folded flat. O(n).
    ///
    /// The two triangles of such an edge are coplanar, with opposite normals. A triangle that is
    /// thin within rounding has no fold.
    ///
    /// The walls of an incision coincide, so they meet in folds at its tip. Their triangles have
    /// the material of caps.
    pub fn folds(&self) -> impl Iterator<Item = HalfEdge> + '_ {
        self.folds_at(|v| self.position(v))
    }

    /// Iterates over the edges at which the rest shape is folded flat, see [`Surface::folds`].
    pub fn rest_folds(&self) -> impl Iterator<Item = HalfEdge> + '_ {
        self.folds_at(|v| self.rest_position(v))
    }

    fn folds_at<'a>(
        &'a self,
        at: impl Fn(VertexId) -> Vec3 + 'a,
    ) -> impl Iterator<Item = HalfEdge> + 'a {
        let topology = &self.topology;
        topology.edges().filter(move |&h| {
            let twin = topology.twin(h);
            !twin.is_null()
                && is_fold([h, h.next(), h.prev(), twin.prev()].map(|h| at(topology.origin(h))))
        })
    }
}

/// Returns whether the triangles `a b c` and `b a d` lie flat on each other.
fn is_fold([a, b, c, d]: [Vec3; 4]) -> bool {
    let [m, n] = [[a, b, c], [b, a, d]].map(area_vector);
    if m.dot(&n) >= 0.0 {
        return false;
    }
    let sides = [b - a, c - a, c - b, d - a, d - b].map(|side| side.norm());
    let size = sides.into_iter().fold(0.0, f64::max);
    let reach = [a, b, c, d]
        .map(|p| p.amax())
        .into_iter()
        .fold(0.0, f64::max);
    let rounding = ROUNDING * reach;
    let min_height = (MAX_HEIGHT * size).max(rounding / MAX_ANGLE_ERROR);
    let has_area = |n: Vec3| n.norm() > min_height * size;
    let max_height = MAX_HEIGHT * size + rounding;
    let height = |n: Vec3, p: Vec3| n.dot(&(p - a)).abs() / n.norm();
    has_area(m) && has_area(n) && height(m, d).max(height(n, c)) <= max_height
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{cube_sphere, icosphere, sheet, torus};

    /// Returns two triangles with a common side of 1 m along x, whose other corners are given.
    fn pair(c: [f32; 3], d: [f32; 3]) -> Surface {
        let positions = [[0.0; 3], [1.0, 0.0, 0.0], c, d];
        Surface::from_triangles(&positions, &[[0, 1, 2], [1, 0, 3]]).unwrap()
    }

    fn moved(mut surface: Surface, scale: f32, by: f32) -> Surface {
        for p in surface.positions_mut() {
            (0..3).for_each(|k| p[k] = scale * p[k] + by);
        }
        surface
    }

    fn count(surface: &Surface) -> usize {
        surface.folds().count()
    }

    #[test]
    fn neighbors_on_one_side_of_an_edge_are_a_fold() {
        let folded = pair([0.5, 1.0, 0.0], [0.2, 0.7, 0.0]);
        let edges: Vec<HalfEdge> = folded.folds().collect();
        let topology = folded.topology();
        let ends = edges
            .iter()
            .map(|&h| (topology.origin(h).0, topology.target(h).0));
        let ends: Vec<_> = ends.map(|(a, b)| (a.min(b), a.max(b))).collect();
        assert_eq!(ends, [(0, 1)]);
        // One on the other, as two walls at their tip.
        assert_eq!(count(&pair([0.5, 1.0, 0.0], [0.5, 1.0, 0.0])), 1);
        assert_eq!(count(&pair([0.5, 1.0, 0.0], [0.2, -0.7, 0.0])), 0);
    }

    #[test]
    fn an_angle_or_a_triangle_without_area_is_no_fold() {
        // Sharp, but open by 1/1000.
        assert_eq!(count(&pair([0.5, 1.0, 0.0], [0.2, 0.7, 1e-3])), 0);
        assert_eq!(count(&pair([0.5, 1.0, 0.0], [0.2, 0.7, 1e-6])), 1);
        assert_eq!(count(&pair([0.5, 1.0, 0.0], [0.2, 1e-6, 0.0])), 0);
        assert_eq!(count(&pair([0.5, 1.0, 0.0], [0.0; 3])), 0);
    }

    #[test]
    fn folds_do_not_depend_on_scale_and_place() {
        let folded = pair([0.5, 1.0, 0.25], [0.25, 0.5, 0.125]);
        for scale in [1e-6, 1.0, 1e6] {
            for by in [0.0, 10.0 * scale] {
                assert_eq!(count(&moved(folded.clone(), scale, by)), 1, "{scale} {by}");
                let open = pair([0.5, 1.0, 0.0], [0.2, 0.7, 1e-3]);
                assert_eq!(count(&moved(open, scale, by)), 0, "{scale} {by}");
            }
        }
        // So far away that no position has a digit of the triangles.
        assert_eq!(count(&moved(folded, 1.0, 1e8)), 0);
    }

    #[test]
    fn each_shape_has_folds_of_its_own() {
        let mut surface = pair([0.5, 1.0, 0.0], [0.2, -0.7, 0.0]);
        surface.positions_mut()[3][1] = 0.7;
        assert_eq!((count(&surface), surface.rest_folds().count()), (1, 0));
        surface.rest_positions_mut()[3][1] = 0.7;
        surface.positions_mut()[3][1] = -0.7;
        assert_eq!((count(&surface), surface.rest_folds().count()), (0, 1));
    }

    #[test]
    fn smooth_shapes_have_none() {
        for surface in [
            icosphere(0, 1.0),
            icosphere(4, 0.5),
            cube_sphere(1, 0.5),
            torus(0.4, 0.15, 48, 24),
            sheet([1.0, 2.0], [5, 7]),
        ] {
            assert_eq!((count(&surface), surface.rest_folds().count()), (0, 0));
        }
    }
}
