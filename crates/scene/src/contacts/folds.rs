//! Contacts within a piece: they touch from outside, not through the piece.
//!
//! Where a piece is thin, crushed or turned inside out, its sides face each other like those of a
//! fold. A contact would pull one through the other and hold it there. [`enclosures`] of the space
//! between the two tells a fold from that: it is outside, or within both of its layers.

use super::persistent::PersistentContact;
use crate::body::Body;
use incise_mesh::geometry::{area_vector, to_f64};
use incise_mesh::{Aabb, Bvh, Surface, TriangleId, Vec3};

/// Distance of features that coincide [thicknesses]: nothing is between them.
const COINCIDENT: f64 = 0.02;

/// Fraction of the way to a triangle's center: at a rim, the point behind it is in the piece.
const INWARD: f64 = 0.05;

/// Returns whether a vertex at `at` touches a triangle of its own closed piece from outside.
///
/// `column` is scratch memory. The body's BVH must be fitted.
pub(super) fn is_from_outside(
    body: &Body,
    (contact, at): (&PersistentContact, Vec3),
    thickness: f64,
    column: &mut Vec<TriangleId>,
) -> bool {
    let (surface, t) = (body.surface(), contact.triangle);
    let piece = surface.piece(t);
    let shape = body.piece_shapes().get(piece);
    if shape.is_sheet {
        return true;
    }
    // In a cavity, the space that the wall does not enclose counts -1.
    let outside = if shape.is_cavity { -1 } else { 0 };
    let mut enclosures = |point| enclosures((surface, body.bvh()), piece, point, column);
    let corners = surface.triangle_positions(t);
    let normal = area_vector(corners);
    let near = COINCIDENT * thickness;
    if contact.offset.norm() > near {
        let is_in_front = normal.dot(&contact.offset) > 0.0;
        let between = at - contact.offset / 2.0;
        let layers = enclosures(between) - outside;
        return layers == if is_in_front { 0 } else { 2 };
    }
    let Some(normal) = normal.try_normalize(0.0) else {
        return false;
    };
    let center = (corners[0] + corners[1] + corners[2]) / 3.0;
    let point = at - contact.offset;
    let behind = point + (center - point) * INWARD - normal * near;
    enclosures(behind) > outside
}

/// Returns how often a piece encloses a point: the winding number of its surface.
///
/// Counts the signed crossings of a ray along the axis on which the body ends first.
fn enclosures(
    (surface, bvh): (&Surface, &Bvh),
    piece: u32,
    point: Vec3,
    column: &mut Vec<TriangleId>,
) -> i32 {
    let ray = Ray::shortest(&bvh.bounds(), point);
    column.clear();
    bvh.traverse(surface, |bounds| ray.touches(bounds), column);
    let own = column.iter().filter(|&&t| surface.piece(t) == piece);
    own.map(|&t| ray.crossing(surface, t)).sum()
}

/// A ray along an axis.
#[derive(Debug, Clone, Copy)]
struct Ray {
    start: Vec3,
    axis: usize,
    is_up: bool,
}

impl Ray {
    /// Creates the ray from a point to the nearest side of a box.
    fn shortest(bounds: &Aabb, start: Vec3) -> Self {
        let [min, max] = [bounds.min, bounds.max].map(to_f64);
        let mut ray = Self {
            start,
            axis: 0,
            is_up: true,
        };
        let mut shortest = f64::INFINITY;
        for axis in 0..3 {
            let ways = [max[axis] - start[axis], start[axis] - min[axis]];
            for (way, is_up) in ways.into_iter().zip([true, false]) {
                if way < shortest {
                    shortest = way;
                    (ray.axis, ray.is_up) = (axis, is_up);
                }
            }
        }
        ray
    }

    /// Returns the other two axes, in the order in which they turn to the axis of the ray.
    fn across(&self) -> [usize; 2] {
        [(self.axis + 1) % 3, (self.axis + 2) % 3]
    }

    /// Returns whether the ray may enter a box.
    fn touches(&self, bounds: &Aabb) -> bool {
        let [min, max] = [bounds.min, bounds.max].map(to_f64);
        let is_ahead = if self.is_up {
            max[self.axis] >= self.start[self.axis]
        } else {
            min[self.axis] <= self.start[self.axis]
        };
        let mut across = self.across().into_iter();
        is_ahead && across.all(|k| (min[k]..=max[k]).contains(&self.start[k]))
    }

    /// Returns 1 if the ray leaves a closed surface through a triangle, -1 if it enters it, or 0.
    ///
    /// It is the winding number of the projected triangle. Both triangles of an edge compute the
    /// same for it, so that no ray passes between them.
    fn crossing(&self, surface: &Surface, t: TriangleId) -> i32 {
        let corners = surface.triangle_positions(t);
        let ([u, v], at) = (self.across(), self.start);
        let mut turns = 0;
        for (from, to) in [0, 1, 2].map(|i| (corners[i], corners[(i + 1) % 3])) {
            let is_rising = from[v] <= at[v];
            if is_rising == (to[v] <= at[v]) {
                continue;
            }
            let (low, high) = if is_rising { (from, to) } else { (to, from) };
            let (along, off) = (high - low, at - low);
            if along[u] * off[v] - along[v] * off[u] > 0.0 {
                turns += if is_rising { 1 } else { -1 };
            }
        }
        let height = area_vector(corners).dot(&(at - corners[0])) * f64::from(turns);
        let is_ahead = height != 0.0 && (height < 0.0) == self.is_up;
        match (is_ahead, self.is_up) {
            (false, _) => 0,
            (true, true) => turns,
            (true, false) => -turns,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use incise_mesh::cube_sphere;

    /// Returns the winding numbers of points of the y axis, whose rays cross edges and corners.
    fn along_y<const N: usize>(surface: &Surface, heights: [f64; N]) -> [i32; N] {
        let bvh = Bvh::build(surface);
        let at = |y| Vec3::new(0.0, y, 0.0);
        heights.map(|y| enclosures((surface, &bvh), 0, at(y), &mut Vec::new()))
    }

    #[test]
    fn a_piece_encloses_a_point_once_and_a_reversed_one_minus_once() {
        let heights = [-1.1, -0.9, -0.5, 0.0, 0.5, 0.9, 1.1];
        let mut ball = cube_sphere(4, 1.0);
        assert_eq!(along_y(&ball, heights), [0, 1, 1, 1, 1, 1, 0]);
        for p in ball.positions_mut() {
            p[1] = -p[1];
        }
        assert_eq!(along_y(&ball, heights), [0, -1, -1, -1, -1, -1, 0]);
    }

    #[test]
    fn overlapping_ends_of_a_piece_enclose_a_point_twice() {
        // A cigar along x is bent around z by more than a turn.
        let mut ring = cube_sphere(12, 1.0);
        for p in ring.positions_mut() {
            let (sin, cos) = (1.2 * std::f32::consts::PI * p[0]).sin_cos();
            let radius = 1.0 + 0.2 * p[1];
            *p = [radius * cos, radius * sin, -0.2 * p[2], p[3]];
        }
        let bvh = Bvh::build(&ring);
        for (x, count) in [(0.0, 0), (1.0, 1), (-1.0, 2)] {
            let at = Vec3::new(x, 0.0, 0.0);
            let found = enclosures((&ring, &bvh), 0, at, &mut Vec::new());
            assert_eq!(found, count, "at {x}");
        }
    }
}
