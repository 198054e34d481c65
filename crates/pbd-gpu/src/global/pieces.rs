//! [`HeldPieces`]: the pieces with a pin, which do not fall freely.

use crate::particles::Particles;
use incise_mesh::{Surface, VertexId};

/// The vertices of pieces with a pin.
#[derive(Debug, Clone, Default)]
pub(super) struct HeldPieces {
    /// Whether a vertex belongs to such a piece, shape [vertex slots].
    vertices: Vec<bool>,
    /// Whether a piece has a pin, shape \[pieces\].
    pieces: Vec<bool>,
    /// The pins of `vertices`.
    pins: Vec<VertexId>,
    is_current: bool,
}

impl HeldPieces {
    /// Finds the vertices again after an edit or a change of pins. O(triangles) then.
    pub(super) fn update(&mut self, particles: &Particles, surface: &Surface) {
        let pins = particles.pins.iter().map(|pin| pin.vertex);
        if self.is_current && pins.clone().eq(self.pins.iter().copied()) {
            return;
        }
        self.is_current = true;
        self.pins.clear();
        self.pins.extend(pins);
        self.pieces.clear();
        self.pieces.resize(surface.piece_bound() as usize, false);
        self.vertices.clear();
        self.vertices.resize(surface.positions().len(), false);
        if self.pins.is_empty() {
            return;
        }
        let topology = surface.topology();
        let piece = |t| surface.piece(t) as usize;
        let first_triangles = self.pins.iter().map(|&pin| topology.outgoing(pin));
        for h in first_triangles.filter(|h| !h.is_null()) {
            self.pieces[piece(h.triangle())] = true;
        }
        for t in topology.triangles().filter(|&t| self.pieces[piece(t)]) {
            for v in topology.triangle(t) {
                self.vertices[v.index()] = true;
            }
        }
    }

    /// Marks them as changed by an edit.
    pub(super) fn forget(&mut self) {
        self.is_current = false;
    }

    /// Returns whether each vertex belongs to a piece with a pin, shape [vertex slots].
    pub(super) fn vertices(&self) -> &[bool] {
        &self.vertices
    }

    /// Returns the memory \[bytes\].
    pub(super) fn bytes(&self) -> usize {
        self.vertices.capacity() + self.pieces.capacity() + 4 * self.pins.capacity()
    }
}
