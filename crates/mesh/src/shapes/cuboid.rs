//! Boxes: their sides divided into squares.

use super::sphere::finish;
use crate::geometry::Vec3;
use crate::ids::VertexId;
use crate::surface::Surface;
use rustc_hash::FxHashMap;

/// Returns a box around the origin with half sides `half` \[m\].
///
/// `squares` (at least 1 each) are the numbers of squares along x, y and z, of two triangles with
/// alternating diagonals.
///
/// # Panics
/// If the ids exceed 32 bits: above 10,000 squares along an edge.
#[must_use]
pub fn cuboid(half: [f64; 3], squares: [u32; 3]) -> Surface {
    let squares = squares.map(|n| n.max(1));
    let (points, quads) = quads(squares);
    let place = |point: &[u32; 3]| {
        Vec3::from_fn(|k, _| half[k] * (2.0 * f64::from(point[k]) / f64::from(squares[k]) - 1.0))
    };
    let points: Vec<Vec3> = points.iter().map(place).collect();
    let mut faces = Vec::with_capacity(2 * quads.len());
    for (i, [a, b, c, d]) in quads.into_iter().enumerate() {
        faces.extend(if i % 2 == 0 {
            [[a, b, c], [a, c, d]]
        } else {
            [[a, b, d], [b, c, d]]
        });
    }
    finish(&points, &faces, 1.0)
}

/// Returns the points on the sides of a box, by their numbers along each axis, and its squares.
pub(super) fn quads(squares: [u32; 3]) -> (Vec<[u32; 3]>, Vec<[u32; 4]>) {
    let mut ids: FxHashMap<[u32; 3], u32> = FxHashMap::default();
    let (mut points, mut quads) = (Vec::new(), Vec::new());
    for side in 0..6 {
        let axis = side / 2;
        let (along, across) = ((axis + 1) % 3, (axis + 2) % 3);
        let at_far_end = side % 2 == 1;
        for (i, j) in (0..squares[across]).flat_map(|j| (0..squares[along]).map(move |i| (i, j))) {
            let mut quad = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(di, dj)| {
                let mut point = [0; 3];
                point[axis] = if at_far_end { squares[axis] } else { 0 };
                point[along] = i + di;
                point[across] = j + dj;
                *ids.entry(point).or_insert_with(|| {
                    points.push(point);
                    VertexId::from_index(points.len() - 1).0
                })
            });
            if !at_far_end {
                quad.reverse();
            }
            quads.push(quad);
        }
    }
    (points, quads)
}
