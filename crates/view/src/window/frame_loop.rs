//! The frame loop: a fixed time step with an accumulator, replay, and redraw.

use super::{OpenWindow, panel, window_renderer};
use crate::command::Command;
use crate::error::ViewError;
use crate::recording::ReplayProgress;
use incise_scene::SceneParams;
use std::time::{Duration, Instant};
use winit::event_loop::ControlFlow;

/// Maximum simulated frames per redraw: a slow machine shows slow motion but stays responsive.
const MAX_STEPS: u32 = 3;

impl OpenWindow {
    /// Applies the replayed commands and steps one frame.
    pub(super) fn step(&mut self) -> Result<(), ViewError> {
        if let Some(replay) = &mut self.replay
            && let ReplayProgress::Finished(is_same) = replay.advance(&mut self.session)?
        {
            self.replay = None;
            self.paused = true;
            self.message = Some(match is_same {
                Some(true) => ("replay finished, bit-identical".to_owned(), false),
                // GPU drivers may fuse and reorder operations; only CPU results are bit-identical.
                Some(false) if self.is_on_gpu() => (
                    "replay finished; GPU results differ from the recording by rounding".to_owned(),
                    false,
                ),
                Some(false) => ("replay finished, with a different result".to_owned(), true),
                None => ("replay finished".to_owned(), false),
            });
            return Ok(());
        }
        self.session.frame();
        let frame = self.session.last_frame();
        self.times.push(frame.time, frame.stats.cutting());
        Ok(())
    }

    /// Returns true if the body is simulated on a GPU.
    pub(super) fn is_on_gpu(&self) -> bool {
        let report = self.session.scene().backend_report();
        report.gpu_bodies.contains(&self.session.body())
    }

    /// Returns true unless the simulation is paused or the body is at rest.
    fn is_moving(&self) -> bool {
        let rests = self.session.is_asleep() && self.session.held_vertex().is_none();
        !self.paused && (!rests || self.replay.is_some())
    }

    /// Steps as many frames as fit in the time since the last redraw.
    fn advance(&mut self) -> Result<(), ViewError> {
        let now = Instant::now();
        let passed = now - std::mem::replace(&mut self.last_redraw, now);
        let dt = Duration::from_secs_f32(SceneParams::default().dt);
        let is_moving = self.is_moving();
        (self.speed).record(now, self.session.frames(), dt, is_moving);
        if !is_moving {
            self.accumulator = dt;
            return Ok(());
        }
        self.accumulator = (self.accumulator + passed).min(dt * MAX_STEPS);
        let begin = Instant::now();
        while self.accumulator >= dt && self.is_moving() {
            self.accumulator -= dt;
            self.step()?;
            // Redrawing takes precedence over real time.
            if begin.elapsed() > dt / 2 {
                self.accumulator = self.accumulator.min(dt);
                break;
            }
        }
        Ok(())
    }

    /// Steps and draws, then executes the actions and settings of the panel.
    pub(super) fn redraw(&mut self) -> Result<ControlFlow, ViewError> {
        let begin = Instant::now();
        self.advance()?;
        let input = self.egui.take_egui_input(&self.window);
        let context = self.egui.egui_ctx().clone();
        let mut requests = panel::PanelRequests::new(&self.session);
        let output = context.run_ui(input, |ui| panel::show(ui, self, &mut requests));
        self.renderer.take_textures(output.textures_delta);
        let repaint = output
            .viewport_output
            .values()
            .map(|viewport| viewport.repaint_delay)
            .min();
        self.egui
            .handle_platform_output(&self.window, output.platform_output);
        let ui = window_renderer::PanelShapes {
            shapes: context.tessellate(output.shapes, output.pixels_per_point),
            scale: output.pixels_per_point,
        };
        self.scene_view.update(
            self.renderer.scene_renderer(),
            &mut self.session,
            self.display,
            &self.orbit,
        )?;
        let view = self.scene_view.view(&self.orbit, self.display);
        let draw_list = self.scene_view.draw_list();
        self.renderer.draw(&view, &draw_list.as_draw_list(), ui)?;
        self.times.add_redraw(begin.elapsed());
        for action in requests.actions {
            self.execute(action)?;
            self.window.request_redraw();
        }
        if requests.settings != *self.session.settings() {
            self.session.apply(Command::Set(requests.settings));
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
