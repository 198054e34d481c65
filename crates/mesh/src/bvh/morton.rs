//! Sorts triangles along a Morton curve.

use super::{least, most, triangle_bounds, union};
use crate::{Aabb, Surface, TriangleId};

/// Sorts triangles by the Morton codes of their centers.
pub(crate) fn sort_along_curve(surface: &Surface, triangles: &mut [TriangleId]) {
    Curve::default().sort(surface, triangles);
}

/// Scratch memory of a sort.
#[derive(Debug, Clone, Default)]
pub(super) struct Curve {
    /// Morton code and, in the low bits, the triangle: sorting one word takes half the time of two.
    keys: Vec<u64>,
    centers: Vec<[f32; 3]>,
    unsorted: Vec<TriangleId>,
}

impl Curve {
    /// Sorts triangles by the Morton codes of their centers.
    pub(super) fn sort(&mut self, surface: &Surface, triangles: &mut [TriangleId]) {
        let mut bounds = Aabb::default();
        self.centers.clear();
        self.centers.extend(triangles.iter().map(|&t| {
            let corners = surface.topology().triangle(t);
            bounds = union(&bounds, &triangle_bounds(surface, corners));
            let [a, b, c] = corners.map(|v| surface.positions[v.index()]);
            std::array::from_fn::<f32, 3, _>(|k| (a[k] + b[k] + c[k]) / 3.0)
        }));
        let numbers = triangles.len().next_power_of_two().ilog2();
        let bits = ((u64::BITS - numbers) / 3).min(21);
        let grid = Grid::new(&bounds, bits);
        self.keys.clear();
        let numbered = (0_u64..).zip(&self.centers);
        (self.keys).extend(numbered.map(|(i, &center)| (grid.code(center) << numbers) | i));
        self.keys.sort_unstable();
        self.unsorted.clear();
        self.unsorted.extend_from_slice(triangles);
        let number = (1_u64 << numbers) - 1;
        for (t, key) in triangles.iter_mut().zip(&self.keys) {
            let i = usize::try_from(key & number).expect("numbers come from the slice");
            *t = self.unsorted[i];
        }
    }
}

/// A grid of cells over a box.
pub(super) struct Grid {
    min: [f32; 3],
    /// Cells per meter.
    scale: [f32; 3],
    last: f32,
}

impl Grid {
    /// Returns a grid of 2 to the power of `bits` cells along each side.
    pub(super) fn new(bounds: &Aabb, bits: u32) -> Self {
        let cells = f32::from_bits((127 + bits) << 23);
        Self {
            min: bounds.min,
            scale: std::array::from_fn(|k| cells / (bounds.max[k] - bounds.min[k])),
            last: cells - 1.0,
        }
    }

    /// Returns the Morton code of a point's cell; arbitrary for a point that is not finite.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a saturating cast of a cell number"
    )]
    pub(super) fn code(&self, point: [f32; 3]) -> u64 {
        let cell = |k: usize| {
            let along = (point[k] - self.min[k]) * self.scale[k];
            u64::from(least(self.last, most(0.0, along)) as u32)
        };
        (0..3).fold(0, |code, k| code | spread(cell(k)) << k)
    }
}

/// Inserts two zeros after each of the lower 21 bits of `x`.
const fn spread(mut x: u64) -> u64 {
    x &= 0x1f_ffff;
    x = (x | (x << 32)) & 0x001f_0000_0000_ffff;
    x = (x | (x << 16)) & 0x001f_0000_ff00_00ff;
    x = (x | (x << 8)) & 0x100f_00f0_0f00_f00f;
    x = (x | (x << 4)) & 0x10c3_0c30_c30c_30c3;
    (x | (x << 2)) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_bits_stand_three_apart() {
        for bit in 0..21 {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
        assert_eq!(spread(u64::MAX), spread(0x1f_ffff), "only 21 bits count");
    }

    #[test]
    fn neighbors_in_space_are_neighbors_along_the_curve() {
        let bounds = Aabb::around([[0.0; 3], [8.0, 8.0, 4.0]]);
        let grid = Grid::new(&bounds, 2);
        // The curve visits all cells of one half before the other.
        let code = |x, y, z| grid.code([x, y, z]);
        assert_eq!(code(0.5, 0.5, 0.5), 0);
        assert_eq!(code(3.9, 0.5, 0.5), 1);
        assert_eq!(code(0.5, 2.5, 1.5), 6);
        assert_eq!(
            code(8.0, 8.0, 4.0),
            63,
            "the far corner is in the last cell"
        );
        assert!(code(3.9, 7.9, 1.9) < code(0.0, 0.0, 2.1), "z counts most");
    }
}
