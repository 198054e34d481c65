//! A change of topology as data, which solvers, BVHs and renderers follow.

use crate::ids::{TriangleId, VertexId};

/// The origin of a vertex that an edit created.
///
/// Positions, rest positions, velocities and other attributes are interpolated from it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum VertexOrigin {
    /// On the edge from `a` to `b`, at `a + t (b - a)`.
    OnEdge {
        /// First vertex of the edge.
        a: VertexId,
        /// Second vertex of the edge.
        b: VertexId,
        /// Position between them, 0 to 1.
        t: f32,
    },
    /// Inside an existing triangle, which a corner of the blade pierced.
    InFace {
        /// Corners of the triangle.
        corners: [VertexId; 3],
        /// Weights of the corners, 0 to 1; their sum is 1 within rounding.
        weights: [f32; 3],
    },
    /// Inside a cap, between three earlier vertices.
    ///
    /// Its rest position is stored: it may differ from the parents' mean where the rest positions
    /// along the rim are not affine. A corner of an incision's tip lies beside its parents.
    OnCap {
        /// The parents, which may be new vertices themselves.
        parents: [VertexId; 3],
        /// Weights of the parents, 0 to 1; their sum is 1 within rounding.
        weights: [f32; 3],
    },
    /// Restored by an undo.
    ///
    /// The parents moved in its place meanwhile: vertices that the edit created from it, else
    /// neighbors, else itself. Velocities are interpolated from them. The position and rest
    /// position are stored and need not lie between theirs.
    Restored {
        /// The vertices that moved in its place.
        parents: [VertexId; 3],
        /// Weights of the parents, 0 to 1; their sum is 1 within rounding.
        weights: [f32; 3],
    },
}

impl VertexOrigin {
    /// Returns the parents and their weights, whose sum is 1.
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
                // Normalized here, because thirds of f32 do not sum to 1.
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

    /// Returns the parents; one may be listed more than once.
    pub(crate) fn parents(&self) -> [VertexId; 3] {
        match *self {
            Self::OnEdge { a, b, .. } => [a, b, a],
            Self::InFace {
                corners: parents, ..
            }
            | Self::OnCap { parents, .. }
            | Self::Restored { parents, .. } => parents,
        }
    }

    /// Returns the origin with other parents.
    pub(crate) fn with_parents(self, new: impl Fn(VertexId) -> VertexId) -> Self {
        match self {
            Self::OnEdge { a, b, t } => Self::OnEdge {
                a: new(a),
                b: new(b),
                t,
            },
            Self::InFace { corners, weights } => Self::InFace {
                corners: corners.map(new),
                weights,
            },
            Self::OnCap { parents, weights } => Self::OnCap {
                parents: parents.map(new),
                weights,
            },
            Self::Restored { parents, weights } => Self::Restored {
                parents: parents.map(new),
                weights,
            },
        }
    }

    /// Interpolates the values that `at` returns for the parents.
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

/// A vertex that an edit created.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AddedVertex {
    /// The vertex.
    pub vertex: VertexId,
    /// Origin of the vertex. Parents that the same edit removed keep their data until the next
    /// edit.
    pub origin: VertexOrigin,
    /// Piece number of the vertex.
    pub piece: u32,
}

/// One edit of a surface: the input of a solver, BVH or renderer that follows it.
///
/// Apply removals first, because the same edit may reuse a freed slot.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TopologyDelta {
    /// Removed triangles with their former vertices.
    ///
    /// A triangle whose corners changed is removed and added.
    pub triangles_removed: Vec<(TriangleId, [VertexId; 3])>,
    /// Added triangles.
    pub triangles_added: Vec<TriangleId>,
    /// Removed vertices, ascending.
    ///
    /// Their data stays readable until the next edit, which never reuses a slot that it freed
    /// itself.
    pub vertices_removed: Vec<VertexId>,
    /// Last positions of removed vertices \[m\], shape
    /// [`vertices_removed`](Self::vertices_removed).
    ///
    /// Empty unless an undo gave their slots up.
    pub removed_positions: Vec<[f32; 3]>,
    /// Added vertices, parents before children.
    pub vertices_added: Vec<AddedVertex>,
    /// New pieces, each with the piece that it was split from.
    ///
    /// A piece that an undo restores from nothing is its own parent.
    pub pieces_added: Vec<(u32, u32)>,
    /// Removed pieces: without triangles, or merged again by an undo.
    pub pieces_removed: Vec<u32>,
}

impl TopologyDelta {
    /// Returns whether nothing changed.
    #[must_use]
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.triangles_removed.is_empty() && self.triangles_added.is_empty()
    }

    /// Returns the last position of a removed vertex \[m\], if the delta stores it.
    ///
    /// Otherwise the surface still has it. O(log k) for k removed vertices.
    #[must_use]
    pub fn removed_position(&self, v: VertexId) -> Option<[f32; 3]> {
        if self.removed_positions.is_empty() {
            return None;
        }
        let i = self.vertices_removed.binary_search(&v).ok()?;
        self.removed_positions.get(i).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_one_and_thirds_are_thirds() {
        let parents = [1, 2, 3].map(VertexId);
        let on_cap = |weights| VertexOrigin::OnCap { parents, weights };
        let third = on_cap([1.0 / 3.0; 3]).weights();
        assert_eq!(third, parents.map(|v| (v, 1.0 / 3.0)));
        let mixed = on_cap([0.2, 0.7, 0.1]).weights();
        assert!((mixed.iter().map(|w| w.1).sum::<f64>() - 1.0).abs() < 1e-15);
        let none = on_cap([0.0; 3]).weights();
        assert_eq!(none, third, "weights that say nothing weigh the same");
    }
}
