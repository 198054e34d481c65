//! [`SavedHistory`]: the last substep of second-order integration, for files.

use super::History;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A valid [`History`], as it is saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct SavedHistory<'a> {
    before: [Cow<'a, [[f32; 4]]>; 2],
    end: [Cow<'a, [[f32; 4]]>; 2],
    h: f32,
}

impl History {
    /// Returns the history as plain data for a file; `None` if the next substep needs none.
    pub(crate) fn to_saved(&self) -> Option<SavedHistory<'_>> {
        self.is_valid.then(|| SavedHistory {
            before: self.before.each_ref().map(Cow::from),
            end: self.end.each_ref().map(Cow::from),
            h: self.h,
        })
    }

    /// Returns a saved history of a body with `slots` vertex slots, if it fits.
    pub(crate) fn from_saved(saved: SavedHistory<'_>, slots: usize) -> Option<Self> {
        let arrays = saved.before.iter().chain(&saved.end);
        let is_finite = |array: &[[f32; 4]]| array.as_flattened().iter().all(|c| c.is_finite());
        let fits = arrays
            .map(|array| &**array)
            .all(|a| a.len() == slots && is_finite(a));
        fits.then(|| Self {
            before: saved.before.map(Cow::into_owned),
            end: saved.end.map(Cow::into_owned),
            h: saved.h,
            is_valid: true,
            pins: Vec::new(),
        })
    }
}
