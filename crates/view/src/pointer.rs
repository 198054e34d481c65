//! What a pointer's gestures mean.

use crate::command::{Command, Edge, ways};
use crate::session::Session;
use incise_cut::Sweep;
use incise_mesh::geometry::{round, widen};
use incise_mesh::{Aabb, Vec3};
use incise_render::{Camera, Ray};
use incise_scene::SceneError;

/// How far the view turns for a picture's height \[rad\].
const TURN: f64 = std::f64::consts::PI;

/// How much nearer the eye comes with every notch of a wheel.
const NEARER: f64 = 0.9;

/// The steepest view up or down \[rad\].
const STEEPEST: f64 = 1.5;

/// A line that is shorter than this is none \[px\].
const SHORTEST: f64 = 4.0;

/// What the left button does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tool {
    /// Draws a line that cuts.
    #[default]
    Slice,
    /// Holds a blade.
    Blade,
    /// Pulls a vertex.
    Grab,
    /// Pins vertices.
    Pin,
    /// Turns the view.
    Orbit,
}

impl Tool {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Slice, Self::Blade, Self::Grab, Self::Pin, Self::Orbit];

    /// Its name.
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

/// A button of the mouse.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Button {
    /// The tool's.
    Left,
    /// Moves the view.
    Middle,
    /// Turns the view.
    Right,
}

/// From where the body is seen, and in which part of the window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eye {
    /// The camera, with what it circles around as its target.
    pub camera: Camera,
    /// The window \[px\].
    pub size: [u32; 2],
    /// How much of the window's right side is covered \[px\]: the body is shown in the middle of what is left.
    pub covered: f64,
}

impl Eye {
    /// The camera of the whole window.
    #[must_use]
    pub fn shown(&self) -> Camera {
        let [width, height] = self.size.map(|pixels| f64::from(pixels.max(1)));
        let [right, ..] = self.camera.axes();
        let along = (self.camera.field_of_view / 2.0).tan() * self.camera.distance;
        let aside = along * self.covered.min(width) / height;
        Camera {
            target: (Vec3::from(self.camera.target) + right * aside).into(),
            ..self.camera
        }
    }

    /// Width over height of the part that is not covered.
    #[must_use]
    pub fn aspect(&self) -> f64 {
        let [width, height] = self.size.map(|pixels| f64::from(pixels.max(1)));
        ((width - self.covered) / height).max(0.1)
    }

    /// All of a box in the picture.
    pub fn fit(&mut self, bounds: &Aabb) {
        self.camera = self.camera.fit(bounds, self.aspect());
    }

    /// The ray through a place of the window \[px\].
    #[must_use]
    pub fn ray(&self, at: [f64; 2]) -> Ray {
        self.shown().ray(at, self.size.map(|pixels| pixels.max(1)))
    }

    /// Comes nearer by so many notches.
    pub fn zoom(&mut self, notches: f64) {
        let distance = self.camera.distance * NEARER.powf(notches.clamp(-20.0, 20.0));
        if distance.is_normal() {
            self.camera.distance = distance;
        }
    }

    fn turn(&mut self, by: [f64; 2]) {
        let height = f64::from(self.size[1].max(1));
        self.camera.azimuth -= TURN * by[0] / height;
        let elevation = self.camera.elevation + TURN * by[1] / height;
        self.camera.elevation = elevation.clamp(-STEEPEST, STEEPEST);
    }

    fn shift(&mut self, by: [f64; 2]) {
        let height = f64::from(self.size[1].max(1));
        let [right, up, _] = self.camera.axes();
        let scale = 2.0 * (self.camera.field_of_view / 2.0).tan() * self.camera.distance / height;
        let target = Vec3::from(self.camera.target) + (up * by[1] - right * by[0]) * scale;
        self.camera.target = target.into();
    }
}

/// What a button that is down does.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Gesture {
    Turn,
    Shift,
    Line {
        from: [f64; 2],
        is_whole: bool,
    },
    Blade,
    /// Pulls a vertex in the plane through this point that faces the eye.
    Pull {
        point: Vec3,
    },
}

/// A pointer over the picture, and what it is doing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Pointer {
    /// What the left button does.
    pub tool: Tool,
    at: [f64; 2],
    gesture: Option<(Button, Gesture)>,
}

impl Pointer {
    /// Where it is \[px\].
    #[must_use]
    pub const fn at(&self) -> [f64; 2] {
        self.at
    }

