//! Build from scratch: triangles in Morton order, halved again and again.
//!
//! Sorting by Morton code (Lauterbach et al. 2009) costs half of what splitting along the longest
//! side at every node does, and a query takes as long.

use super::{Bvh, LEAF_SIZE, Node};
use incise_mesh::geometry::widen;
use incise_mesh::{Aabb, Surface, TriangleId, Vec3};

/// Cells of the Morton grid along a side: 21 bits for each of three axes fit 64.
const CELLS: f64 = (1u32 << 21) as f64;

impl Bvh {
    /// A tree over all triangles of `surface`. O(n log n).
    #[must_use]
    pub fn build(surface: &Surface) -> Self {
        let mut bvh = Self::default();
        bvh.rebuild(surface);
        bvh
    }

    /// Builds the tree anew in the memory that it has.
    pub fn rebuild(&mut self, surface: &Surface) {
        self.nodes.clear();
        self.order.clear();
        self.corners.clear();
        let bounds = surface.bounds();
        let mut sorted: Vec<(u64, TriangleId)> = surface
            .topology()
            .triangles()
            .map(|t| (morton_code(surface, t, &bounds), t))
            .collect();
        sorted.sort_unstable();
        for (_, t) in sorted {
            self.order.push(t);
            self.corners.push(surface.topology().triangle(t));
        }
        if !self.order.is_empty() {
            self.split(0, self.order.len());
        }
        self.refit(surface);
    }

    /// Makes the nodes over `count` triangles from `first` on.
    fn split(&mut self, first: usize, count: usize) {
        let node = self.nodes.len();
        let leaf = count <= LEAF_SIZE;
        self.nodes.push(Node {
            bounds: Aabb::default(),
            index: id(first),
            count: if leaf { id(count) } else { 0 },
        });
        if leaf {
            return;
        }
        // A multiple of the leaf size on the left fills all leaves but one.
        let half = (count / 2).next_multiple_of(LEAF_SIZE);
        self.split(first, half);
        self.nodes[node].index = id(self.nodes.len());
        self.split(first + half, count - half);
    }
}

/// The place of a triangle's middle along a curve that fills `bounds`.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a cell number; what is not finite goes anywhere"
)]
fn morton_code(surface: &Surface, t: TriangleId, bounds: &Aabb) -> u64 {
    let [a, b, c] = surface.triangle_positions(t);
    let middle = (a + b + c) / 3.0 - widen(bounds.min);
    let size: Vec3 = widen(bounds.max) - widen(bounds.min);
    (0..3)
        .map(|k| spread((middle[k] / size[k] * CELLS).min(CELLS - 1.0) as u64) << k)
        .fold(0, |code, bits| code | bits)
}

/// The lower 21 bits of `x`, two zeros behind each.
const fn spread(mut x: u64) -> u64 {
    x &= 0x1f_ffff;
    x = (x | (x << 32)) & 0x001f_0000_0000_ffff;
    x = (x | (x << 16)) & 0x001f_0000_ff00_00ff;
    x = (x | (x << 8)) & 0x100f_00f0_0f00_f00f;
    x = (x | (x << 4)) & 0x10c3_0c30_c30c_30c3;
    (x | (x << 2)) & 0x1249_2492_4924_9249
}

fn id(i: usize) -> u32 {
    u32::try_from(i).expect("a surface has fewer than 2^32 triangles")
}

#[cfg(test)]
mod tests {
    use super::spread;

    #[test]
    fn spread_bits_stand_three_apart() {
        for bit in 0..21 {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
        assert_eq!(spread(u64::MAX), spread(0x1f_ffff), "only 21 bits count");
    }
}
