//! What is done at the press of a key or of a button in the panel.

use super::{Open, panel};
use crate::command::{Command, Method};
use crate::error::ViewError;
use crate::keys::Action;
use incise_refine::RefinementLevel;
use std::fs::File;
use std::io::BufWriter;

impl Open {
    pub(super) fn fit(&mut self) -> Result<(), ViewError> {
        let mut bounds = self.session.bounds()?;
        if self.session.settings().ground {
            bounds.min[1] = bounds.min[1].min(self.session.ground());
        }
        self.eye.fit(&bounds);
        Ok(())
    }

    pub(super) fn act(&mut self, action: Action) -> Result<(), ViewError> {
        let mut settings = *self.session.settings();
        match action {
            Action::Take(tool) => self.pointer.tool = tool,
            Action::Pause => self.paused = !self.paused,
            Action::Step => {
                self.paused = true;
                self.step()?;
            }
            Action::Reset => {
                self.session.apply(Command::Reset);
                self.told = None;
            }
            Action::Undo => self.session.apply(Command::Undo),
            Action::Redo => self.session.apply(Command::Redo),
            Action::Unpin => self.session.apply(Command::Unpin),
            Action::Fit => self.fit()?,
            Action::Wireframe => self.look.wireframe ^= true,
            Action::PieceColors => self.look.pieces ^= true,
            Action::CapColors => self.look.caps ^= true,
            Action::Batches => self.look.batches ^= true,
            Action::Method => {
                settings.method = match settings.method {
                    Method::Exact => Method::Rebuild,
                    Method::Rebuild => Method::Exact,
                }
            }
            Action::Coarser => settings.level = next_level(settings.level, false),
            Action::Finer => settings.level = next_level(settings.level, true),
            Action::FewerSubsteps => settings.substeps = (settings.substeps - 1).max(1),
            Action::MoreSubsteps => settings.substeps = (settings.substeps + 1).min(panel::MOST),
            Action::Save => {
                self.session.read()?;
                let saved = (self.save)(self.session.surface());
                self.told = Some(match saved {
                    Ok(text) => (text, false),
                    Err(text) => (text, true),
                });
            }
            Action::SaveRecording => self.save_recording()?,
            Action::Panel => {
                self.look.panel ^= true;
                self.eye.covered = self.covered();
            }
            Action::Help => self.look.help ^= true,
            Action::Quit => self.is_over = true,
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
        self.told = Some(match written {
            Ok(()) => (format!("{path}: the recording so far"), false),
            Err(error) => (format!("{path}: {error}"), true),
        });
        Ok(())
    }
}

/// The next of the five levels in a direction.
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
