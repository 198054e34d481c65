//! What is simulated, and what is done to it. It knows no window.

mod blade;
mod cuts;
mod grip;
mod moment;
mod settings;
mod state;

use crate::command::{Command, Settings};
use crate::recording::Recording;
pub use blade::BladePlace;
use blade::Stroke;
use cuts::Cuts;
use grip::Grip;
use incise_mesh::{Surface, Vec3, VertexId};
use incise_scene::{BladeId, BodyId, FrameStats, Scene, SceneError};
use std::time::{Duration, Instant};

/// How far above the ground a body begins, in diagonals.
const DROP: f32 = 0.12;

/// What is under a pointer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Picked {
    /// The corner next to the point.
    pub vertex: VertexId,
    /// The point \[m\].
    pub point: Vec3,
}

/// Something to tell a user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Notice {
    /// What.
    pub text: String,
    /// Whether something could not be done.
    pub is_refusal: bool,
}

/// What a frame did and how long it took.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Frame {
    /// The cuts that were made since the frame before, and the frame's own work.
    pub stats: FrameStats,
    /// Time of both.
    pub time: Duration,
}

/// A body, a blade, and what is done to them.
#[derive(Debug)]
pub struct Session {
    scene: Scene,
    body: BodyId,
    blade: BladeId,
    /// The body as it was at first.
    first: Surface,
    ground: f32,
    diagonal: f32,
    settings: Settings,
    cuts: Cuts,
    stroke: Option<Stroke>,
    grip: Option<Grip>,
    /// Frames so far.
    frame: u64,
    last: Frame,
    /// What the last frame in which anything was cut did.
    last_cut: Option<FrameStats>,
    /// Time of cuts and commands since the frame before.
    since: Frame,
    notice: Option<Notice>,
    topology: u64,
    positions: u64,
    recording: Recording,
}

impl Session {
    /// A session of a body at rest, in an empty scene on whatever backend.
    ///
    /// # Errors
    /// As [`Scene::add_body`].
    pub fn new(surface: Surface, scene: Scene) -> Result<Self, SceneError> {
        Self::with_settings(surface, scene, Settings::default())
    }

    /// As [`Session::new`], with these settings at first.
    ///
    /// # Errors
    /// As [`Scene::add_body`].
    pub fn with_settings(
        surface: Surface,
        mut scene: Scene,
        settings: Settings,
    ) -> Result<Self, SceneError> {
        let bounds = surface.bounds();
        let diagonal = narrow(bounds.diagonal());
        let ground = bounds.min[1] - DROP * diagonal;
        let recording = Recording::new(&surface, settings);
        scene.params = settings.scene(ground);
        let body = scene.add_body(surface.clone(), &settings.material())?;
        let blade = scene.add_blade([[0.0; 3]; 2]);
        Ok(Self {
            scene,
            body,
            blade,
            first: surface,
            ground,
            diagonal,
            settings,
            cuts: Cuts::default(),
            stroke: None,
            grip: None,
            frame: 0,
            last: Frame::default(),
            last_cut: None,
            since: Frame::default(),
            notice: None,
            topology: 0,
            positions: 0,
            recording,
        })
    }

    /// Does a command. What cannot be done changes nothing and leaves a [notice](Self::notice).
    pub fn apply(&mut self, command: Command) {
        let begin = Instant::now();
        self.recording.note(self.frame, command);
        let done = match command {
            Command::Slice { from, to } => self.slice(from, to),
            Command::Blade { edge } => {
                self.cuts.forget_undone();
                self.hold_blade(edge)
            }
            Command::LiftBlade => {
                self.stroke = None;
                Ok(())
            }
            Command::FinishBlade => self.finish_blade(),
            Command::Grab { vertex } => self.grab(VertexId(vertex)),
            Command::Drag { to } => {
                self.drag(to);
                Ok(())
            }
            Command::Release => self.release(),
            Command::Pin { vertex } => self.pin(VertexId(vertex)),
            Command::Unpin => self.unpin(),
            Command::Set(settings) => self.set(settings),
            Command::Reset => self.reset(),
            Command::Undo => self.undo(),
            Command::Redo => self.redo(),
        };
        self.since.time += begin.elapsed();
        self.tell(done);
    }

    /// Steps by a frame.
    pub fn frame(&mut self) {
        let begin = Instant::now();
        let done = self.try_frame();
        self.tell(done);
        let mut now = Frame {
            stats: *self.scene.stats(),
            time: begin.elapsed() + self.since.time,
        };
        add_cuts(&mut now.stats, &self.since.stats);
        if now.stats.cuts > 0 {
            self.last_cut = Some(now.stats);
        }
        self.since = Frame::default();
        self.last = now;
        self.frame += 1;
    }

    fn try_frame(&mut self) -> Result<(), SceneError> {
        self.follow_grip()?;
        if self.aim_stroke()? {
            let moment = self.moment()?;
            self.scene.cut()?;
            if let Some(way) = self.end_stroke() {
                self.take_outcome(way, moment);
            }
        } else {
            self.scene.cut()?;
        }
        self.scene.advance()?;
        if self.scene.stats().fell_back {
            let why = self.scene.backend_report().fallback.unwrap_or_default();
            self.say(format!("on the processor: {why}"));
        }
        self.positions += 1;
        Ok(())
    }

    /// Tells of what went wrong.
    fn tell(&mut self, done: Result<(), SceneError>) {
        if let Err(error) = done {
            self.refuse(error.to_string());
        }
    }

    fn say(&mut self, text: String) {
        self.notice = Some(Notice {
            text,
            is_refusal: false,
        });
    }

    fn refuse(&mut self, text: String) {
        self.notice = Some(Notice {
            text,
            is_refusal: true,
        });
    }
}

/// What a cut did goes with the frame after it.
fn add_cuts(to: &mut FrameStats, cuts: &FrameStats) {
    to.sweeps += cuts.sweeps;
    to.detections += cuts.detections;
    to.detections_skipped += cuts.detections_skipped;
    to.boxes += cuts.boxes;
    to.refits += cuts.refits;
    to.candidates += cuts.candidates;
    to.hits += cuts.hits;
    to.cuts += cuts.cuts;
    to.refused += cuts.refused;
    to.readbacks += cuts.readbacks;
    to.detection += cuts.detection;
    to.topology += cuts.topology;
    to.refinement += cuts.refinement;
    to.constraints += cuts.constraints;
}

#[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
fn narrow(x: f64) -> f32 {
    x as f32
}

#[cfg(test)]
mod tests;
