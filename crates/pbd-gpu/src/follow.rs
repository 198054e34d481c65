//! Updates a solver after an edit of its surface.
//!
//! Constraints of deleted triangles are removed and those of new triangles are added. Mass and
//! momentum pass to the surviving vertices, and an undo restores the state before the edit.

mod add_constraints;
pub(crate) mod affected;
pub(crate) mod changes;
pub(crate) mod delta;
pub(crate) mod mass_transfer;
pub(crate) mod momentum;
mod pins;
pub(crate) mod undo_state;

use crate::constraints::edges::EdgeLists;
#[cfg(feature = "serde")]
use crate::error::InvalidSolver;
use changes::ChangeLog;
use incise_mesh::VertexId;
use mass_transfer::MassTransfer;
use pins::DroppedPins;
use undo_state::UndoStack;

/// State that edits need from one another, and their scratch memory.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct FollowState {
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) log: ChangeLog,
    undo: UndoStack,
    /// Whether the last edit was an undo of a body that had moved since the undone edit.
    pub(crate) is_late_undo: bool,
    dropped_pins: DroppedPins,
    /// First vertices of the interior springs that the last edit removed.
    lost_interior_springs: Vec<VertexId>,
    #[cfg_attr(feature = "serde", serde(skip))]
    scratch: Scratch,
}

/// Memory that is reused from edit to edit.
#[derive(Debug, Default)]
struct Scratch {
    lists: EdgeLists,
    mass_transfer: MassTransfer,
    restored: Vec<VertexId>,
    /// Vertices of a solid with other triangles than before.
    changed: Vec<VertexId>,
}

impl Clone for Scratch {
    /// Returns empty scratch memory.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl FollowState {
    /// Checks a state that was read with serde, of a body with `slots` vertex slots.
    ///
    /// # Errors
    /// [`InvalidSolver::Array`].
    #[cfg(feature = "serde")]
    pub(crate) fn validate(&self, slots: usize) -> Result<(), InvalidSolver> {
        let is_slot = |v: VertexId| v.index() < slots;
        let is_valid = self.undo.is_valid(is_slot)
            && self.dropped_pins.is_valid()
            && self.lost_interior_springs.iter().all(|&v| is_slot(v));
        let array = "states before edits";
        is_valid.then_some(()).ok_or(InvalidSolver::Array { array })
    }

    /// Allocates scratch memory for a body of `slots` vertices and for more `vertices`.
    pub(crate) fn reserve(&mut self, slots: usize, vertices: usize) {
        self.scratch.mass_transfer.reserve(slots, vertices);
    }

    /// Returns the surviving first vertices of the interior springs that the last edit removed.
    pub(crate) fn lost_interior_springs(&self) -> &[VertexId] {
        &self.lost_interior_springs
    }

    /// Returns the allocated size in elements, without scratch memory.
    pub(crate) fn capacity(&self) -> usize {
        self.undo.capacity() + self.dropped_pins.capacity() + self.lost_interior_springs.capacity()
    }
}
