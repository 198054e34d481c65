//! Mouse gestures: tools that cut, drag and pin, and the orbit camera.

use crate::command::{Command, Edge};
use crate::session::Session;
use incise_cut::Sweep;
use incise_mesh::geometry::{to_f32, to_f64};
use incise_mesh::{Aabb, Vec3};
use incise_render::{Camera, Ray};
use incise_scene::{BladeMode, SceneError};

/// Rotation of the view per window height of pointer motion \[rad\].
const TURN: f64 = std::f64::consts::PI;

/// Factor of the camera distance per notch of the mouse wheel.
const ZOOM_FACTOR: f64 = 0.9;

/// Maximum elevation of the camera, up or down \[rad\].
const MAX_ELEVATION: f64 = 1.5;

/// Minimum length of a slice line \[px\].
const MIN_LINE: f64 = 4.0;

/// Minimum distance of a progressive blade from the camera [distance of the body's center].
const MIN_GAP: f64 = 0.1;

/// A tool of the left mouse button.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tool {
    /// Cuts along a line in the view.
    #[default]
    Slice,
    /// Drags a blade.
    Blade,
    /// Drags a vertex.
    Grab,
    /// Pins and unpins vertices.
    Pin,
    /// Rotates the view.
    Orbit,
}

impl Tool {
    /// All tools, in the order of the panel.
    pub const ALL: [Self; 5] = [Self::Slice, Self::Blade, Self::Grab, Self::Pin, Self::Orbit];

    /// Returns the name of the tool.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Slice => "Slice",
            Self::Blade => "Blade",
            Self::Grab => "Grab",
            Self::Pin => "Pin",
            Self::Orbit => "Orbit",
        }
    }
}

/// A mouse button.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Button {
    /// Uses the selected tool.
    Left,
    /// Pans the view.
    Middle,
    /// Rotates the view.
    Right,
}

/// A camera that orbits its target, in a window that a panel may cover in part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrbitCamera {
    /// Camera of the visible part of the window.
    pub camera: Camera,
    /// Width and height of the window \[px\].
    pub size: [u32; 2],
    /// Width of the panel on the right \[px\]; the target is centered in the rest of the window.
    pub panel_width: f64,
}

impl OrbitCamera {
    /// Returns the camera of the whole window, panel included.
    #[must_use]
    pub fn window_camera(&self) -> Camera {
        let [width, height] = self.size.map(|pixels| f64::from(pixels.max(1)));
        let [right, ..] = self.camera.axes();
        let along = (self.camera.field_of_view / 2.0).tan() * self.camera.distance;
        let aside = along * self.panel_width.min(width) / height;
        Camera {
            target: (Vec3::from(self.camera.target) + right * aside).into(),
            ..self.camera
        }
    }

    /// Returns width over height of the visible part.
    #[must_use]
    pub fn aspect(&self) -> f64 {
        let [width, height] = self.size.map(|pixels| f64::from(pixels.max(1)));
        ((width - self.panel_width) / height).max(0.1)
    }

    /// Fits a box in the visible part.
    pub fn fit(&mut self, bounds: &Aabb) {
        self.camera = self.camera.fit(bounds, self.aspect());
    }

    /// Returns the ray through a point of the window \[px\].
    #[must_use]
    pub fn ray(&self, at: [f64; 2]) -> Ray {
        self.window_camera()
            .ray(at, self.size.map(|pixels| pixels.max(1)))
    }

    /// Zooms in by notches of the mouse wheel; negative values zoom out.
    pub fn zoom(&mut self, notches: f64) {
        let distance = self.camera.distance * ZOOM_FACTOR.powf(notches.clamp(-20.0, 20.0));
        if distance.is_normal() {
            self.camera.distance = distance;
        }
    }

    fn rotate(&mut self, by: [f64; 2]) {
        let height = f64::from(self.size[1].max(1));
        self.camera.azimuth -= TURN * by[0] / height;
        let elevation = self.camera.elevation + TURN * by[1] / height;
        self.camera.elevation = elevation.clamp(-MAX_ELEVATION, MAX_ELEVATION);
    }

