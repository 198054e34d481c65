//! The exact cyclic order of triangles around an edge, and its wedges of material.

use crate::ids::HalfEdge;
use robust::{Coord, Coord3D, orient2d, orient3d};
use std::cmp::Ordering;

/// A triangle at an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct IncidentTriangle {
    /// The triangle's half-edge along the edge.
    pub(super) half_edge: HalfEdge,
    /// The patch of the triangle.
    pub(super) patch: u32,
    /// Whether material follows the triangle counterclockwise. Otherwise material precedes it.
    pub(super) starts: bool,
    /// Rank of the triangle's angle; equal for coplanar triangles on the same side.
    pub(super) angle: u32,
}

type Point = [f64; 3];

fn coord([x, y, z]: Point) -> Coord3D<f64> {
    Coord3D { x, y, z }
}

/// Returns whether three points lie on a line, and if not, an axis along which they do not.
fn axis_across(a: Point, b: Point, c: Point) -> Option<usize> {
    (0..3).find(|&axis| side_along(axis, a, b, c) != 0.0)
}

/// Returns the side of `c` at the line from `a` to `b`, projected along an axis.
fn side_along(axis: usize, a: Point, b: Point, c: Point) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| Coord {
        x: p[(axis + 1) % 3],
        y: p[(axis + 2) % 3],
    });
    orient2d(a, b, c)
}

/// Sorts the triangles around the edge from `a` to `b` counterclockwise, seen from `b`.
///
/// At equal angles, triangles that end material precede triangles that start it. This avoids empty
/// wedges between them. Returns false, and sorts nothing, if a triangle has no area.
pub(super) fn sort_around(
    [a, b]: [Point; 2],
    spokes: &mut [IncidentTriangle],
    apex: impl Fn(&IncidentTriangle) -> Point,
) -> bool {
    let Some(first) = spokes.first().map(&apex) else {
        return true;
    };
    let Some(axis) = axis_across(a, b, first) else {
        return false;
    };
    if spokes.iter().any(|s| axis_across(a, b, apex(s)).is_none()) {
        return false;
    }
    let counterclockwise = |p: Point, q: Point| -orient3d(coord(a), coord(b), coord(p), coord(q));
    let reference = side_along(axis, a, b, first) > 0.0;
    // The half-plane of the first triangle, the half-space after it, the opposite half-plane, and
    // the half-space before it.
    let sector = |p: Point| match counterclockwise(first, p).partial_cmp(&0.0) {
        Some(Ordering::Greater) => 1,
        Some(Ordering::Less) => 3,
        _ if (side_along(axis, a, b, p) > 0.0) == reference => 0,
        _ => 2,
    };
    let by_angle = |s: &IncidentTriangle, t: &IncidentTriangle| {
        let (p, q) = (apex(s), apex(t));
        sector(p).cmp(&sector(q)).then_with(|| {
            0.0_f64
                .partial_cmp(&counterclockwise(p, q))
                .unwrap_or(Ordering::Equal)
        })
    };
    spokes.sort_by(|s, t| by_angle(s, t).then(s.starts.cmp(&t.starts)));
    let mut angle = 0;
    for i in 1..spokes.len() {
        angle += u32::from(by_angle(&spokes[i - 1], &spokes[i]) != Ordering::Equal);
        spokes[i].angle = angle;
    }
    spokes[0].angle = 0;
    true
}

/// Returns the pairs of sorted triangles that bound wedges of material, or of void.
///
/// Returns nothing unless material starts and ends by turns.
pub(super) fn wedges(spokes: &[IncidentTriangle], of_void: bool) -> Option<Vec<[HalfEdge; 2]>> {
    let n = spokes.len();
    let alternates = (0..n).all(|i| spokes[i].starts != spokes[(i + 1) % n].starts);
    if n == 0 || !alternates {
        return None;
    }
    let first = usize::from(spokes[0].starts == of_void);
    Some(
        (0..n / 2)
            .map(|i| [first + 2 * i, (first + 2 * i + 1) % n].map(|i| spokes[i].half_edge))
            .collect(),
    )
}

