//! A simulated body that commands cut, drag and change, frame by frame.

mod blade;
mod cut_history;
mod drag;
mod queries;
mod settings;
mod snapshot;

use crate::command::{Command, Settings};
use crate::recording::Recording;
pub use blade::BladeState;
use blade::Stroke;
use cut_history::CutHistory;
use drag::DraggedVertex;
use incise_mesh::geometry::round_to_f32;
use incise_mesh::{Surface, Vec3, VertexId};
use incise_scene::{BladeId, BodyId, FrameStats, Scene, SceneError};
use std::time::{Duration, Instant};

/// Initial height of a body above the ground, relative to its diagonal.
const DROP: f32 = 0.12;

/// The vertex and the point under the pointer.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PickResult {
    /// Nearest corner of the hit triangle.
    pub vertex: VertexId,
    /// Hit point \[m\].
    pub point: Vec3,
}

/// A message for the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StatusMessage {
    /// Text of the message.
    pub text: String,
    /// True if a command failed.
    pub is_error: bool,
}

/// Work and duration of a frame.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct FrameReport {
    /// Work of the frame and of the commands since the previous frame.
    pub stats: FrameStats,
    /// Duration of both.
    pub time: Duration,
}

/// A simulated body and a blade, changed by [`Command`]s.
#[derive(Debug)]
pub struct Session {
    scene: Scene,
    body: BodyId,
    blade: BladeId,
    /// Initial surface.
    initial: Surface,
    ground: f32,
    diagonal: f32,
    settings: Settings,
    history: CutHistory,
    stroke: Option<Stroke>,
    dragged: Option<DraggedVertex>,
    /// Whether a cut ended inside the body since the start or the last reset.
    has_walls: bool,
    /// Number of frames so far.
    frame: u64,
    last_frame: FrameReport,
    /// Work of the last frame with a cut.
    last_cut_stats: Option<FrameStats>,
    /// Work of cuts and commands since the previous frame.
    pending: FrameReport,
    status_message: Option<StatusMessage>,
    topology: u64,
    positions: u64,
    recording: Recording,
}

impl Session {
    /// Creates a session with a body at rest in an empty scene, with default settings.
    ///
    /// # Errors
    /// As [`Scene::add_body`].
    pub fn new(surface: Surface, scene: Scene) -> Result<Self, SceneError> {
        let settings = Settings::for_surface(&surface);
        Self::with_settings(surface, scene, settings)
    }

    /// Creates a session as [`Session::new`], with the given settings.
    ///
    /// # Errors
    /// As [`Scene::add_body`].
    pub fn with_settings(
        surface: Surface,
        mut scene: Scene,
        settings: Settings,
    ) -> Result<Self, SceneError> {
        let bounds = surface.bounds();
        let diagonal = round_to_f32(bounds.diagonal());
        let ground = bounds.min[1] - DROP * diagonal;
        let recording = Recording::new(&surface, settings);
        scene.params = settings.scene(false);
        scene.colliders = settings.colliders(ground);
        let body = scene.add_body(surface.clone(), &settings.material)?;
        let blade = scene.add_blade([[0.0; 3]; 2]);
        Ok(Self {
            scene,
            body,
            blade,
            initial: surface,
            ground,
            diagonal,
            settings,
            history: CutHistory::default(),
            stroke: None,
            dragged: None,
            has_walls: false,
            frame: 0,
            last_frame: FrameReport::default(),
            last_cut_stats: None,
            pending: FrameReport::default(),
            status_message: None,
            topology: 0,
            positions: 0,
            recording,
        })
    }

    /// Applies a command.
    ///
    /// A command that fails changes nothing and leaves a [message](Self::status_message).
    pub fn apply(&mut self, command: Command) {
        let begin = Instant::now();
        self.recording.record(self.frame, command);
        let done = match command {
            Command::Slice { from, to } => self.slice(from, to),
            Command::Blade { edge } => {
                self.history.clear_redo();
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
        self.pending.time += begin.elapsed();
        self.report_result(done);
    }

    /// Cuts along the motion of the held blade and steps the scene by one frame.
    pub fn frame(&mut self) {
        let begin = Instant::now();
        let done = self.try_frame();
        self.report_result(done);
        let mut now = FrameReport {
            stats: *self.scene.stats(),
            time: begin.elapsed() + self.pending.time,
        };
        add_cuts(&mut now.stats, &self.pending.stats);
        if now.stats.cuts > 0 {
            self.last_cut_stats = Some(now.stats);
        }
        self.pending = FrameReport::default();
        self.last_frame = now;
        self.frame += 1;
    }

    fn try_frame(&mut self) -> Result<(), SceneError> {
        self.advance_drag()?;
        if let Some(cut) = self.advance_stroke()? {
            let snapshot = self.snapshot()?;
            self.scene.cut()?;
            self.end_step()?;
            self.record_cut(cut, snapshot)?;
        } else {
            self.scene.cut()?;
        }
        self.scene.advance()?;
        if self.scene.stats().fell_back {
            let why = self.scene.backend_report().fallback_reason;
            let why = why.map_or_else(String::new, |reason| reason.to_string());
            self.inform(format!("the simulation continues on the CPU: {why}"));
        }
        self.positions += 1;
        Ok(())
    }

    /// Shows the error of a failed command.
    fn report_result(&mut self, done: Result<(), SceneError>) {
        if let Err(error) = done {
            self.report_error(error.to_string());
        }
    }

    fn inform(&mut self, text: String) {
        self.status_message = Some(StatusMessage {
            text,
            is_error: false,
        });
    }

    fn report_error(&mut self, text: String) {
        self.status_message = Some(StatusMessage {
            text,
            is_error: true,
        });
    }
}

/// Adds the cut statistics of commands to those of the next frame.
fn add_cuts(to: &mut FrameStats, cuts: &FrameStats) {
    to.sweeps += cuts.sweeps;
    to.missed_sweeps += cuts.missed_sweeps;
    to.narrow_phase_queries += cuts.narrow_phase_queries;
    to.broad_phase_rejections += cuts.broad_phase_rejections;
    to.aabbs_computed += cuts.aabbs_computed;
    to.bvh_refits += cuts.bvh_refits;
    to.candidate_triangles += cuts.candidate_triangles;
    to.hit_triangles += cuts.hit_triangles;
    to.cuts += cuts.cuts;
    to.failed_cuts += cuts.failed_cuts;
    to.readbacks += cuts.readbacks;
    to.detection += cuts.detection;
    to.topology += cuts.topology;
    to.refinement += cuts.refinement;
    to.constraint_update += cuts.constraint_update;
}

#[cfg(test)]
mod tests;
