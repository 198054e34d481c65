//! Origins of the vertices and faces of a cut mesh, collected from the changes of its cuts.

use incise::cut::CutOutcome;
use incise::mesh::{Surface, TriangleId, VertexId};

/// The material of walls and caps during a cut, which no input may have.
pub(crate) const NEW_FACE: u32 = u32::MAX;

/// Ids of vertices: those of the input, then those that cuts created, in their order.
///
/// A slot of the surface may be reused by a later step of a blade; an id is not.
pub(crate) struct Origins {
    id_of_slot: Vec<u32>,
    /// Number of vertices of the input.
    inputs: u32,
    /// Parents of each created vertex: ids before its own.
    pub(crate) parents: Vec<[u32; 3]>,
    /// Weights of the parents, with the sum 1.
    pub(crate) weights: Vec<[f64; 3]>,
    /// Whether a cut replaced the triangle in each slot of the input.
    is_changed: Vec<bool>,
    /// Whether materials number the faces of the input.
    has_face_numbers: bool,
}

impl Origins {
    /// Numbers the vertices of an input, and its faces by their materials.
    ///
    /// With `remeshes` the materials stay, since remeshing keeps borders between them. Then only
    /// faces that no cut changed have an origin.
    pub(crate) fn new(surface: &mut Surface, remeshes: bool) -> Self {
        let slots = surface.topology().vertex_slots();
        let triangles: Vec<TriangleId> = surface.topology().triangles().collect();
        if !remeshes {
            for &t in &triangles {
                surface.set_material(t, t.0);
            }
        }
        let inputs = u32::try_from(slots).expect("vertex ids have 32 bits");
        Self {
            id_of_slot: (0..inputs).collect(),
            inputs,
            parents: Vec::new(),
            weights: Vec::new(),
            is_changed: vec![false; triangles.len()],
            has_face_numbers: !remeshes,
        }
    }

    /// Adds the vertices of a cut.
    pub(crate) fn follow(&mut self, outcome: &CutOutcome) {
        for added in &outcome.delta.vertices_added {
            let weights = added.origin.weights();
            self.parents
                .push(weights.map(|(v, _)| self.id_of_slot[v.index()]));
            self.weights.push(weights.map(|(_, weight)| weight));
            let created = u32::try_from(self.parents.len()).expect("vertex ids have 32 bits");
            let slot = added.vertex.index();
            if slot >= self.id_of_slot.len() {
                self.id_of_slot.resize(slot + 1, u32::MAX);
            }
            self.id_of_slot[slot] = self.inputs + (created - 1);
        }
        let changed = outcome.delta.triangles_removed.iter().map(|(t, _)| t);
        for t in changed.chain(&outcome.delta.triangles_added) {
            if let Some(is_changed) = self.is_changed.get_mut(t.index()) {
                *is_changed = true;
            }
        }
    }

    /// Returns the id of a vertex.
    pub(crate) fn vertex(&self, v: VertexId) -> u32 {
        self.id_of_slot[v.index()]
    }

    /// Returns the face of the input in which a face lies; -1 for walls, caps and unknown ones.
    pub(crate) fn face(&self, surface: &Surface, t: TriangleId) -> i64 {
        let material = surface.material(t);
        match self.is_changed.get(t.index()) {
            _ if material == NEW_FACE => -1,
            _ if self.has_face_numbers => i64::from(material),
            Some(false) => i64::from(t.0),
            _ => -1,
        }
    }
}
