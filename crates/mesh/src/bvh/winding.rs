//! Winding numbers of points.

use super::Bvh;
use crate::geometry::{area_vector, to_f64};
use crate::{Aabb, Surface, TriangleId, Vec3};

impl Bvh {
    /// Returns how often triangles enclose a point: their winding number.
    ///
    /// Only triangles for which `counts` is true are read; they must form closed surfaces. It is 0
    /// outside, 1 inside and 2 where parts of a piece overlap. Reversed surfaces count -1. A point
    /// on a triangle may be on either side. The BVH must be fitted.
    ///
    /// Sums the signed crossings of a ray along the axis on which the box of the BVH ends first.
    #[must_use]
    pub fn winding_number(
        &self,
        surface: &Surface,
        point: Vec3,
        counts: impl Fn(TriangleId) -> bool,
    ) -> i32 {
        let ray = Ray::shortest(&self.bounds(), point);
        let mut sum = 0;
        self.visit(
            surface,
            |bounds| ray.touches(bounds),
            |t| {
                if counts(t) {
                    sum += ray.crossing(surface, t);
                }
            },
        );
        sum
    }
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
    use crate::cube_sphere;

    /// Returns the winding numbers of points of the y axis, whose rays cross edges and corners.
    fn along_y<const N: usize>(surface: &Surface, heights: [f64; N]) -> [i32; N] {
        let bvh = Bvh::build(surface);
        let at = |y| Vec3::new(0.0, y, 0.0);
        heights.map(|y| bvh.winding_number(surface, at(y), |_| true))
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
            let found = bvh.winding_number(&ring, at, |_| true);
            assert_eq!(found, count, "at {x}");
        }
    }
}
