//! Origins of the vertices and faces of a cut mesh, collected from the changes of its cuts.

use incise::cut::CutOutcome;
use incise::mesh::{Lineage, Surface, TriangleId};

/// The material of walls and caps during a cut, which no input may have.
pub(crate) const NEW_FACE: u32 = u32::MAX;

/// The lineage of the vertices of a cut mesh, and the input's face of each of its faces.
pub(crate) struct Origins {
    pub(crate) lineage: Lineage,
    /// Whether a cut replaced the triangle in each slot of the input.
    is_changed: Vec<bool>,
    /// Whether materials number the faces of the input.
    has_face_numbers: bool,
}

impl Origins {
    /// Starts with an input, and numbers its faces by their materials.
    ///
    /// With `remeshes` the materials stay, since remeshing keeps borders between them. Then only
    /// faces that no cut changed have an origin.
    pub(crate) fn new(surface: &mut Surface, remeshes: bool) -> Self {
        let triangles: Vec<TriangleId> = surface.topology().triangles().collect();
        if !remeshes {
            for &t in &triangles {
                surface.set_material(t, t.0);
            }
        }
        Self {
            lineage: Lineage::new(surface),
            is_changed: vec![false; triangles.len()],
            has_face_numbers: !remeshes,
        }
    }

    /// Adds the vertices and faces of a cut.
    pub(crate) fn follow(&mut self, outcome: &CutOutcome) {
        self.lineage.follow(&outcome.delta);
        let changed = outcome.delta.triangles_removed.iter().map(|(t, _)| t);
        for t in changed.chain(&outcome.delta.triangles_added) {
            if let Some(is_changed) = self.is_changed.get_mut(t.index()) {
                *is_changed = true;
            }
        }
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
