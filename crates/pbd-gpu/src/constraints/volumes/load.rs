//! Completes and validates a loaded [`VolumeSet`].

use super::VolumeSet;
use crate::constraints::validate::broken;
use crate::error::InvalidConstraints;
use incise_mesh::{HalfEdge, Surface, Topology};

impl VolumeSet {
    /// Completes constraints that were read with serde, of their surface.
    ///
    /// # Errors
    /// [`InvalidConstraints`] unless pieces ascend, have closed fans, and share no vertex.
    pub(crate) fn finish_load(&mut self, surface: &Surface) -> Result<(), InvalidConstraints> {
        let topology = surface.topology();
        for spoke in &mut self.spokes {
            spoke.outgoing = topology.outgoing(spoke.vertex);
        }
        let (mut first, mut next_piece) = (0, 0);
        for piece in &self.pieces {
            let spokes = self.spokes.get(piece.first..piece.end).unwrap_or_default();
            let mut halves = spokes.iter().map(|spoke| spoke.outgoing);
            let is_own = |h: HalfEdge| {
                !h.is_null() && surface.piece(h.triangle()) == piece.piece && is_closed(topology, h)
            };
            // Ascending vertices of different pieces are all different.
            let is_valid = piece.first == first
                && u64::from(piece.piece) >= next_piece
                && !spokes.is_empty()
                && piece.rest.is_normal()
                && piece.reach.is_normal()
                && spokes.is_sorted_by(|a, b| a.vertex < b.vertex)
                && halves.all(is_own);
            if !is_valid {
                return broken("volumes are those of closed pieces", None);
            }
            (first, next_piece) = (piece.end, u64::from(piece.piece) + 1);
        }
        let is_finite = self.lambda.iter().all(|lambda| lambda.is_finite());
        if first != self.spokes.len() || self.lambda.len() != self.pieces.len() || !is_finite {
            return broken("a piece has vertices and one multiplier", None);
        }
        self.displacements.resize(self.pieces.len(), [0.0; 3]);
        self.find_rings(topology);
        Ok(())
    }
}

/// Returns whether the triangles around the origin of `first` form a closed fan.
fn is_closed(topology: &Topology, first: HalfEdge) -> bool {
    let mut at = first;
    loop {
        at = topology.twin(at.prev());
        if at.is_null() || at == first {
            return at == first;
        }
    }
}
