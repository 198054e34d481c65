//! Triangulation of a file's polygons.

use crate::geometry::{Vec3, to_f64};
use robust::{Coord, orient2d};

/// Maximum number of corners for ear clipping, which takes O(n^2); larger polygons become fans.
const MAX_CLIPPED: usize = 256;

/// Triangulates the polygon `points` with n - 2 triangles of its own corners and orientation.
///
/// A convex polygon becomes a fan, any other is clipped ear by ear.
pub(super) fn triangulate(points: &[[f32; 3]], out: &mut Vec<[usize; 3]>) {
    out.clear();
    let n = points.len();
    let flat = if n > 3 { project(points) } else { Vec::new() };
    let convex =
        (0..flat.len()).all(|i| orient2d(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) > 0.0);
    let mut rest: Vec<usize> = (0..n).collect();
    if !convex && n <= MAX_CLIPPED {
        while rest.len() > 3 {
            let Some(i) = (0..rest.len()).find(|&i| is_ear(&flat, &rest, i)) else {
                break;
            };
            let m = rest.len();
            out.push([rest[(i + m - 1) % m], rest[i], rest[(i + 1) % m]]);
            rest.remove(i);
        }
    }
    out.extend((1..rest.len() - 1).map(|i| [rest[0], rest[i], rest[i + 1]]));
}

/// Projects the points along the axis closest to the polygon's normal, counterclockwise.
fn project(points: &[[f32; 3]]) -> Vec<Coord<f64>> {
    let origin = to_f64(points[0]);
    let normal: Vec3 = points
        .windows(2)
        .map(|pair| (to_f64(pair[0]) - origin).cross(&(to_f64(pair[1]) - origin)))
        .sum();
    let axis = normal.iamax();
    let (mut u, mut v) = ((axis + 1) % 3, (axis + 2) % 3);
    if normal[axis] < 0.0 {
        (u, v) = (v, u);
    }
    points
        .iter()
        .map(|p| Coord {
            x: f64::from(p[u]),
            y: f64::from(p[v]),
        })
        .collect()
}

/// Returns whether the corner turns left and its triangle contains no other corner.
fn is_ear(flat: &[Coord<f64>], rest: &[usize], i: usize) -> bool {
    let m = rest.len();
    let corners = [rest[(i + m - 1) % m], rest[i], rest[(i + 1) % m]];
    let [a, b, c] = corners.map(|k| flat[k]);
    orient2d(a, b, c) > 0.0
        && !rest.iter().any(|&k| {
            let p = flat[k];
            !corners.contains(&k)
                && orient2d(a, b, p) >= 0.0
                && orient2d(b, c, p) >= 0.0
                && orient2d(c, a, p) >= 0.0
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::area_vector;
    use proptest::prelude::*;

    fn area_sum(points: &[[f32; 3]]) -> (f64, f64) {
        let mut triangles = Vec::new();
        triangulate(points, &mut triangles);
        assert_eq!(triangles.len(), points.len() - 2);
        let areas: Vec<Vec3> = triangles
            .iter()
            .map(|t| area_vector(t.map(|i| to_f64(points[i]))) / 2.0)
            .collect();
        (
            areas.iter().sum::<Vec3>().norm(),
            areas.iter().map(|a| a.norm()).sum(),
        )
    }

    #[test]
    fn a_concave_polygon_is_covered_once() {
        let star: Vec<[f32; 3]> = (0..10u8)
            .map(|i| {
                let (angle, r) = (
                    f32::from(i) * std::f32::consts::PI / 5.0,
                    if i % 2 == 0 { 1.0 } else { 0.3 },
                );
                [0.5, r * angle.cos(), r * angle.sin()]
            })
            .collect();
        let (signed, unsigned) = area_sum(&star);
        assert!((signed - unsigned).abs() < 1e-12, "{signed} {unsigned}");
        let arrow = [
            [0.0, 0.0, 0.0],
            [2.0, 1.0, 0.0],
            [0.0, 2.0, 0.0],
            [0.5, 1.0, 0.0],
        ];
        assert_eq!(area_sum(&arrow), (1.5, 1.5));
    }

    #[test]
    fn corners_on_a_straight_edge_make_no_flat_triangle() {
        let points = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [0.0, 2.0, 0.0],
        ];
        let mut triangles = Vec::new();
        triangulate(&points, &mut triangles);
        for t in triangles {
            assert!(
                area_vector(t.map(|i| to_f64(points[i]))).norm() > 0.0,
                "{t:?}"
            );
        }
    }

    proptest! {
        #[test]
        fn any_polygon_gives_two_triangles_less_than_corners(
            points in prop::collection::vec(prop::array::uniform3(-2i8..3), 3..20),
        ) {
            let points: Vec<[f32; 3]> = points.iter().map(|p| p.map(f32::from)).collect();
            let mut triangles = Vec::new();
            triangulate(&points, &mut triangles);
            prop_assert_eq!(triangles.len(), points.len() - 2);
            // Every side of the polygon occurs once, in its own direction.
            for i in 0..points.len() {
                let side = (i, (i + 1) % points.len());
                let runs = triangles
                    .iter()
                    .flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])])
                    .filter(|&e| e == side)
                    .count();
                prop_assert_eq!(runs, 1);
            }
        }
    }
}
