//! Undo of a finished edit.

use super::log::Log;
use super::relatives::Restored;
use crate::delta::{AddedVertex, TopologyDelta};
use crate::history::History;
use crate::ids::{TriangleId, VertexId};
use crate::surface::Surface;

/// The error of an undo that does not match the surface. Nothing changes then.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum UndoError {
    /// The surface was edited since, or is another surface.
    #[error(
        "the surface was edited after this edit, or is another surface; undo later edits first, \
         starting with the last"
    )]
    Stale,
    /// An array has another length than the vertex slots.
    #[error(
        "{array} has {found} entries for {expected} vertices; give every vertex one before an undo"
    )]
    WrongLength {
        /// Name of the array.
        array: &'static str,
        /// Length of the array.
        found: usize,
        /// Number of vertex slots.
        expected: usize,
    },
}

/// The undo record of a finished edit: its overwritten values, O(k) for k changes.
#[derive(Debug, Clone, PartialEq)]
pub struct Undo {
    log: Log,
    delta: TopologyDelta,
    restored: Vec<Restored>,
    after: History,
}

impl Undo {
    pub(super) fn new(
        surface: &Surface,
        log: Log,
        delta: TopologyDelta,
        restored: Vec<Restored>,
    ) -> Self {
        Self {
            log,
            delta,
            restored,
            after: surface.history,
        }
    }

    /// Exchanges positions and rest positions of the record. O(k).
    ///
    /// Call it after an edit within [`Surface::with_shapes_exchanged`] and before any other.
    pub fn exchange_shapes(&mut self, surface: &Surface) {
        self.log.exchange_shapes();
        for restored in &mut self.restored {
            restored.place_from(surface);
        }
    }

    /// Undoes the edit and returns the change, which solvers and BVHs follow like any other.
    ///
    /// O(k log k) for k changes.
    ///
    /// Directly after the edit, this restores the surface bit for bit. Later, when vertices have
    /// moved and masses have changed, surviving vertices keep their values. A vertex that the edit
    /// removed is restored with its old inverse mass, displaced by the mean motion of its stand-ins
    /// ([`VertexOrigin::Restored`](crate::VertexOrigin::Restored)).
    ///
    /// # Errors
    /// [`UndoError`] if the surface was edited since; motion is allowed. Nothing changes then.
    pub fn revert(self, surface: &mut Surface) -> Result<TopologyDelta, UndoError> {
        if surface.history != self.after {
            return Err(UndoError::Stale);
        }
        let expected = surface.topology.vertex_slots();
        let lengths = [
            ("positions", surface.positions.len()),
            ("rest", surface.rest.len()),
        ];
        if let Some(&(array, found)) = lengths.iter().find(|entry| entry.1 != expected) {
            return Err(UndoError::WrongLength {
                array,
                found,
                expected,
            });
        }
        // Parents come first, so their positions are final when children are placed.
        for restored in &self.restored {
            surface.positions[restored.vertex.index()] = restored.place(surface);
        }
        let added = self.delta.triangles_added.iter();
        let triangles_removed = added.map(|&t| (t, surface.topology.triangle(t))).collect();
        let mut vertices_removed: Vec<_> = (self.delta.vertices_added.iter())
            .map(|added| added.vertex)
            .collect();
        vertices_removed.sort_unstable();
        let place = |v: &VertexId| {
            let [x, y, z, _] = surface.positions[v.index()];
            [x, y, z]
        };
        let removed_positions = vertices_removed.iter().map(place).collect();
        self.log.put_back(surface);
        let removed = self.delta.triangles_removed.iter();
        let triangles_added: Vec<TriangleId> = removed.map(|entry| entry.0).collect();
        let vertices_added = (self.restored.iter())
            .map(|restored| AddedVertex {
                vertex: restored.vertex,
                origin: restored.origin,
                piece: surface.piece(surface.topology.outgoing(restored.vertex).triangle()),
            })
            .collect();
        // A restored piece is split from the pieces that were made from it.
        let heir = |piece: u32| {
            let heirs = self.delta.pieces_added.iter();
            heirs.clone().find(|entry| entry.1 == piece)
        };
        Ok(TopologyDelta {
            triangles_removed,
            triangles_added,
            vertices_removed,
            removed_positions,
            vertices_added,
            pieces_added: (self.delta.pieces_removed.iter())
                .map(|&piece| (piece, heir(piece).map_or(piece, |entry| entry.0)))
                .collect(),
            pieces_removed: (self.delta.pieces_added.iter())
                .map(|entry| entry.0)
                .collect(),
        })
    }
}

impl Restored {
    /// Returns the restored position: the old one plus the mean displacement of the parents.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a computed position is rounded once to storage"
    )]
    fn place(&self, surface: &Surface) -> [f32; 4] {
        let mut place = self.at;
        for (k, coordinate) in place.iter_mut().take(3).enumerate() {
            let mut moved = 0.0;
            for ((parent, weight), then) in self.origin.weights().into_iter().zip(self.parents_at) {
                let now = surface.positions[parent.index()][k];
                if now.to_bits() != then[k].to_bits() {
                    moved += weight * (f64::from(now) - f64::from(then[k]));
                }
            }
            if moved != 0.0 {
                *coordinate = (f64::from(*coordinate) + moved) as f32;
            }
        }
        place
    }
}
