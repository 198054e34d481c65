//! Refits boxes to moved triangles.

use super::{Bvh, union};
use crate::{Aabb, Surface, TriangleId};

impl Bvh {
    /// Refits all boxes to the current positions, and joins pieces by place. O(n).
    ///
    /// The triangles must be those of the last build or update.
    pub fn refit(&mut self, surface: &Surface) {
        self.has_nonfinite = false;
        match self.nodes.first() {
            Some(root) if root.has_pieces => self.refit_pieces(surface),
            Some(_) => {
                self.fit(surface, 0, true);
            }
            None => {}
        }
    }

    /// Refits the boxes of `triangles` and of their ancestors. O(m log n) for m triangles.
    ///
    /// They must include all that moved since the last refit. Triangles that are not in the BVH are
    /// ignored.
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

    /// Refits a node if it is touched or `all` is set.
    pub(super) fn fit(&mut self, surface: &Surface, at: u32, all: bool) -> Aabb {
        let node = self.nodes[at as usize];
        let bounds = if node.is_leaf() {
            self.fit_leaf(surface, &node)
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

    /// Marks a node and its ancestors as touched.
    pub(super) fn touch(&mut self, mut at: u32) {
        while !std::mem::replace(&mut self.nodes[at as usize].touched, true) && at != 0 {
            at = self.parent(at);
        }
    }
}
