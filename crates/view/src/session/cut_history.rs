//! Immediate cuts with undo and redo.
//!
//! Undo restores the positions and velocities of the time of the cut: pieces that have separated
//! since would otherwise be joined over a distance and fly apart. Redo starts from the same state,
//! so that it repeats the same cut.

use super::snapshot::Snapshot;
use super::{Session, add_cuts};
use crate::command::Edge;
use incise_cut::{CutError, CutParams};
use incise_mesh::Undo;
use incise_scene::SceneError;

/// The undo and redo stacks of cuts.
#[derive(Debug, Default)]
pub(super) struct CutHistory {
    undo: Vec<UndoEntry>,
    redo: Vec<(RecordedCut, Snapshot)>,
}

/// A cut on the undo stack.
#[derive(Debug)]
struct UndoEntry {
    cut: RecordedCut,
    /// State before the cut.
    snapshot: Snapshot,
    undo: Undo,
}

impl CutHistory {
    /// Clears the redo stack, because a new cut invalidates it.
    pub(super) fn clear_redo(&mut self) {
        self.redo.clear();
    }
}

/// Blade positions and parameters of a cut.
#[derive(Debug, Clone, Copy)]
struct RecordedCut {
    from: Edge,
    to: Edge,
    params: CutParams,
}

impl Session {
    /// Returns the number of cuts that can be undone.
    #[must_use]
    pub fn undo_count(&self) -> usize {
        self.history.undo.len()
    }

    /// Returns the number of cuts that can be redone.
    #[must_use]
    pub fn redo_count(&self) -> usize {
        self.history.redo.len()
    }

    pub(super) fn slice(&mut self, from: Edge, to: Edge) -> Result<(), SceneError> {
        self.history.clear_redo();
        let inside = "nothing was cut: the line ends inside the body; draw it right across, or \
                      hold Shift to extend it";
        self.cut_along(from, to, inside)?;
        let stats = self.scene.stats();
        if stats.cuts > 0 {
            self.status_message = None;
        } else if stats.failed_cuts == 0 {
            self.inform("the line misses the body".to_owned());
        }
        Ok(())
    }

    /// Cuts immediately. `inside` is the message for a sweep that ends inside the body.
    pub(super) fn cut_along(
        &mut self,
        from: Edge,
        to: Edge,
        inside: &str,
    ) -> Result<(), SceneError> {
        let snapshot = self.snapshot()?;
        self.scene.teleport_blade(self.blade, from)?;
        self.scene.move_blade(self.blade, to)?;
        let done = self.scene.cut().copied();
        add_cuts(&mut self.pending.stats, &done?);
        self.record_cut([from, to], snapshot);
        if let Some(refusal) = self.scene.failed_cuts().first() {
            self.report_error(match refusal.error {
                CutError::PartialCut { .. } => inside.to_owned(),
                error => error.to_string(),
            });
        }
        Ok(())
    }

    /// Pushes the scene's last cut on the undo stack.
    pub(super) fn record_cut(&mut self, [from, to]: [Edge; 2], snapshot: Snapshot) {
        let mut cuts = self.scene.cuts().iter();
        let Some((_, outcome)) = cuts.find_map(|sweep| sweep.cut.as_ref()) else {
            return;
        };
        self.topology += 1;
        self.positions += 1;
        if let Some(undo) = outcome.undo.clone() {
            let params = self.scene.params.cut;
            let cut = RecordedCut { from, to, params };
            self.history.undo.push(UndoEntry {
                cut,
                snapshot,
                undo,
            });
        }
    }

    pub(super) fn undo(&mut self) -> Result<(), SceneError> {
        self.release()?;
        let Some(done) = self.history.undo.pop() else {
            self.inform("there is no cut to undo".to_owned());
            return Ok(());
        };
        let undone = self.scene.undo(self.body, done.undo.clone());
        if let Err(error) = undone {
            self.history.undo.push(done);
            return Err(error);
        }
        self.topology += 1;
        let back = self.restore(&done.snapshot);
        self.history.redo.push((done.cut, done.snapshot));
        back
    }

    pub(super) fn redo(&mut self) -> Result<(), SceneError> {
        self.release()?;
        let Some((cut, snapshot)) = self.history.redo.pop() else {
            self.inform("there is no cut to redo".to_owned());
            return Ok(());
        };
        self.restore(&snapshot)?;
        let inside = "nothing was cut: the repeated cut would end inside the body";
        let now = std::mem::replace(&mut self.scene.params.cut, cut.params);
        let done = self.cut_along(cut.from, cut.to, inside);
        self.scene.params.cut = now;
        done
    }
}
