//! Cuts with undo and redo.
//!
//! Undo restores the positions and velocities of the time of the cut: pieces that have separated
//! since would otherwise be joined over a distance and fly apart. Redo starts from the same state,
//! so that it repeats the same cut. The steps of a stroke that cut one after another are undone and
//! redone together.

use super::snapshot::Snapshot;
use super::{Session, add_cuts};
use crate::command::Edge;
use incise_cut::{CutError, CutParams};
use incise_mesh::Undo;
use incise_scene::{BladeMode, SceneError};

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
pub(super) struct RecordedCut {
    pub(super) from: Edge,
    pub(super) to: Edge,
    pub(super) mode: BladeMode,
    /// Whether it starts at the tip of the cut before.
    pub(super) starts_at_tip: bool,
    /// Whether it is undone and redone with the cut before: both belong to one stroke.
    pub(super) is_joined: bool,
    pub(super) params: CutParams,
}

impl Session {
    /// Returns the number of cuts that can be undone; a stroke counts once.
    #[must_use]
    pub fn undo_count(&self) -> usize {
        let entries = self.history.undo.iter();
        entries.filter(|entry| !entry.cut.is_joined).count()
    }

    /// Returns the number of cuts that can be redone; a stroke counts once.
    #[must_use]
    pub fn redo_count(&self) -> usize {
        let entries = self.history.redo.iter();
        entries.filter(|(cut, _)| !cut.is_joined).count()
    }

    pub(super) fn slice(&mut self, from: Edge, to: Edge) -> Result<(), SceneError> {
        self.history.clear_redo();
        let mode = self.settings.blade_mode();
        let cut = RecordedCut {
            mode,
            ..self.full_slice(from, to)
        };
        let inside = match mode {
            BladeMode::Progressive => {
                "nothing was cut: the line does not reach the surface of the body"
            }
            BladeMode::FullSlices => {
                "nothing was cut: the line ends inside the body; draw it right across, or hold \
                 Shift to extend it"
            }
        };
        self.cut_now(cut, inside)?;
        // The next step of a held blade is undone without the slice.
        if let Some(stroke) = &mut self.stroke {
            stroke.has_cut = false;
        }
        let stats = self.scene.stats();
        if stats.cuts > 0 {
            self.status_message = None;
        } else if stats.failed_cuts == 0 {
            self.inform("the line misses the body".to_owned());
        }
        Ok(())
    }

    /// Returns a cut right through the body with the current parameters.
    pub(super) fn full_slice(&self, from: Edge, to: Edge) -> RecordedCut {
        RecordedCut {
            from,
            to,
            mode: BladeMode::FullSlices,
            starts_at_tip: false,
            is_joined: false,
            params: self.scene.params.cut,
        }
    }

    /// Moves the scene's blade for a cut.
    pub(super) fn aim(&mut self, cut: &RecordedCut) -> Result<(), SceneError> {
        if self.scene.blade(self.blade)?.mode != cut.mode {
            self.scene.set_blade_mode(self.blade, cut.mode)?;
        }
        if !cut.starts_at_tip {
            self.scene.teleport_blade(self.blade, cut.from)?;
        }
        self.scene.move_blade(self.blade, cut.to)
    }

    /// Cuts immediately. `inside` is the message for a sweep that ends inside the body.
    pub(super) fn cut_now(&mut self, cut: RecordedCut, inside: &str) -> Result<(), SceneError> {
        let snapshot = self.snapshot()?;
        self.aim(&cut)?;
        let done = self.scene.cut().copied();
        add_cuts(&mut self.pending.stats, &done?);
        self.record_cut(cut, snapshot)?;
        if let Some(refusal) = self.scene.failed_cuts().first() {
            self.report_error(match refusal.error {
                CutError::PartialCut { .. } => inside.to_owned(),
                error => error.to_string(),
            });
        }
        Ok(())
    }

    /// Pushes the scene's last cut on the undo stack, and lets its walls collide.
    pub(super) fn record_cut(
        &mut self,
        cut: RecordedCut,
        snapshot: Snapshot,
    ) -> Result<(), SceneError> {
        let mut cuts = self.scene.cuts().iter();
        let Some((_, outcome)) = cuts.find_map(|sweep| sweep.cut.as_ref()) else {
            return Ok(());
        };
        self.topology += 1;
        self.positions += 1;
        if let Some(undo) = outcome.undo.clone() {
            self.history.undo.push(UndoEntry {
                cut,
                snapshot,
                undo,
            });
        }
        if let Some(stroke) = &mut self.stroke {
            stroke.has_cut = cut.mode == BladeMode::Progressive;
        }
        if !self.has_walls && self.is_blade_inside()? {
            self.has_walls = true;
            self.scene.params.contacts = self.settings.scene(true).contacts;
        }
        Ok(())
    }

    pub(super) fn undo(&mut self) -> Result<(), SceneError> {
        self.release()?;
        self.lift_progressive_blade();
        if self.history.undo.is_empty() {
            self.inform("there is no cut to undo".to_owned());
        }
        while let Some(done) = self.history.undo.pop() {
            let undone = self.scene.undo(self.body, done.undo.clone());
            if let Err(error) = undone {
                self.history.undo.push(done);
                return Err(error);
            }
            self.topology += 1;
            let is_first = !done.cut.is_joined;
            let back = match is_first {
                true => self.restore(&done.snapshot),
                false => Ok(()),
            };
            self.history.redo.push((done.cut, done.snapshot));
            if is_first {
                return back;
            }
        }
        Ok(())
    }

    pub(super) fn redo(&mut self) -> Result<(), SceneError> {
        self.release()?;
        self.lift_progressive_blade();
        if self.history.redo.is_empty() {
            self.inform("there is no cut to redo".to_owned());
        }
        let inside = "nothing was cut: the repeated cut would end inside the body";
        while let Some((cut, snapshot)) = self.history.redo.pop() {
            self.restore(&snapshot)?;
            let now = std::mem::replace(&mut self.scene.params.cut, cut.params);
            let done = self.cut_now(cut, inside);
            self.scene.params.cut = now;
            done?;
            if !self
                .history
                .redo
                .last()
                .is_some_and(|(next, _)| next.is_joined)
            {
                break;
            }
        }
        Ok(())
    }
}