    /// Whether a button is down that was pressed over the picture.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.gesture.is_some()
    }

    /// The line that is being drawn \[px\].
    #[must_use]
    pub fn line(&self) -> Option<[[f64; 2]; 2]> {
        match self.gesture {
            Some((_, Gesture::Line { from, .. })) => Some([from, self.at]),
            _ => None,
        }
    }

    /// A button goes down over the picture.
    ///
    /// # Errors
    /// As [`Session::pick`].
    pub fn press(
        &mut self,
        button: Button,
        shift: bool,
        eye: &Eye,
        session: &mut Session,
    ) -> Result<(), SceneError> {
        if self.gesture.is_some() {
            return Ok(());
        }
        let gesture = match (button, self.tool) {
            (Button::Right, _) | (Button::Left, Tool::Orbit) => Gesture::Turn,
            (Button::Middle, _) => Gesture::Shift,
            (Button::Left, Tool::Slice) => Gesture::Line {
                from: self.at,
                is_whole: shift,
            },
            (Button::Left, Tool::Blade) => {
                let edge = edge(&eye.ray(self.at), &session.bounds()?);
                session.apply(Command::Blade { edge });
                Gesture::Blade
            }
            (Button::Left, Tool::Grab | Tool::Pin) => {
                let ray = eye.ray(self.at);
                match session.pick(ray.origin, ray.direction)? {
                    // Beside the body there is nothing to hold but the view.
                    None => Gesture::Turn,
                    Some(picked) if self.tool == Tool::Pin => {
                        let vertex = picked.vertex.0;
                        session.apply(Command::Pin { vertex });
                        return Ok(());
                    }
                    Some(picked) => {
                        let vertex = picked.vertex.0;
                        session.apply(Command::Grab { vertex });
                        let point = session.surface().position(picked.vertex);
                        Gesture::Pull { point }
                    }
                }
            }
        };
        self.gesture = Some((button, gesture));
        Ok(())
    }

    /// The pointer goes elsewhere.
    ///
    /// # Errors
    /// As [`Session::bounds`].
    pub fn go(
        &mut self,
        to: [f64; 2],
        eye: &mut Eye,
        session: &mut Session,
    ) -> Result<(), SceneError> {
        let by = [to[0] - self.at[0], to[1] - self.at[1]];
        self.at = to;
        match self.gesture {
            None | Some((_, Gesture::Line { .. })) => {}
            Some((_, Gesture::Turn)) => eye.turn(by),
            Some((_, Gesture::Shift)) => eye.shift(by),
            Some((_, Gesture::Blade)) => {
                let edge = edge(&eye.ray(to), &session.bounds()?);
                session.apply(Command::Blade { edge });
            }
            Some((_, Gesture::Pull { point })) => {
                let ray = eye.ray(to);
                let [_, _, back] = eye.shown().axes();
                let distance = (point - ray.origin).dot(&back) / ray.direction.dot(&back);
                let to = round(ray.origin + ray.direction * distance);
                session.apply(Command::Drag { to });
            }
        }
        Ok(())
    }

    /// A button goes up, wherever.
    ///
    /// # Errors
    /// As [`Session::bounds`].
    pub fn release(
        &mut self,
        button: Button,
        eye: &Eye,
        session: &mut Session,
    ) -> Result<(), SceneError> {
        let Some((_, gesture)) = self.gesture.take_if(|(pressed, _)| *pressed == button) else {
            return Ok(());
        };
        match gesture {
            Gesture::Turn | Gesture::Shift => {}
            Gesture::Blade => session.apply(Command::FinishBlade),
            Gesture::Pull { .. } => session.apply(Command::Release),
            Gesture::Line { from, is_whole } => {
                let length = (self.at[0] - from[0]).hypot(self.at[1] - from[1]);
                if length >= SHORTEST {
                    let bounds = session.bounds()?;
                    let rays = [eye.ray(from), eye.ray(self.at)];
                    if let Some(command) = slice(rays, is_whole, &bounds) {
                        session.apply(command);
                    }
                }
            }
        }
        Ok(())
    }

    /// Forgets the line that is being drawn, or lets go what is held.
    pub fn cancel(&mut self, session: &mut Session) {
        match self.gesture.take() {
            Some((_, Gesture::Blade)) => session.apply(Command::LiftBlade),
            Some((_, Gesture::Pull { .. })) => session.apply(Command::Release),
            _ => {}
        }
    }
}

/// The cut between two rays from one eye: of what lies between them or, if it is to be whole, of all of the box that their
/// plane meets. None of rays that are one.
#[must_use]
pub fn slice([from, to]: [Ray; 2], is_whole: bool, bounds: &Aabb) -> Option<Command> {
    if !is_whole {
        let (from, to) = (edge(&from, bounds), edge(&to, bounds));
        return (from != to).then_some(Command::Slice { from, to });
    }
    let normal = from.direction.cross(&to.direction).try_normalize(0.0)?;
    let d = normal.dot(&from.origin);
    let sweep = Sweep::across_box(normal.into(), d, bounds).ok()?;
    let [from, to] = ways(&sweep);
    Some(Command::Slice { from, to })
}

/// A ray as a blade's edge: from the eye to well behind the box.
fn edge(ray: &Ray, bounds: &Aabb) -> Edge {
    let away = (bounds.center() - ray.origin).norm();
    let reach = away + bounds.diagonal();
    let start = round(ray.origin);
    let end = round(widen(start) + ray.direction * reach);
    [start, end]
}

#[cfg(test)]
mod tests;
