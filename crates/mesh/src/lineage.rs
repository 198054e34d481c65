//! [`Lineage`]: the vertices from which the vertices of an edited surface are interpolated.

use crate::delta::TopologyDelta;
use crate::ids::{VertexId, index_u32};
use crate::surface::Surface;

/// Ids of vertices through any number of edits: those of the input, then created ones in order.
///
/// An edit may reuse a vertex slot that an earlier one freed; an id is used once. Values of the
/// input's vertices follow through the weights of the parents, row by row.
#[derive(Debug, Clone, Default)]
pub struct Lineage {
    input_count: u32,
    id_of_slot: Vec<u32>,
    parents: Vec<[u32; 3]>,
    weights: Vec<[f64; 3]>,
}

impl Lineage {
    /// Creates the lineage of a surface, whose vertex slots are the first ids.
    #[must_use]
    pub fn new(surface: &Surface) -> Self {
        let input_count = index_u32(surface.topology().vertex_slots());
        Self {
            input_count,
            id_of_slot: (0..input_count).collect(),
            ..Self::default()
        }
    }

    /// Gives ids to the vertices that an edit added.
    pub fn follow(&mut self, delta: &TopologyDelta) {
        for added in &delta.vertices_added {
            let origin = added.origin.weights();
            let row = origin.map(|(v, _)| self.id(v));
            let slot = added.vertex.index();
            if slot >= self.id_of_slot.len() {
                self.id_of_slot.resize(slot + 1, VertexId::NULL.0);
            }
            self.id_of_slot[slot] = self.input_count + index_u32(self.parents.len());
            self.parents.push(row);
            self.weights.push(origin.map(|(_, weight)| weight));
        }
    }

    /// Returns the number of vertex slots of the input: the first id of a created vertex.
    #[must_use]
    pub fn input_count(&self) -> u32 {
        self.input_count
    }

    /// Returns the id of a vertex; [`u32::MAX`] for a slot that was never used.
    #[must_use]
    pub fn id(&self, v: VertexId) -> u32 {
        let id = self.id_of_slot.get(v.index());
        id.copied().unwrap_or(VertexId::NULL.0)
    }

    /// Returns the ids of the parents of each created vertex, all of them before its own.
    #[must_use]
    pub fn parents(&self) -> &[[u32; 3]] {
        &self.parents
    }

    /// Returns the weights of the parents of each created vertex; their sum is 1 within rounding.
    #[must_use]
    pub fn weights(&self) -> &[[f64; 3]] {
        &self.weights
    }
}
