//! What mouse and keyboard do.

use super::{Open, panel};
use crate::error::ViewError;
use crate::keys::action_of;
use crate::pointer::Button;
use winit::event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent};
use winit::event_loop::ControlFlow;
use winit::keyboard::{Key, NamedKey};

/// Pixels of a touchpad that count as one notch of a wheel.
const NOTCH: f64 = 40.0;

impl Open {
    /// Returns until when to wait for the next event, if that has changed.
    pub(super) fn event(&mut self, event: &WindowEvent) -> Result<Option<ControlFlow>, ViewError> {
        if let WindowEvent::RedrawRequested = event {
            return self.redraw().map(Some);
        }
        let answer = self.egui.on_window_event(&self.window, event);
        if answer.repaint {
            self.window.request_redraw();
        }
        match event {
            WindowEvent::CloseRequested => self.is_over = true,
            WindowEvent::Resized(size) => {
                self.screen.resize([size.width, size.height])?;
                self.eye.size = self.screen.size();
                self.eye.covered = self.covered();
                self.window.request_redraw();
            }
            WindowEvent::ModifiersChanged(modifiers) => {
                self.shift = modifiers.state().shift_key();
            }
            WindowEvent::Focused(false) => self.pointer.cancel(&mut self.session),
            WindowEvent::CursorMoved { position, .. } => {
                let to = [position.x, position.y];
                self.pointer.go(to, &mut self.eye, &mut self.session)?;
                if self.pointer.is_busy() {
                    self.window.request_redraw();
                }
            }
            WindowEvent::MouseInput { state, button, .. } => {
                let button = match button {
                    MouseButton::Left => Button::Left,
                    MouseButton::Middle => Button::Middle,
                    MouseButton::Right => Button::Right,
                    _ => return Ok(None),
                };
                self.click(button, *state == ElementState::Pressed)?;
            }
            WindowEvent::MouseWheel { delta, .. } if !self.is_over_panel() => {
                self.eye.zoom(match delta {
                    MouseScrollDelta::LineDelta(_, lines) => f64::from(*lines),
                    MouseScrollDelta::PixelDelta(pixels) => pixels.y / NOTCH,
                });
                self.window.request_redraw();
            }
            WindowEvent::KeyboardInput { event, .. } if event.state == ElementState::Pressed => {
                if self.egui.egui_ctx().text_edit_focused() {
                    return Ok(None);
                }
                let name = match &event.logical_key {
                    Key::Character(character) => character.as_str(),
                    Key::Named(NamedKey::Space) => "Space",
                    Key::Named(NamedKey::Escape) => {
                        self.look.help = false;
                        self.pointer.cancel(&mut self.session);
                        ""
                    }
                    _ => "",
                };
                // A plus is a shifted equals sign on many keyboards.
                let name = if name == "=" { "+" } else { name };
                if let Some(action) = action_of(name) {
                    self.act(action)?;
                }
                self.window.request_redraw();
            }
            _ => {}
        }
        Ok(None)
    }

    fn click(&mut self, button: Button, is_down: bool) -> Result<(), ViewError> {
        if !is_down {
            self.pointer.release(button, &self.eye, &mut self.session)?;
        } else if !self.is_over_panel() {
            self.session.dismiss();
            self.told = None;
            let (eye, session) = (&self.eye, &mut self.session);
            self.pointer.press(button, self.shift, eye, session)?;
        }
        self.window.request_redraw();
        Ok(())
    }

    /// Whether the pointer is over the panel, or over a window of its own.
    fn is_over_panel(&self) -> bool {
        let context = self.egui.egui_ctx();
        let scale = f64::from(context.pixels_per_point());
        let [x, y] = self.pointer.at();
        let at = egui::Pos2::from([x / scale, y / scale].map(panel::narrow));
        let layer = context.layer_id_at(at);
        let is_window = layer.is_some_and(|layer| layer.order != egui::Order::Background);
        is_window || x > f64::from(self.eye.size[0]) - self.eye.covered
    }

    /// How much of the window the panel covers \[px\].
    pub(super) fn covered(&self) -> f64 {
        if self.look.panel {
            f64::from(panel::WIDTH * self.egui.egui_ctx().pixels_per_point())
        } else {
            0.0
        }
    }
}