/// Returns the one of three sorted triangles that lies within the material of the other two.
pub(super) fn inner_of_three(spokes: &[IncidentTriangle; 3]) -> Option<&IncidentTriangle> {
    let odd = (0..3).find(|&i| {
        let [p, q] = [1, 2].map(|k| spokes[(i + k) % 3].starts);
        p == q && p != spokes[i].starts
    })?;
    let [after, before] = [1, 2].map(|k| &spokes[(odd + k) % 3]);
    if after.angle == before.angle {
        return None;
    }
    Some(if spokes[odd].starts { after } else { before })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn spoke(i: u32, starts: bool) -> IncidentTriangle {
        IncidentTriangle {
            half_edge: HalfEdge(i),
            patch: i,
            starts,
            angle: 0,
        }
    }

    fn order(spokes: &[IncidentTriangle]) -> Vec<u32> {
        spokes.iter().map(|s| s.half_edge.0).collect()
    }

    #[test]
    fn triangles_are_sorted_counterclockwise() {
        let apexes = [
            [1.0, 0.0, 0.5],
            [0.0, -1.0, 0.0],
            [-2.0, 0.0, 0.0],
            [0.0, 3.0, 7.0],
            [5.0, 0.0, -1.0],
            [1.0, 1.0, 0.0],
        ];
        let mut spokes: Vec<IncidentTriangle> = (0..6).map(|i| spoke(i, i != 4)).collect();
        let edge = [[0.0; 3], [0.0, 0.0, 1.0]];
        let sorted = sort_around(edge, &mut spokes, |s| apexes[s.half_edge.0 as usize]);
        assert!(sorted, "all triangles have an area");
        // Triangles 0 and 4 have equal angles, and 4 ends material.
        assert_eq!(order(&spokes), [4, 0, 5, 3, 2, 1]);
        let angles: Vec<u32> = spokes.iter().map(|s| s.angle).collect();
        assert_eq!(angles, [0, 0, 1, 2, 3, 4]);
        let on_edge = [0.0, 0.0, 9.0];
        assert!(!sort_around(edge, &mut spokes, |_| on_edge), "no area");
    }

    #[test]
    fn wedges_need_alternating_triangles() {
        let spokes = [
            spoke(0, false),
            spoke(1, true),
            spoke(2, false),
            spoke(3, true),
        ];
        let pairs = |of_void| {
            let pairs = wedges(&spokes, of_void).unwrap();
            pairs.iter().map(|p| p.map(|h| h.0)).collect::<Vec<_>>()
        };
        assert_eq!(pairs(false), [[1, 2], [3, 0]]);
        assert_eq!(pairs(true), [[0, 1], [2, 3]]);
        assert_eq!(wedges(&spokes[..3], false), None);
    }

    proptest! {
        /// The cyclic order does not depend on the order of the triangles, nor on the first one.
        #[test]
        fn the_order_is_that_of_the_angles(
            points in prop::collection::vec((-50..50i8, -50..50i8, -9..9i8), 1..9),
            by in 0..9usize,
        ) {
            let points: Vec<Point> = points
                .iter()
                .filter(|p| (p.0, p.1) != (0, 0))
                .map(|&(x, y, z)| [x, y, z].map(f64::from))
                .collect();
            prop_assume!(!points.is_empty());
            let mut spokes: Vec<IncidentTriangle> =
                (0..).zip(&points).map(|(i, _)| spoke(i, true)).collect();
            spokes.rotate_left(by % points.len());
            let apex = |s: &IncidentTriangle| points[s.half_edge.0 as usize];
            prop_assert!(sort_around([[0.0; 3], [0.0, 0.0, 2.0]], &mut spokes, apex));
            let angle = |s: &IncidentTriangle| apex(s)[1].atan2(apex(s)[0]);
            let turns: f64 = (0..spokes.len())
                .map(|i| {
                    let next = &spokes[(i + 1) % spokes.len()];
                    let turn = (angle(next) - angle(&spokes[i])).rem_euclid(std::f64::consts::TAU);
                    if next.angle == spokes[i].angle { 0.0 } else { turn }
                })
                .sum();
            let distinct = spokes.last().is_some_and(|s| s.angle > 0);
            let expected = if distinct { std::f64::consts::TAU } else { 0.0 };
            prop_assert!((turns - expected).abs() < 1e-9, "{turns}");
        }
    }
}
