//! Joins of triangles in corners of a body that lie between scanlines.

use crate::body::Body;
use crate::grid::{MARGIN, ROUNDING};
use crate::overlap::{clip_triangle, is_in_box};
use incise_mesh::geometry::area_vector;
use incise_mesh::{Partition, TriangleId, Vec3, index_u32};

/// Joins triangles of a cell that no scanline has met to the opposite triangles in the cell.
///
/// They belong to corners of the body between scanlines. Elements are triangles, then spans.
/// Returns whether there are such triangles: their joins depend on pieces.
pub(crate) fn join_thin(
    body: &Body<'_>,
    cell: [u32; 3],
    triangles: &[TriangleId],
    corners: &[[Vec3; 3]],
    sets: &mut Partition,
) -> bool {
    let count = index_u32(triangles.len());
    let mut has_span = vec![false; triangles.len()];
    for element in count..index_u32(sets.len()) {
        let root = sets.find(element);
        if let Some(has_span) = has_span.get_mut(root as usize) {
            *has_span = true;
        }
    }
    let is_lone = |i: &u32| !has_span[sets.find(*i) as usize];
    let lone: Vec<u32> = (0..count).filter(is_lone).collect();
    if lone.is_empty() {
        return false;
    }
    let planes: Vec<Plane> = corners.iter().map(Plane::new).collect();
    let size = body.grid.cell_size();
    let margin = Vec3::repeat(MARGIN * size);
    let own_box = [
        body.grid.corner(cell, 0) - margin,
        body.grid.corner(cell, 7) + margin,
    ];
    for i in lone {
        let (mut sum, mut corner_count) = (Vec3::zeros(), 0.0);
        clip_triangle(&corners[i as usize], own_box[0], own_box[1], |p| {
            sum += p;
            corner_count += 1.0;
        });
        let inward = (-planes[i as usize].normal).try_normalize(0.0);
        let (Some(inward), true) = (inward, corner_count > 0.0) else {
            continue;
        };
        let center = sum / corner_count;
        let piece = |i: u32| body.piece(triangles[i as usize]);
        let facing = (0..count).zip(&planes).filter_map(|(other, plane)| {
            let at = plane.exit(center, inward)?;
            let place = center + inward * at;
            let is_hit = other != i
                && at > ROUNDING * size
                && is_in_box(&place, &own_box)
                && is_inside(&corners[other as usize], plane.normal, place)
                && piece(other) == piece(i);
            is_hit.then_some((at, other))
        });
        let nearest = facing.min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, other)) = nearest {
            sets.join(i, other);
        }
    }
    true
}

/// The plane of a triangle.
#[derive(Debug, Clone, Copy)]
struct Plane {
    /// The triangle's area vector, which points out of the body.
    normal: Vec3,
    point: Vec3,
}

impl Plane {
    fn new(corners: &[Vec3; 3]) -> Self {
        Self {
            normal: area_vector(*corners),
            point: corners[0],
        }
    }

    /// Returns the distance at which a ray leaves the body through the plane \[m\].
    fn exit(&self, from: Vec3, along: Vec3) -> Option<f64> {
        let speed = self.normal.dot(&along);
        (speed > 0.0).then(|| self.normal.dot(&(self.point - from)) / speed)
    }
}

/// Returns whether a point of a triangle's plane is in the triangle.
fn is_inside(corners: &[Vec3; 3], normal: Vec3, place: Vec3) -> bool {
    (0..3).all(|k| {
        let [a, b] = [corners[k], corners[(k + 1) % 3]];
        (b - a).cross(&(place - a)).dot(&normal) >= 0.0
    })
}
