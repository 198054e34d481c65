//! New boxes for moved triangles in the old tree.

use super::{Bvh, union};
use incise_mesh::{Aabb, Surface, TriangleId};

impl Bvh {
    /// Fits all boxes to where the vertices are now. O(n). The triangles must be those that the
    /// tree was built over.
    pub fn refit(&mut self, surface: &Surface) {
        if !self.nodes.is_empty() {
            self.fit(surface, 0, true);
        }
    }

    /// Fits the boxes of `triangles` and of what is above them, O(m log n) for m of them. These must
    /// be all that moved since the boxes were fitted. Triangles that the tree does not have are none
    /// of its business.
    pub fn refit_moved(&mut self, surface: &Surface, triangles: &[TriangleId]) {
        for t in triangles {
            if let Some(leaf) = self.leaf_of(*t) {
                self.touch(leaf);
            }
        }
        if self.nodes.first().is_some_and(|root| root.touched) {
            self.fit(surface, 0, false);
        }
    }

    /// Fits a node that is touched, or any if `all` are to be.
    fn fit(&mut self, surface: &Surface, at: u32, all: bool) -> Aabb {
        let node = self.nodes[at as usize];
        let bounds = if node.is_leaf() {
            self.leaf_bounds(surface, &node)
        } else {
            let [left, right] = [node.index, node.index + 1].map(|child| {
                if all || self.nodes[child as usize].touched {
                    self.fit(surface, child, all)
                } else {
                    self.nodes[child as usize].bounds
                }
            });
            union(&left, &right)
        };
        let node = &mut self.nodes[at as usize];
        node.bounds = bounds;
        node.touched = false;
        bounds
    }

    /// Marks a node and all above it.
    pub(super) fn touch(&mut self, mut at: u32) {
        while !std::mem::replace(&mut self.nodes[at as usize].touched, true) && at != 0 {
            at = self.parent(at);
        }
    }
}
