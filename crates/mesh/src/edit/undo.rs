//! Taking a finished edit back.

use super::finish::Change;
use super::log::Log;
use super::relatives::{Restored, restored};
use crate::delta::{AddedVertex, TopologyDelta};
use crate::history::History;
use crate::ids::{TriangleId, VertexId};
use crate::surface::Surface;

/// Why an edit cannot be undone. The surface is then what it was.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum UndoError {
    /// The surface has been edited since, or it is another one.
    #[error(
        "the surface is not as this edit left it: it was edited since or is another one; undo later edits first, the last one first"
    )]
    Stale,
    /// An array does not fit the surface's vertices.
    #[error(
        "{array} has {found} entries for {expected} vertices; give every vertex one before an undo"
    )]
    WrongLength {
        /// The array.
        array: &'static str,
        /// Its length.
        found: usize,
        /// The surface's vertex slots.
        expected: usize,
    },
}

/// What takes a finished edit back. It holds what the edit overwrote: O(k) for k changes.
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

    /// What takes an edit back that was made on a copy and not as an [`Edit`](super::Edit): `before` is
    /// the original, `delta` the difference. Nothing may have moved in between. None when `after` has
    /// fewer slots, so that it can be no edit of `before`. O(n).
    #[must_use]
    pub fn between(before: &Surface, after: &Surface, delta: &TopologyDelta) -> Option<Self> {
        let slots = |s: &Surface| [s.topology.vertex_slots(), s.topology.triangle_slots()];
        let ([v, t], [w, u]) = (slots(before), slots(after));
        if v > w || t > u {
            return None;
        }
        let removed = delta.triangles_removed.iter();
        let changes: Vec<Change> = removed
            .map(|&(triangle, before)| Change {
                triangle,
                before,
                now: after.topology.triangle(triangle),
            })
            .collect();
        let restored = restored(after, delta, &changes);
        let log = Log::between(before, after);
        Some(Self::new(after, log, delta.clone(), restored))
    }

    /// Takes the edit back. Returns the change from the edited surface to the one before, which
    /// solvers and search trees follow like any other. O(k log k) for k changes.
    ///
    /// At once after the edit, the surface is then bit for bit what it was before it. Later, when
    /// vertices have moved and masses have been shared out anew, those that are still there keep
    /// what they have. A vertex that the edit removed comes back with its old inverse mass,
    /// displaced by as much as those have moved since that stand in its place
    /// ([`Origin::Restored`](crate::Origin::Restored)).
    ///
    /// # Errors
    /// [`UndoError`] when the surface is not as the edit left it but for motion; nothing is changed
    /// then.
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
        // Parents come first, so every one is where it belongs when its children are placed.
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
        let removed_from = vertices_removed.iter().map(place).collect();
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
        // What was made out of a piece that went is what the piece comes back from.
        let heir = |piece: u32| {
            let heirs = self.delta.pieces_added.iter();
            heirs.clone().find(|entry| entry.1 == piece)
        };
        Ok(TopologyDelta {
            triangles_removed,
            triangles_added,
            vertices_removed,
            removed_from,
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
    /// Where the vertex comes back: where it was, and displaced like its parents since.
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
