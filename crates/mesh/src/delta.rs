//! A change of topology as data.

use crate::ids::{TriangleId, VertexId};

/// Where a vertex that an edit made came from. Positions, rest positions, velocities and whatever
/// else a vertex carries are interpolated from it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Origin {
    /// On the edge from `a` to `b`, at `a + t (b - a)`.
    OnEdge {
        /// The edge's first vertex.
        a: VertexId,
        /// The edge's second vertex.
        b: VertexId,
        /// Where between them, 0 to 1.
        t: f32,
    },
    /// Inside a triangle that the edit found: where a corner of the blade pierced it.
    InFace {
        /// The triangle's corners.
        corners: [VertexId; 3],
        /// Their weights, 0 to 1, which sum to 1 but for rounding.
        weights: [f32; 3],
    },
    /// Inside a cap, between three vertices made before it. Its rest position is set: where the rim's rest
    /// positions are no affine function of the place in the cap, it may be smoother than their mean.
    OnCap {
        /// The three vertices, some of which may be new themselves.
        parents: [VertexId; 3],
        /// Their weights, 0 to 1, which sum to 1 but for rounding.
        weights: [f32; 3],
    },
    /// There before an edit that has been undone, and back again. The parents moved in its place
    /// meanwhile: vertices that the edit had made from it, else neighbors; a vertex without any is its
    /// own parent. Velocities and the like follow them. Its position and rest position are set and
    /// need not lie between theirs.
    Restored {
        /// The vertices that moved in its place.
        parents: [VertexId; 3],
        /// Their weights, 0 to 1, which sum to 1 but for rounding.
        weights: [f32; 3],
    },
}

impl Origin {
    /// The parents and their weights, which sum to 1.
    #[must_use]
    pub fn weights(&self) -> [(VertexId, f64); 3] {
        match *self {
            Self::OnEdge { a, b, t } => [(a, 1.0 - f64::from(t)), (b, f64::from(t)), (a, 0.0)],
            Self::InFace {
                corners: parents,
                weights,
            }
            | Self::OnCap { parents, weights }
            | Self::Restored { parents, weights } => {
                // Made to sum to 1 here: thirds of f32 do not.
                let weights = weights.map(f64::from);
                let sum: f64 = weights.iter().sum();
                let shares = if sum > 0.0 {
                    weights.map(|weight| weight / sum)
                } else {
                    [1.0 / 3.0; 3]
                };
                [0, 1, 2].map(|i| (parents[i], shares[i]))
            }
        }
    }

    /// The value at the new vertex of what `at` gives at its parents.
    pub fn interpolate<const N: usize>(&self, at: impl Fn(VertexId) -> [f32; N]) -> [f64; N] {
        let mut sum = [0.0; N];
        for (v, weight) in self.weights() {
            for (total, value) in sum.iter_mut().zip(at(v)) {
                *total += weight * f64::from(value);
            }
        }
        sum
    }
}

/// A vertex that an edit made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AddedVertex {
    /// Its id.
    pub vertex: VertexId,
    /// Where it came from. Parents that were removed by the same edit keep their data until the
    /// next one.
    pub origin: Origin,
    /// The piece that it belongs to.
    pub piece: u32,
}

/// One edit of a surface, in full: what a solver, a BVH or a renderer needs to follow it.
///
/// Removals come first: a slot that was freed may be used again by the same edit.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TopologyDelta {
    /// Triangles that went, with the vertices that they had. One that got other corners went and came.
    pub triangles_removed: Vec<(TriangleId, [VertexId; 3])>,
    /// Triangles that came.
    pub triangles_added: Vec<TriangleId>,
    /// Vertices that went, ascending. Their data stays readable until the next edit: an edit never
    /// reuses a vertex slot that it freed itself.
    pub vertices_removed: Vec<VertexId>,
    /// Where the vertices that went were \[m\], shape [`vertices_removed`](Self::vertices_removed), if
    /// the surface does not know it any more: an undo gives their slots up. Empty else.
    pub removed_from: Vec<[f32; 3]>,
    /// Vertices that came, parents before children.
    pub vertices_added: Vec<AddedVertex>,
    /// Pieces that the edit made out of one, each with the piece that it was part of before. A piece
    /// of which nothing was there and that an undo brings back names itself.
    pub pieces_added: Vec<(u32, u32)>,
    /// Pieces that are no more: nothing of them was left, or an undo gave their triangles back to the
    /// pieces that they came from.
    pub pieces_removed: Vec<u32>,
}

impl TopologyDelta {
    /// Whether nothing changed.
    #[must_use]
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.triangles_removed.is_empty() && self.triangles_added.is_empty()
    }

    /// Where a vertex that went was \[m\], if the delta says so; else the surface still does.
    /// O(log k) for k vertices that went.
    #[must_use]
    pub fn place_of_removed(&self, v: VertexId) -> Option<[f32; 3]> {
        let i = self.vertices_removed.binary_search(&v).ok()?;
        self.removed_from.get(i).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_one_and_thirds_are_thirds() {
        let parents = [1, 2, 3].map(VertexId);
        let on_cap = |weights| Origin::OnCap { parents, weights };
        let third = on_cap([1.0 / 3.0; 3]).weights();
        assert_eq!(third, parents.map(|v| (v, 1.0 / 3.0)));
        let mixed = on_cap([0.2, 0.7, 0.1]).weights();
        assert!((mixed.iter().map(|w| w.1).sum::<f64>() - 1.0).abs() < 1e-15);
        let none = on_cap([0.0; 3]).weights();
        assert_eq!(none, third, "weights that say nothing weigh the same");
    }
}
