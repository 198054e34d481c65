//! Window events: mouse, keyboard, resize and close.

use super::{OpenWindow, panel};
use crate::error::ViewError;
use crate::keys::action_for_key;
use crate::pointer::Button;
use winit::event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent};
use winit::event_loop::ControlFlow;
use winit::keyboard::{Key, NamedKey};

/// Touchpad scroll distance that equals one notch of a mouse wheel \[px\].
const NOTCH: f64 = 40.0;

impl OpenWindow {
    /// Handles an event and returns the new control flow, if it changes.
    pub(super) fn handle(&mut self, event: &WindowEvent) -> Result<Option<ControlFlow>, ViewError> {
        if let WindowEvent::RedrawRequested = event {
            return self.redraw().map(Some);
        }
        let answer = self.egui.on_window_event(&self.window, event);
        if answer.repaint {
            self.window.request_redraw();
        }
        match event {
            WindowEvent::CloseRequested => self.is_closing = true,
            WindowEvent::Resized(size) => {
                self.renderer.resize([size.width, size.height])?;
                self.orbit.size = self.renderer.size();
                self.orbit.panel_width = self.panel_width();
                self.window.request_redraw();
            }
            WindowEvent::ModifiersChanged(modifiers) => {
                self.shift = modifiers.state().shift_key();
            }
            WindowEvent::Focused(false) => self.pointer.cancel(&mut self.session),
            WindowEvent::CursorMoved { position, .. } => {
                let to = [position.x, position.y];
                self.pointer
                    .move_to(to, &mut self.orbit, &mut self.session)?;
                if self.pointer.is_dragging() {
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
                self.orbit.zoom(match delta {
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
                        self.display.help = false;
                        self.pointer.cancel(&mut self.session);
                        ""
                    }
                    _ => "",
                };
                // On many keyboards, plus is shift and equals.
                let name = if name == "=" { "+" } else { name };
                if let Some(action) = action_for_key(name) {
                    self.execute(action)?;
                }
                self.window.request_redraw();
            }
            _ => {}
        }
        Ok(None)
    }

    fn click(&mut self, button: Button, is_down: bool) -> Result<(), ViewError> {
        if !is_down {
            self.pointer
                .release(button, &self.orbit, &mut self.session)?;
        } else if !self.is_over_panel() {
            self.session.clear_status_message();
            self.message = None;
            let (orbit, session) = (&self.orbit, &mut self.session);
            self.pointer.press(button, self.shift, orbit, session)?;
        }
        self.window.request_redraw();
        Ok(())
    }

    /// Returns true if the pointer is over the panel or over the help.
    fn is_over_panel(&self) -> bool {
        let context = self.egui.egui_ctx();
        let scale = f64::from(context.pixels_per_point());
        let [x, y] = self.pointer.at();
        let at = egui::Pos2::from([x / scale, y / scale].map(incise_mesh::geometry::round_to_f32));
        let layer = context.layer_id_at(at);
        let is_window = layer.is_some_and(|layer| layer.order != egui::Order::Background);
        is_window || x > f64::from(self.orbit.size[0]) - self.orbit.panel_width
    }

    /// Returns the width of the visible panel \[px\], or 0.
    pub(super) fn panel_width(&self) -> f64 {
        if self.display.panel {
            f64::from(panel::WIDTH * self.egui.egui_ctx().pixels_per_point())
        } else {
            0.0
        }
    }
}
