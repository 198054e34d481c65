//! Executes the actions of keys and panel buttons.

use super::OpenWindow;
use crate::command::Command;
use crate::error::ViewError;
use crate::keys::Action;
use incise_pbd_gpu::SolverParams;
use incise_refine::RefinementLevel;
use incise_scene::SceneParams;
use std::fs::File;
use std::io::BufWriter;

impl OpenWindow {
    /// Fits the body and the ground below it in the view.
    pub(super) fn fit(&mut self) -> Result<(), ViewError> {
        let mut bounds = self.session.bounds()?;
        if self.session.settings().ground {
            bounds.min[1] = bounds.min[1].min(self.session.ground());
        }
        self.orbit.fit(&bounds);
        Ok(())
    }

    /// Executes an action.
    pub(super) fn execute(&mut self, action: Action) -> Result<(), ViewError> {
        let mut settings = *self.session.settings();
        let level = &mut settings.scene.cut.refine.level;
        match action {
            Action::SelectTool(tool) => self.pointer.tool = tool,
            Action::Pause => self.paused = !self.paused,
            Action::Step => {
                self.paused = true;
                self.step()?;
            }
            Action::Reset => {
                self.session.apply(Command::Reset);
                self.message = None;
            }
            Action::Undo => self.session.apply(Command::Undo),
            Action::Redo => self.session.apply(Command::Redo),
            Action::Unpin => self.session.apply(Command::Unpin),
            Action::Fit => self.fit()?,
            Action::Wireframe => self.display.wireframe ^= true,
            Action::PieceColors => self.display.pieces ^= true,
            Action::CapColors => self.display.caps ^= true,
            Action::BatchColors => self.display.batches ^= true,
            Action::Coarser => *level = next_level(*level, false),
            Action::Finer => *level = next_level(*level, true),
            Action::FewerSubsteps => change_substeps(&mut settings.scene, |n| n - 1),
            Action::MoreSubsteps => change_substeps(&mut settings.scene, |n| n + 1),
            Action::Save => {
                self.session.read()?;
                let saved = (self.save)(self.session.surface());
                self.message = Some(match saved {
                    Ok(text) => (text, false),
                    Err(error) => (error.to_string(), true),
                });
            }
            Action::SaveRecording => self.save_recording()?,
            Action::Panel => {
                self.display.panel ^= true;
                self.orbit.panel_width = self.panel_width();
            }
            Action::Help => self.display.help ^= true,
            Action::Quit => self.is_closing = true,
        }
        if settings != *self.session.settings() {
            self.session.apply(Command::Set(settings));
        }
        Ok(())
    }

    fn save_recording(&mut self) -> Result<(), ViewError> {
        let recording = self.session.finished_recording()?;
        let path = self.record_to.display();
        let written = File::create(&self.record_to).and_then(|file| {
            let mut out = BufWriter::new(file);
            recording.write(&mut out)?;
            std::io::Write::flush(&mut out)
        });
        self.message = Some(match written {
            Ok(()) => (format!("{path}: recording saved"), false),
            Err(error) => (format!("{path}: {error}"), true),
        });
        Ok(())
    }
}

/// Changes the number of substeps of a frame, at least 1.
fn change_substeps(scene: &mut SceneParams, change: impl Fn(u32) -> u32) {
    let SceneParams { dt, solver, .. } = scene;
    let count = change(solver.substeps(*dt).max(1)).clamp(1, SolverParams::MAX_COUNT);
    *solver = solver.with_substeps(*dt, count);
}

/// Returns the next finer or coarser of the five named levels.
fn next_level(level: RefinementLevel, is_finer: bool) -> RefinementLevel {
    let z = level.z();
    let mut five = RefinementLevel::FIVE.into_iter();
    if is_finer {
        five.find(|l| l.z() < z).unwrap_or(RefinementLevel::Finer2)
    } else {
        five.rfind(|l| l.z() > z)
            .unwrap_or(RefinementLevel::Coarser2)
    }
}
