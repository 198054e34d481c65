//! The top of a tree: nodes of several pieces, ordered by place.
//!
//! A cut joins the new piece beside the piece that it was cut from. Later the two move apart, and a
//! node that still joins them has a box as large as the body. A full refit therefore rebuilds all
//! nodes above the pieces, so that a query visits the pieces near it only.

use super::morton::Grid;
use super::{Bvh, MAX_HEIGHT, Part, union};
use crate::{Aabb, Surface};

/// Number of bits of a cell along each axis.
const BITS: u32 = 21;

/// Subtrees of one piece each, in memory reused between refits.
#[derive(Debug, Clone, Default)]
pub(super) struct Pieces {
    /// Morton code of the center, and the subtree.
    parts: Vec<(u64, Part)>,
    /// Sum of the weights before each subtree: 2 to the power of the heights.
    sums: Vec<f64>,
    stack: Vec<u32>,
}

impl Pieces {
    pub(super) fn clear(&mut self) {
        self.parts.clear();
    }

    pub(super) fn push(&mut self, part: Part) {
        self.parts.push((0, part));
    }

    /// Sorts the subtrees along a Morton curve.
    fn sort(&mut self) {
        let each = self.parts.iter().map(|(_, part)| part.node.bounds);
        let bounds = each.fold(Aabb::default(), |a, b| union(&a, &b));
        let grid = Grid::new(&bounds, BITS);
        for (code, part) in &mut self.parts {
            let Aabb { min, max } = part.node.bounds;
            *code = grid.code(std::array::from_fn(|k| (min[k] + max[k]) / 2.0));
        }
        // Samples are unique, so the order is total.
        (self.parts).sort_unstable_by_key(|(code, part)| (*code, part.sample));
        self.sums.clear();
        self.sums.push(0.0);
        let mut sum = 0.0;
        for (_, part) in &self.parts {
            sum += f64::from(part.node.height).exp2();
            self.sums.push(sum);
        }
    }

    /// Returns the subtree before which to split a range: near the middle of the weights.
    fn split(&self, from: usize, to: usize) -> usize {
        let middle = f64::midpoint(self.sums[from], self.sums[to]);
        let after = self.sums[from..to].partition_point(|&sum| sum < middle) + from;
        let is_before = middle - self.sums[after - 1] < self.sums[after] - middle;
        (after - usize::from(is_before)).clamp(from + 1, to - 1)
    }
}

impl Bvh {
    /// Refits all subtrees of one piece and joins them by place.
    pub(super) fn refit_pieces(&mut self, surface: &Surface) {
        let mut pieces = std::mem::take(&mut self.scratch.pieces);
        pieces.clear();
        pieces.stack.clear();
        pieces.stack.push(0);
        while let Some(at) = pieces.stack.pop() {
            let node = self.nodes[at as usize];
            if node.has_pieces {
                self.free_pairs.push(node.index / 2);
                pieces.stack.extend([node.index + 1, node.index]);
            } else {
                self.fit(surface, at, true);
                let (node, sample) = (self.nodes[at as usize], self.samples[at as usize]);
                pieces.push(Part { node, sample });
            }
        }
        let root = self.join_pieces(&mut pieces);
        self.put(0, root);
        self.scratch.pieces = pieces;
        if root.node.height as usize > MAX_HEIGHT {
            self.rebuild(surface);
        }
    }

    /// Joins fitted subtrees, at least one, by place.
    pub(super) fn join_pieces(&mut self, pieces: &mut Pieces) -> Part {
        pieces.sort();
        self.join_sorted(pieces, 0, pieces.parts.len())
    }

    fn join_sorted(&mut self, pieces: &Pieces, from: usize, to: usize) -> Part {
        if to - from == 1 {
            return pieces.parts[from].1;
        }
        let at = pieces.split(from, to);
        let pair = self.new_pair();
        let left = self.join_sorted(pieces, from, at);
        let right = self.join_sorted(pieces, at, to);
        let mut all = self.join(pair, left, right);
        all.node.has_pieces = true;
        all
    }
}
