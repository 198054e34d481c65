//! [`UndoStack`]: the cuts of a scene that can be undone.

use crate::body::BodyId;
use crate::error::SceneError;
use crate::scene::Scene;
use crate::stats::FrameStats;
use incise_mesh::Undo;
use std::collections::VecDeque;

/// The cuts of a scene that can be undone, oldest first.
///
/// It belongs to one scene. Cuts of other frames than those of [`UndoStack::step`] and
/// [`UndoStack::record`] are unknown to it, and older cuts of their bodies can no longer be undone.
#[derive(Debug, Clone)]
pub struct UndoStack {
    limit: usize,
    cuts: VecDeque<(BodyId, Undo)>,
}

impl UndoStack {
    /// Creates an empty stack that keeps the last `limit` cuts.
    #[must_use]
    pub fn new(limit: usize) -> Self {
        Self {
            limit,
            cuts: VecDeque::new(),
        }
    }

    /// Returns the maximum number of cuts.
    #[must_use]
    pub fn limit(&self) -> usize {
        self.limit
    }

    /// Changes the number of cuts that are kept, and drops the oldest surplus ones.
    pub fn set_limit(&mut self, limit: usize) {
        self.limit = limit;
        let surplus = self.cuts.len().saturating_sub(limit);
        self.cuts.drain(..surplus);
    }

    /// Steps a scene by one frame and records its cuts.
    ///
    /// # Errors
    /// As [`Scene::step`]; cuts before the error are recorded.
    pub fn step<'a>(&mut self, scene: &'a mut Scene) -> Result<&'a FrameStats, SceneError> {
        let cut = scene.cut().map(|_| ());
        self.record(scene);
        cut?;
        scene.advance()
    }

    /// Records the cuts of the scene's last frame. Call it once after [`Scene::cut`].
    pub fn record(&mut self, scene: &Scene) {
        let cuts = scene.cuts().iter().filter_map(|sweep| sweep.cut.as_ref());
        let undos = cuts.filter_map(|(body, outcome)| Some((*body, outcome.undo.clone()?)));
        self.cuts.extend(undos);
        self.set_limit(self.limit);
    }

    /// Returns the body of each cut, oldest first.
    pub fn bodies(&self) -> impl DoubleEndedIterator<Item = BodyId> + ExactSizeIterator + '_ {
        self.cuts.iter().map(|(body, _)| *body)
    }

    /// Undoes the last cut of a body by [`Scene::undo`].
    ///
    /// # Errors
    /// [`SceneError::NothingToUndo`], and as [`Scene::undo`]; the cut stays on the stack then.
    pub fn undo(&mut self, scene: &mut Scene, body: BodyId) -> Result<(), SceneError> {
        let last = self.bodies().rposition(|of| of == body);
        let last = last.ok_or(SceneError::NothingToUndo { body })?;
        scene.undo(body, self.cuts[last].1.clone())?;
        self.cuts.remove(last);
        Ok(())
    }

    /// Forgets the cuts of a body that was removed.
    pub fn forget(&mut self, body: BodyId) {
        self.cuts.retain(|(of, _)| *of != body);
    }
}
