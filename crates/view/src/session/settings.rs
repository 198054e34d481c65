//! Changes of settings, which may rebuild the body, and reset.

use super::Session;
use super::cut_history::CutHistory;
use crate::command::Settings;
use incise_scene::{BodyId, SceneError};

impl Session {
    pub(super) fn set(&mut self, settings: Settings) -> Result<(), SceneError> {
        if settings.requires_new_body(&self.settings) {
            self.release()?;
            self.rebuild(&settings)?;
            self.inform("the body was rebuilt at rest in its current shape".to_owned());
        } else if settings.material != self.settings.material {
            let (solver, surface) = self.scene.edit(self.body)?.solver_mut();
            solver.set_material(surface, &settings.material)?;
        }
        self.scene.colliders = settings.colliders(self.ground);
        let params = settings.scene(self.has_walls);
        if params != self.scene.params {
            self.scene.params = params;
            self.scene.wake(self.body)?;
        }
        self.settings = settings;
        Ok(())
    }

    /// Rebuilds the body at rest in its current shape; pins and the undo stack are kept.
    fn rebuild(&mut self, settings: &Settings) -> Result<(), SceneError> {
        self.scene.read_back(self.body)?;
        let old = self.scene.body(self.body)?;
        let pins: Vec<_> = old.solver().pins().iter().map(|pin| pin.vertex).collect();
        let surface = old.surface().clone();
        let body = self.scene.add_body(surface, &settings.material)?;
        self.replace(body);
        let (solver, surface) = self.scene.edit(self.body)?.solver_mut();
        for v in pins {
            solver.pin(surface, v)?;
        }
        Ok(())
    }

    fn replace(&mut self, body: BodyId) {
        // Discarded without a readback, which fails after a GPU error.
        let _old = self.scene.discard_body(self.body);
        self.body = body;
        self.topology += 1;
        self.positions += 1;
    }

    pub(super) fn reset(&mut self) -> Result<(), SceneError> {
        let initial = self.initial.clone();
        let body = self.scene.add_body(initial, &self.settings.material)?;
        self.stroke = None;
        self.dragged = None;
        self.history = CutHistory::default();
        self.last_cut_stats = None;
        self.status_message = None;
        self.has_walls = false;
        self.scene.params = self.settings.scene(false);
        self.replace(body);
        Ok(())
    }
}
