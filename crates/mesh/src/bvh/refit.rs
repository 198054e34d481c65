//! Refits boxes to moved triangles.

use super::{Bvh, union};
use crate::{Aabb, Surface, TopologyDelta, TriangleId};

/// Edits of a surface that a BVH has not followed.
#[derive(Debug, Clone, Default)]
pub struct SurfaceEdits {
    /// Triangles that an edit has removed or added, in the order of the edits.
    triangles: Vec<TriangleId>,
    /// See [`TopologyDelta::pieces_added`].
    pieces: Vec<(u32, u32)>,
}

impl SurfaceEdits {
    /// Appends an edit. O(k) for k triangles.
    pub fn push(&mut self, delta: &TopologyDelta) {
        let removed = delta.triangles_removed.iter().map(|&(t, _)| t);
        self.triangles.extend(removed);
        self.triangles.extend_from_slice(&delta.triangles_added);
        self.pieces.extend_from_slice(&delta.pieces_added);
    }
}

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

    /// Refits all boxes after edits that the BVH has not followed. O(n + k log k) for k triangles.
    ///
    /// `edits` has all triangles that the edits removed and added, in any order and more than once
    /// for a slot that was reused, and the pieces that they split.
    pub fn refit_edited(&mut self, surface: &Surface, edits: &SurfaceEdits) {
        let mut touched = edits.triangles.clone();
        touched.sort_unstable();
        touched.dedup();
        if self.nodes.is_empty() || 2 * touched.len() > surface.topology().triangle_count() {
            self.rebuild(surface);
            return;
        }
        let mut blocks = Vec::new();
        for &t in &touched {
            if let Some(leaf) = self.leaf_of(t) {
                blocks.push(self.nodes[leaf as usize].index);
                self.remove(t);
            }
        }
        self.refit(surface);
        for block in blocks {
            // Fewer, if the refit has built the tree again.
            if let Some(&leaf) = self.leaves.get(block as usize) {
                self.touch(leaf);
            }
        }
        touched.retain(|&t| surface.topology().is_triangle(t));
        self.follow(surface, &touched, &edits.pieces);
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
