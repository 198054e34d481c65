//! The body made anew: other settings, and the way back to the beginning.

use super::Session;
use super::cuts::Cuts;
use crate::command::Settings;
use incise_pbd_gpu::Stiffness;
use incise_scene::{BodyId, SceneError};

impl Session {
    pub(super) fn set(&mut self, settings: Settings) -> Result<(), SceneError> {
        if settings.needs_new_body(&self.settings) {
            self.release()?;
            self.renew(&settings)?;
            self.say("the body was made anew where it is, at rest".to_owned());
        } else if settings.material() != self.settings.material() {
            let (solver, surface) = self.scene.edit(self.body)?.solver_mut();
            solver.set_stretch(Stiffness::Pbd(settings.stretch))?;
            solver.set_damping(settings.damping)?;
            solver.set_volume(surface, settings.volume())?;
        }
        let params = settings.scene(self.ground);
        if params != self.scene.params {
            self.scene.params = params;
            self.scene.wake(self.body);
        }
        self.settings = settings;
        Ok(())
    }

    /// Makes the body anew from where it is. Its pins stay, its cuts can still be undone.
    fn renew(&mut self, settings: &Settings) -> Result<(), SceneError> {
        self.scene.read(self.body)?;
        let old = self.scene.body(self.body);
        let pins: Vec<_> = old.solver().pins().iter().map(|pin| pin.vertex).collect();
        let surface = old.surface().clone();
        let body = self.scene.add_body(surface, &settings.material())?;
        self.replace(body);
        let (solver, surface) = self.scene.edit(self.body)?.solver_mut();
        for v in pins {
            solver.pin(surface, v)?;
        }
        Ok(())
    }

    fn replace(&mut self, body: BodyId) {
        // It may be one that cannot be read any more.
        let _old = self.scene.discard_body(self.body);
        self.body = body;
        self.topology += 1;
        self.positions += 1;
    }

    pub(super) fn reset(&mut self) -> Result<(), SceneError> {
        let first = self.first.clone();
        let body = self.scene.add_body(first, &self.settings.material())?;
        self.stroke = None;
        self.grip = None;
        self.cuts = Cuts::default();
        self.last_cut = None;
        self.notice = None;
        self.replace(body);
        Ok(())
    }
}
