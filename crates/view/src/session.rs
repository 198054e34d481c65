//! What is simulated, and what is done to it. It knows no window.

mod blade;
mod cuts;
mod grip;

use crate::command::{Command, Settings};
use crate::recording::{Entry, Recording};
use blade::Stroke;
use cuts::Cuts;
use grip::Grip;
use incise_mesh::{Aabb, Surface, Vec3, VertexId};
use incise_pbd_gpu::Stiffness;
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
                self.hold_blade(edge);
                Ok(())
            }
            Command::LiftBlade => {
                self.stroke = None;
                Ok(())
            }
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
        self.aim_stroke();
        self.scene.cut()?;
        if let Some([from, to]) = self.end_stroke() {
            self.take_outcomes(from, to);
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

    fn set(&mut self, settings: Settings) -> Result<(), SceneError> {
        if settings.needs_new_body(&self.settings) {
            self.release()?;
            self.renew(&settings)?;
            self.say("the body was made anew where it is, at rest".to_owned());
        } else if settings.material() != self.settings.material() {
            let (solver, surface) = self.scene.edit(self.body)?.solver_mut();
            solver.set_stretch(Stiffness::Pbd(settings.stretch))?;
            solver.set_volume(surface, settings.volume())?;
        }
        let params = settings.scene(self.ground);
        if params != self.scene.params {
            self.scene.params = params;
            self.scene.wake(self.body);
        }
        self.settings = settings;
        Ok(())
    }

    /// Makes the body anew from where it is. Its pins stay, its cuts can still be undone.
    fn renew(&mut self, settings: &Settings) -> Result<(), SceneError> {
        self.scene.read(self.body)?;
        let old = self.scene.body(self.body);
        let pins: Vec<_> = old.solver().pins().iter().map(|pin| pin.vertex).collect();
        let surface = old.surface().clone();
        let body = self.scene.add_body(surface, &settings.material())?;
        self.replace(body);
        let (solver, surface) = self.scene.edit(self.body)?.solver_mut();
        for v in pins {
            solver.pin(surface, v)?;
        }
        Ok(())
    }

    fn replace(&mut self, body: BodyId) {
        // It may be one that cannot be read any more.
        let _old = self.scene.discard_body(self.body);
        self.body = body;
        self.topology += 1;
        self.positions += 1;
    }

    fn reset(&mut self) -> Result<(), SceneError> {
        let first = self.first.clone();
        let body = self.scene.add_body(first, &self.settings.material())?;
        self.stroke = None;
        self.grip = None;
        self.cuts = Cuts::default();
        self.last_cut = None;
        self.notice = None;
        self.replace(body);
        Ok(())
    }

    /// What a ray meets first.
    ///
    /// # Errors
    /// As [`Scene::cast`].
    pub fn pick(&mut self, origin: Vec3, direction: Vec3) -> Result<Option<Picked>, SceneError> {
        let Some(hit) = self.scene.cast(self.body, origin, direction)? else {
            return Ok(None);
        };
        let corners = self.surface().topology().triangle(hit.triangle);
        let point = origin + direction * hit.distance;
        let nearest = (0..3).max_by(|&i, &j| hit.weights[i].total_cmp(&hit.weights[j]));
        Ok(nearest.map(|i| Picked {
            vertex: corners[i],
            point,
        }))
    }

    /// The body as the host knows it; up to date after [`Session::read`].
    #[must_use]
    pub fn surface(&self) -> &Surface {
        self.scene.body(self.body).surface()
    }

    /// Brings the host's copy of the body up to date.
    ///
    /// # Errors
    /// As [`Scene::read`].
    pub fn read(&mut self) -> Result<(), SceneError> {
        self.scene.read(self.body)
    }

    /// The body's box, where it is now \[m\]. Waits for a device.
    ///
    /// # Errors
    /// As [`Scene::read`].
    pub fn bounds(&mut self) -> Result<Aabb, SceneError> {
        self.read()?;
        Ok(self.surface().bounds())
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The body in the [scene](Self::scene).
    #[must_use]
    pub fn body(&self) -> BodyId {
        self.body
    }

    /// Whether the body sleeps, so that frames change nothing.
    #[must_use]
    pub fn is_asleep(&self) -> bool {
        self.scene.is_asleep(self.body) && self.stroke.is_none()
    }

    /// What was chosen.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Height of the ground \[m\].
    #[must_use]
    pub fn ground(&self) -> f32 {
        self.ground
    }

    /// The diagonal of the body's box at first \[m\].
    #[must_use]
    pub fn diagonal(&self) -> f32 {
        self.diagonal
    }

    /// Frames so far.
    #[must_use]
    pub fn frames(&self) -> u64 {
        self.frame
    }

    /// What the last frame did.
    #[must_use]
    pub fn last(&self) -> &Frame {
        &self.last
    }

    /// What the last frame in which anything was cut did.
    #[must_use]
    pub fn last_cut(&self) -> Option<&FrameStats> {
        self.last_cut.as_ref()
    }

    /// What is to be told.
    #[must_use]
    pub fn notice(&self) -> Option<&Notice> {
        self.notice.as_ref()
    }

    /// Takes the notice away.
    pub fn dismiss(&mut self) {
        self.notice = None;
    }

    /// A number that is another one when the body has other triangles.
    #[must_use]
    pub fn topology_version(&self) -> u64 {
        self.topology
    }

    /// A number that is another one when the body may be elsewhere.
    #[must_use]
    pub fn positions_version(&self) -> u64 {
        self.positions
    }

    /// Everything that was done so far.
    #[must_use]
    pub fn recording(&self) -> &Recording {
        &self.recording
    }

    /// A number that tells apart where everything is, to the bit.
    ///
    /// # Errors
    /// As [`Scene::read`].
    pub fn fingerprint(&mut self) -> Result<u64, SceneError> {
        self.read()?;
        Ok(crate::recording::number(self.surface()))
    }

    /// The recording with its end: the frame it is in now, and where everything is.
    ///
    /// # Errors
    /// As [`Scene::read`].
    pub fn finished_recording(&mut self) -> Result<Recording, SceneError> {
        let mut recording = self.recording.clone();
        let state = self.fingerprint()?;
        recording.push(Entry::End {
            frame: self.frame,
            state,
        });
        Ok(recording)
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
