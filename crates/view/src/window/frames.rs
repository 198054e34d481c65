//! The clock: as many frames as time has passed, and a picture.

use super::{Open, panel, screen};
use crate::command::Command;
use crate::error::ViewError;
use crate::recording::Progress;
use incise_scene::SceneParams;
use std::time::{Duration, Instant};
use winit::event_loop::ControlFlow;

/// Most frames that are stepped for one picture: a machine that is too slow shows motion slowed down, and answers.
const MOST_STEPS: u32 = 3;

impl Open {
    /// Steps by a frame, with what the recording has for it.
    pub(super) fn step(&mut self) -> Result<(), ViewError> {
        if let Some(replay) = &mut self.replay
            && let Progress::Over(is_same) = replay.follow(&mut self.session)?
        {
            self.replay = None;
            self.paused = true;
            self.told = Some(match is_same {
                Some(true) => ("the replay is over: the same to the bit".to_owned(), false),
                // Devices contract and reassociate; only the processor is held to its bits.
                Some(false) if self.is_on_device() => (
                    "the replay is over; on a device it differs by rounding and what comes of it"
                        .to_owned(),
                    false,
                ),
                Some(false) => ("the replay is over and differs".to_owned(), true),
                None => ("the replay is over".to_owned(), false),
            });
            return Ok(());
        }
        self.session.frame();
        let frame = self.session.last();
        self.times.push(frame.time, frame.stats.cutting());
        Ok(())
    }

    /// Whether a device moves the body.
    pub(super) fn is_on_device(&self) -> bool {
        let report = self.session.scene().backend_report();
        report.on_device.contains(&self.session.body())
    }

    /// Whether time goes on.
    fn is_moving(&self) -> bool {
        let rests = self.session.is_asleep() && self.session.held_vertex().is_none();
        !self.paused && (!rests || self.replay.is_some())
    }

    /// Steps as many frames as time has passed.
    fn advance(&mut self) -> Result<(), ViewError> {
        let now = Instant::now();
        let passed = now - std::mem::replace(&mut self.last, now);
        let dt = Duration::from_secs_f32(SceneParams::default().dt);
        let is_moving = self.is_moving();
        (self.pace).note(now, self.session.frames(), dt, is_moving);
        if !is_moving {
            self.owed = dt;
            return Ok(());
        }
        self.owed = (self.owed + passed).min(dt * MOST_STEPS);
        let begin = Instant::now();
        while self.owed >= dt && self.is_moving() {
            self.owed -= dt;
            self.step()?;
            // The picture matters more than the clock.
            if begin.elapsed() > dt / 2 {
                self.owed = self.owed.min(dt);
                break;
            }
        }
        Ok(())
    }

    pub(super) fn redraw(&mut self) -> Result<ControlFlow, ViewError> {
        let begin = Instant::now();
        self.advance()?;
        let input = self.egui.take_egui_input(&self.window);
        let context = self.egui.egui_ctx().clone();
        let mut asked = panel::Asked::of(&self.session);
        let output = context.run_ui(input, |ui| panel::show(ui, self, &mut asked));
        self.screen.take_textures(output.textures_delta);
        let repaint = output
            .viewport_output
            .values()
            .map(|viewport| viewport.repaint_delay)
            .min();
        self.egui
            .handle_platform_output(&self.window, output.platform_output);
        let ui = screen::Ui {
            shapes: context.tessellate(output.shapes, output.pixels_per_point),
            scale: output.pixels_per_point,
        };
        self.picture
            .update(&self.screen, &mut self.session, self.look, &self.eye)?;
        let view = self.picture.view(&self.eye, self.look);
        let drawn = self.picture.content();
        self.screen.draw(&view, &drawn.content(), ui)?;
        self.times.picture(begin.elapsed());
        for action in asked.actions {
            self.act(action)?;
            self.window.request_redraw();
        }
        if asked.settings != *self.session.settings() {
            self.session.apply(Command::Set(asked.settings));
            self.window.request_redraw();
        }
        if self.is_moving() {
            let dt = Duration::from_secs_f32(SceneParams::default().dt);
            return Ok(ControlFlow::WaitUntil(begin + dt));
        }
        let soon = repaint.and_then(|delay| begin.checked_add(delay));
        Ok(soon.map_or(ControlFlow::Wait, ControlFlow::WaitUntil))
    }
}
