//! Builds a BVH from scratch: triangles in Morton order, split in halves.
//!
//! Every piece gets its own subtree. Sorting by Morton code (Lauterbach et al. 2009) is faster than
//! splitting along the longest axis at every node, for queries of the same speed.

use super::{Bvh, LEAF_SIZE, NONE, Node, Part};
use crate::{Surface, TriangleId};

impl Bvh {
    /// Builds a BVH over all triangles of `surface`. O(n log n).
    #[must_use]
    pub fn build(surface: &Surface) -> Self {
        let mut bvh = Self::default();
        bvh.rebuild(surface);
        bvh
    }

    /// Rebuilds the BVH in its own memory. O(n log n).
    pub fn rebuild(&mut self, surface: &Surface) {
        self.rebuild_with(surface, surface.topology().triangles());
    }

    /// Rebuilds the BVH, with some triangles of `surface` only. O(k log k) for k of them, and one
    /// pass over the slots of all.
    ///
    /// No other one is found by queries. It cannot be updated after an edit.
    pub fn rebuild_with(
        &mut self,
        surface: &Surface,
        triangles: impl IntoIterator<Item = TriangleId>,
    ) {
        self.has_nonfinite = false;
        self.nodes.clear();
        self.samples.clear();
        self.parents.clear();
        self.free_pairs.clear();
        self.blocks.clear();
        self.leaves.clear();
        self.free_blocks.clear();
        self.places.clear();
        self.places
            .resize(surface.topology().triangle_slots(), NONE);
        let mut sorted = std::mem::take(&mut self.scratch.sorted);
        sorted.clear();
        sorted.extend(triangles);
        if !sorted.is_empty() {
            self.scratch.curve.sort(surface, &mut sorted);
            // The root's pair comes first.
            self.nodes.resize(2, Node::default());
            self.samples.resize(2, NONE);
            self.parents.push(0);
            // A stable sort keeps the order along the curve.
            sorted.sort_by_key(|&t| surface.piece(t));
            let mut pieces = std::mem::take(&mut self.scratch.pieces);
            pieces.clear();
            for of_piece in sorted.chunk_by(|&a, &b| surface.piece(a) == surface.piece(b)) {
                pieces.push(self.plant(surface, of_piece));
            }
            let root = self.join_pieces(&mut pieces);
            self.put(0, root);
            self.scratch.pieces = pieces;
        }
        self.scratch.sorted = sorted;
    }

    /// Builds a subtree over sorted triangles.
    pub(super) fn plant(&mut self, surface: &Surface, sorted: &[TriangleId]) -> Part {
        if sorted.len() <= LEAF_SIZE {
            return self.leaf(surface, sorted.iter().copied());
        }
        // A multiple of the leaf size on the left fills all leaves but one.
        let half = (sorted.len() / 2).next_multiple_of(LEAF_SIZE);
        // Allocated before its children's pairs, so that nodes are stored in traversal order.
        let pair = self.new_pair();
        let left = self.plant(surface, &sorted[..half]);
        let right = self.plant(surface, &sorted[half..]);
        self.join(pair, left, right)
    }
}
