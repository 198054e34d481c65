//! [`SavedFollowState`]: the state that later edits and undos need, for files.

use super::FollowState;
use super::pins::DroppedPins;
use super::undo_state::UndoStack;
use incise_mesh::VertexId;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A [`FollowState`], as it is saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct SavedFollowState<'a> {
    undo: Cow<'a, UndoStack>,
    is_late_undo: bool,
    dropped_pins: Cow<'a, DroppedPins>,
    lost_interior_springs: Cow<'a, [VertexId]>,
}

impl FollowState {
    /// Returns the state as plain data for a file.
    pub(crate) fn to_saved(&self) -> SavedFollowState<'_> {
        SavedFollowState {
            undo: Cow::Borrowed(&self.undo),
            is_late_undo: self.is_late_undo,
            dropped_pins: Cow::Borrowed(&self.dropped_pins),
            lost_interior_springs: (&self.lost_interior_springs).into(),
        }
    }

    /// Returns a saved state of a body with `slots` vertex slots, if it fits.
    pub(crate) fn from_saved(saved: SavedFollowState<'_>, slots: usize) -> Option<Self> {
        let is_slot = |v: VertexId| v.index() < slots;
        let fits = saved.undo.is_valid(is_slot)
            && saved.dropped_pins.is_valid()
            && saved.lost_interior_springs.iter().all(|&v| is_slot(v));
        fits.then(|| Self {
            undo: saved.undo.into_owned(),
            is_late_undo: saved.is_late_undo,
            dropped_pins: saved.dropped_pins.into_owned(),
            lost_interior_springs: saved.lost_interior_springs.into_owned(),
            ..Self::default()
        })
    }
}
