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
    /// Inside a cap, at the mean of three vertices made before it.
    OnCap {
        /// The three vertices, some of which may be new themselves.
        parents: [VertexId; 3],
    },
}

impl Origin {
    /// The parents and their weights, which sum to 1.
    #[must_use]
    pub fn weights(&self) -> [(VertexId, f64); 3] {
        match *self {
            Self::OnEdge { a, b, t } => [(a, 1.0 - f64::from(t)), (b, f64::from(t)), (a, 0.0)],
            Self::OnCap { parents } => parents.map(|v| (v, 1.0 / 3.0)),
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
    /// Triangles that went, with the vertices that they had.
    pub triangles_removed: Vec<(TriangleId, [VertexId; 3])>,
    /// Triangles that came.
    pub triangles_added: Vec<TriangleId>,
    /// Vertices that went, ascending. Their data stays readable until the next edit: an edit never
    /// reuses a vertex slot that it freed itself.
    pub vertices_removed: Vec<VertexId>,
    /// Vertices that came, parents before children.
    pub vertices_added: Vec<AddedVertex>,
    /// Pieces that the edit made out of one, each with the piece that it was part of before.
    pub pieces_added: Vec<(u32, u32)>,
    /// Pieces that are no more: nothing of them was left.
    pub pieces_removed: Vec<u32>,
}

impl TopologyDelta {
    /// Whether nothing changed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.triangles_removed.is_empty() && self.triangles_added.is_empty()
    }
}
