//! Cuts at once, and cuts taken back.
//!
//! A cut that is taken back takes the body back to where it was before it: pieces that have parted would else be joined across
//! the room, and fly. Doing it again goes there too, so that it is the same cut, however long ago.

use super::moment::Moment;
use super::{Session, add_cuts};
use crate::command::Edge;
use incise_cut::{CutError, CutParams};
use incise_mesh::Undo;
use incise_scene::SceneError;

/// The cuts that can be taken back, and those that were.
#[derive(Debug, Default)]
pub(super) struct Cuts {
    done: Vec<Done>,
    undone: Vec<(Way, Moment)>,
}

/// A cut that was done.
#[derive(Debug)]
struct Done {
    way: Way,
    /// Before it.
    moment: Moment,
    undo: Undo,
}

impl Cuts {
    /// Whoever cuts anew does not go back to what was undone before.
    pub(super) fn forget_undone(&mut self) {
        self.undone.clear();
    }
}

/// Along what was cut, and how.
#[derive(Debug, Clone, Copy)]
struct Way {
    from: Edge,
    to: Edge,
    params: CutParams,
}

impl Session {
    /// How many cuts can be taken back.
    #[must_use]
    pub fn undoable(&self) -> usize {
        self.cuts.done.len()
    }

    /// How many cuts can be done again.
    #[must_use]
    pub fn redoable(&self) -> usize {
        self.cuts.undone.len()
    }

    pub(super) fn slice(&mut self, from: Edge, to: Edge) -> Result<(), SceneError> {
        self.cuts.forget_undone();
        let inside = "the line ends inside the body, and only full slices are cut: draw it right across, or hold Shift to cut \
                      as far as the body goes";
        self.cut_along(from, to, inside)?;
        let stats = self.scene.stats();
        if stats.cuts > 0 {
            self.notice = None;
        } else if stats.refused == 0 {
            self.say("the line misses the body".to_owned());
        }
        Ok(())
    }

    /// Cuts at once. Of a sweep that ends inside the body it says `inside`.
    pub(super) fn cut_along(
        &mut self,
        from: Edge,
        to: Edge,
        inside: &str,
    ) -> Result<(), SceneError> {
        let moment = self.moment()?;
        self.scene.jump_blade(self.blade, from);
        self.scene.move_blade(self.blade, to);
        let done = self.scene.cut().copied();
        add_cuts(&mut self.since.stats, &done?);
        self.take_outcome([from, to], moment);
        if let Some(refusal) = self.scene.refusals().first() {
            self.refuse(match refusal.error {
                CutError::PartialCut { .. } => inside.to_owned(),
                error => error.to_string(),
            });
        }
        Ok(())
    }

    /// Notes what the scene has just cut along this way.
    pub(super) fn take_outcome(&mut self, [from, to]: [Edge; 2], moment: Moment) {
        let Some((_, outcome)) = self.scene.outcomes().first() else {
            return;
        };
        self.topology += 1;
        self.positions += 1;
        if let Some(undo) = outcome.undo.clone() {
            let params = self.scene.params.cut;
            let way = Way { from, to, params };
            self.cuts.done.push(Done { way, moment, undo });
        }
    }

    pub(super) fn undo(&mut self) -> Result<(), SceneError> {
        self.release()?;
        let Some(done) = self.cuts.done.pop() else {
            self.say("there is no cut to take back".to_owned());
            return Ok(());
        };
        let undone = self.scene.undo(self.body, done.undo.clone());
        if let Err(error) = undone {
            self.cuts.done.push(done);
            return Err(error);
        }
        self.topology += 1;
        let back = self.go_back(&done.moment);
        self.cuts.undone.push((done.way, done.moment));
        back
    }

    pub(super) fn redo(&mut self) -> Result<(), SceneError> {
        self.release()?;
        let Some((way, moment)) = self.cuts.undone.pop() else {
            self.say("there is no cut to do again".to_owned());
            return Ok(());
        };
        self.go_back(&moment)?;
        let inside = "that cut would end inside the body";
        let now = std::mem::replace(&mut self.scene.params.cut, way.params);
        let done = self.cut_along(way.from, way.to, inside);
        self.scene.params.cut = now;
        done
    }
}
