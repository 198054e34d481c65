//! Build from scratch: triangles in Morton order, halved again and again.
//!
//! Sorting by Morton code (Lauterbach et al. 2009) costs half of what splitting along the longest
//! side at every node does, and a query takes as long.

use super::{Bvh, LEAF_SIZE, NONE, Node, Part};
use incise_mesh::{Surface, TriangleId};

impl Bvh {
    /// A tree over all triangles of `surface`. O(n log n).
    #[must_use]
    pub fn build(surface: &Surface) -> Self {
        let mut bvh = Self::default();
        bvh.rebuild(surface);
        bvh
    }

    /// Builds the tree anew in the memory that it has. O(n log n).
    pub fn rebuild(&mut self, surface: &Surface) {
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
        sorted.extend(surface.topology().triangles());
        if !sorted.is_empty() {
            self.scratch.curve.sort(surface, &mut sorted);
            // The root's pair comes first.
            self.nodes.resize(2, Node::default());
            self.samples.resize(2, NONE);
            self.parents.push(0);
            let root = self.plant(surface, &sorted);
            self.put(0, root);
        }
        self.scratch.sorted = sorted;
    }

    /// Makes a subtree over triangles in their order.
    pub(super) fn plant(&mut self, surface: &Surface, sorted: &[TriangleId]) -> Part {
        if sorted.len() <= LEAF_SIZE {
            return self.leaf(surface, sorted.iter().copied());
        }
        // A multiple of the leaf size on the left fills all leaves but one.
        let half = (sorted.len() / 2).next_multiple_of(LEAF_SIZE);
        // Before its children's: the nodes of a fresh tree stand in the order in which it is walked.
        let pair = self.new_pair();
        let left = self.plant(surface, &sorted[..half]);
        let right = self.plant(surface, &sorted[half..]);
        self.join(pair, left, right)
    }
}