    fn pan(&mut self, by: [f64; 2]) {
        let height = f64::from(self.size[1].max(1));
        let [right, up, _] = self.camera.axes();
        let scale = 2.0 * (self.camera.field_of_view / 2.0).tan() * self.camera.distance / height;
        let target = Vec3::from(self.camera.target) + (up * by[1] - right * by[0]) * scale;
        self.camera.target = target.into();
    }
}

/// The gesture of a pressed button.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Gesture {
    Rotate,
    Pan,
    /// Draws a slice line, which is extended across the whole body if `is_extended`.
    Line {
        from: [f64; 2],
        is_extended: bool,
    },
    Blade,
    /// Drags a vertex in the plane through this point that is parallel to the image.
    Drag {
        point: Vec3,
    },
}

/// The mouse pointer and its current gesture.
#[derive(Debug, Clone, Copy, Default)]
pub struct Pointer {
    /// Tool of the left mouse button.
    pub tool: Tool,
    at: [f64; 2],
    gesture: Option<(Button, Gesture)>,
}

impl Pointer {
    /// Returns the position of the pointer \[px\].
    #[must_use]
    pub const fn at(&self) -> [f64; 2] {
        self.at
    }

    /// Returns true during a gesture.
    #[must_use]
    pub const fn is_dragging(&self) -> bool {
        self.gesture.is_some()
    }

    /// Returns the ends of the slice line that is being drawn \[px\].
    #[must_use]
    pub fn slice_line(&self) -> Option<[[f64; 2]; 2]> {
        match self.gesture {
            Some((_, Gesture::Line { from, .. })) => Some([from, self.at]),
            _ => None,
        }
    }

    /// Starts the gesture of a pressed button. `shift` extends slice lines across the body.
    ///
    /// # Errors
    /// As [`Session::pick`].
    pub fn press(
        &mut self,
        button: Button,
        shift: bool,
        orbit: &OrbitCamera,
        session: &mut Session,
    ) -> Result<(), SceneError> {
        if self.gesture.is_some() {
            return Ok(());
        }
        let gesture = match (button, self.tool) {
            (Button::Right, _) | (Button::Left, Tool::Orbit) => Gesture::Rotate,
            (Button::Middle, _) => Gesture::Pan,
            (Button::Left, Tool::Slice) => Gesture::Line {
                from: self.at,
                is_extended: shift,
            },
            (Button::Left, Tool::Blade) => {
                let edge = blade_edge(&orbit.ray(self.at), session)?;
                session.apply(Command::Blade { edge });
                Gesture::Blade
            }
            (Button::Left, Tool::Grab | Tool::Pin) => {
                let ray = orbit.ray(self.at);
                match session.pick(ray.origin, ray.direction)? {
                    // Outside of the body the tool rotates the view.
                    None => Gesture::Rotate,
                    Some(picked) if self.tool == Tool::Pin => {
                        let vertex = picked.vertex.0;
                        session.apply(Command::Pin { vertex });
                        return Ok(());
                    }
                    Some(picked) => {
                        let vertex = picked.vertex.0;
                        session.apply(Command::Grab { vertex });
                        let point = session.surface().position(picked.vertex);
                        Gesture::Drag { point }
                    }
                }
            }
        };
        self.gesture = Some((button, gesture));
        Ok(())
    }

