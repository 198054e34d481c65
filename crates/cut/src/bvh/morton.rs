//! Triangles along a curve that fills space.

use incise_mesh::geometry::widen;
use incise_mesh::{Aabb, Surface, TriangleId, Vec3};

/// Cells of the Morton grid along a side: 10 bits for each of three axes leave half of 64 for the id, so
/// that one number is compared. A million triangles of a surface share cells by threes and fours, which
/// a leaf holds.
const CELLS: f64 = (1u32 << 10) as f64;

/// Sorts triangles by where their middles lie along the curve.
pub(super) fn sort(surface: &Surface, triangles: &mut [(u64, TriangleId)]) {
    let mut bounds = Aabb::default();
    for &(_, t) in &*triangles {
        for v in surface.topology().triangle(t) {
            let [x, y, z, _] = surface.positions[v.index()];
            bounds.grow([x, y, z]);
        }
    }
    let min = widen(bounds.min);
    let scale = (widen(bounds.max) - min).map(|x| CELLS / x);
    for (code, t) in triangles.iter_mut() {
        let [a, b, c] = surface.triangle_positions(*t);
        let place = morton_code(((a + b + c) / 3.0 - min).component_mul(&scale));
        *code = (place << 32) | u64::from(t.0);
    }
    triangles.sort_unstable_by_key(|entry| entry.0);
}

/// The place of a cell along the curve.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a cell number; what is not finite goes anywhere"
)]
fn morton_code(cell: Vec3) -> u64 {
    (0..3)
        .map(|k| spread(cell[k].min(CELLS - 1.0) as u64) << k)
        .fold(0, |code, bits| code | bits)
}

/// The lower 10 bits of `x`, two zeros behind each.
const fn spread(mut x: u64) -> u64 {
    x &= 0x3ff;
    x = (x | (x << 16)) & 0x0300_00ff;
    x = (x | (x << 8)) & 0x0300_f00f;
    x = (x | (x << 4)) & 0x030c_30c3;
    (x | (x << 2)) & 0x0924_9249
}

#[cfg(test)]
mod tests {
    use super::spread;

    #[test]
    fn spread_bits_stand_three_apart() {
        for bit in 0..10 {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
        assert_eq!(spread(u64::MAX), spread(0x3ff), "only 10 bits count");
    }
}