    /// Moves the pointer \[px\] and continues its gesture.
    ///
    /// # Errors
    /// As [`Session::bounds`].
    pub fn move_to(
        &mut self,
        to: [f64; 2],
        orbit: &mut OrbitCamera,
        session: &mut Session,
    ) -> Result<(), SceneError> {
        let by = [to[0] - self.at[0], to[1] - self.at[1]];
        self.at = to;
        match self.gesture {
            None | Some((_, Gesture::Line { .. })) => {}
            Some((_, Gesture::Rotate)) => orbit.rotate(by),
            Some((_, Gesture::Pan)) => orbit.pan(by),
            Some((_, Gesture::Blade)) => {
                let edge = blade_edge(&orbit.ray(to), session)?;
                session.apply(Command::Blade { edge });
            }
            Some((_, Gesture::Drag { point })) => {
                let ray = orbit.ray(to);
                let [_, _, back] = orbit.window_camera().axes();
                let distance = (point - ray.origin).dot(&back) / ray.direction.dot(&back);
                let to = to_f32(ray.origin + ray.direction * distance);
                session.apply(Command::Drag { to });
            }
        }
        Ok(())
    }

    /// Ends the gesture of a released button.
    ///
    /// # Errors
    /// As [`Session::bounds`].
    pub fn release(
        &mut self,
        button: Button,
        orbit: &OrbitCamera,
        session: &mut Session,
    ) -> Result<(), SceneError> {
        let Some((_, gesture)) = self.gesture.take_if(|(pressed, _)| *pressed == button) else {
            return Ok(());
        };
        match gesture {
            Gesture::Rotate | Gesture::Pan => {}
            Gesture::Blade => session.apply(Command::FinishBlade),
            Gesture::Drag { .. } => session.apply(Command::Release),
            Gesture::Line { from, is_extended } => {
                let length = (self.at[0] - from[0]).hypot(self.at[1] - from[1]);
                if length >= MIN_LINE {
                    let bounds = session.bounds()?;
                    let rays = [orbit.ray(from), orbit.ray(self.at)];
                    if let Some(command) = slice_command(rays, is_extended, &bounds) {
                        session.apply(command);
                    }
                }
            }
        }
        Ok(())
    }

    /// Cancels the gesture: discards a slice line, lifts the blade, releases a vertex.
    pub fn cancel(&mut self, session: &mut Session) {
        match self.gesture.take() {
            Some((_, Gesture::Blade)) => session.apply(Command::LiftBlade),
            Some((_, Gesture::Drag { .. })) => session.apply(Command::Release),
            _ => {}
        }
    }
}

/// Returns the slice between two rays from the camera, or `None` for parallel rays.
///
/// An extended slice cuts the whole box along the plane of the rays.
#[must_use]
pub fn slice_command([from, to]: [Ray; 2], is_extended: bool, bounds: &Aabb) -> Option<Command> {
    if !is_extended {
        let (from, to) = (edge(&from, bounds), edge(&to, bounds));
        return (from != to).then_some(Command::Slice { from, to });
    }
    let normal = from.direction.cross(&to.direction).try_normalize(0.0)?;
    let d = normal.dot(&from.origin);
    let sweep = Sweep::from_plane(normal.into(), d, bounds).ok()?;
    let [from, to] = sweep.ends();
    Some(Command::Slice { from, to })
}

/// Returns the edge of a held blade along a ray.
///
/// That of a progressive blade starts in front of the body, so that all its points move with the
/// ray: it would have no tip beside a point at rest.
fn blade_edge(ray: &Ray, session: &mut Session) -> Result<Edge, SceneError> {
    let bounds = session.bounds()?;
    let [start, end] = edge(ray, &bounds);
    if session.settings().blade_mode() == BladeMode::FullSlices {
        return Ok([start, end]);
    }
    let away = (bounds.center() - ray.origin).norm();
    let gap = (away - bounds.diagonal()).max(MIN_GAP * away);
    Ok([to_f32(ray.origin + ray.direction * gap), end])
}

/// Returns the blade edge along a ray, from the camera to behind the box.
fn edge(ray: &Ray, bounds: &Aabb) -> Edge {
    let away = (bounds.center() - ray.origin).norm();
    let reach = away + bounds.diagonal();
    let start = to_f32(ray.origin);
    let end = to_f32(to_f64(start) + ray.direction * reach);
    [start, end]
}

#[cfg(test)]
mod tests;
