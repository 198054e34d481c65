//! [`fall`]: a body that is cut on its way to the ground, and what is measured until it lies.

use super::super::case::larger;
use super::super::energy::{elastic, mechanical};
use super::super::error::StressError;
use super::super::scenes::{FRAME, place, whole};
use super::sample::Sample;
use incise_mesh::{Surface, Undo, Vec3};
use incise_pbd_gpu::SolverParams;
use incise_scene::{BackendRequest, BodyId, Scene, SceneParams};

/// Gravitational acceleration [m/s^2].
const GRAVITY: f64 = 9.81;
/// Time after the impact from which volumes count \[s\].
const SETTLING: f64 = 1.0;

/// What a fall did to a body.
#[derive(Debug, Default)]
pub(super) struct Fall {
    /// Largest relative volume error of a piece from a second after the impact on.
    pub(super) volume_error: Option<f64>,
    /// Largest loss of a piece's volume at any time, relative to rest; 1 and more is inverted.
    pub(super) loss: Option<f64>,
    /// Triangles of the piece with the largest loss, and its part of the body's volume.
    pub(super) loser: Option<(usize, f64)>,
    /// Largest distance of a vertex outside of the box that the fall can reach \[sizes\].
    pub(super) outside: f64,
    /// Largest speed of a vertex, relative to that of a fall from the body's top.
    pub(super) speed: f64,
}

/// A dropped body in its scene.
struct Dropped<'a> {
    sample: &'a Sample<'a>,
    scene: Scene,
    body: BodyId,
    /// Height of the body's top at the start \[m\].
    top: f64,
    /// Time of the impact \[s\].
    impact: f64,
    /// Largest horizontal distance from the axis at the start \[m\].
    radius: f64,
    /// Rest volumes of pieces after the cut \[m^3\]; 0 for sheets and unused numbers.
    rest: Vec<f64>,
}

impl<'a> Dropped<'a> {
    /// Lets the body start half its size above the ground.
    fn new(backend: &BackendRequest, sample: &'a Sample<'a>) -> Result<Self, StressError> {
        let size = sample.size;
        let mut surface = sample.subject.surface.clone();
        place(&mut surface, |p| (p + Vec3::new(0.0, 0.5, 0.0)) * size);
        let positions = surface.topology().vertices();
        let radius = positions
            .map(|v| surface.position(v).xz().norm())
            .fold(0.0, f64::max);
        let top = f64::from(surface.bounds().max[1]);
        let params = SceneParams {
            dt: FRAME,
            solver: SolverParams {
                ground: Some(0.0),
                ..SolverParams::default()
            },
            contacts: sample.mix.contacts(),
            ..SceneParams::default()
        };
        let mut scene = Scene::with_backend(params, backend)?;
        let body = scene.add_body(surface, &sample.mix.material())?;
        Ok(Self {
            sample,
            scene,
            body,
            top,
            impact: (size / GRAVITY).sqrt(),
            radius,
            rest: Vec::new(),
        })
    }

    fn surface(&self) -> Result<&Surface, StressError> {
        Ok(self.scene.body(self.body)?.surface())
    }

    fn step(&mut self) -> Result<(), StressError> {
        self.scene.step()?;
        Ok(self.scene.read_back(self.body)?)
    }

    /// Falls half the way and cuts; returns the number of frames and the cut's undo.
    fn cut(&mut self) -> Result<(u32, Option<Undo>), StressError> {
        let frames = whole(FRAME.recip() * narrow(self.impact) / 2.0) - 1;
        for _ in 0..frames {
            self.step()?;
        }
        let (sweep, _) = self.sample.plane.sweep(self.surface()?)?;
        let [before, after] = sweep.ends();
        let blade = self.scene.add_blade(before);
        self.scene.move_blade(blade, after)?;
        self.step()?;
        if let Some(failed) = self.scene.failed_cuts().first() {
            return Err(failed.error.into());
        }
        let cut = (self.scene.cuts().iter()).find_map(|result| result.cut.as_ref());
        let undo = cut.and_then(|(_, outcome)| outcome.undo.clone());
        let surface = self.surface()?;
        let is_open = surface.open_pieces();
        let rest = |piece: u32| match is_open[piece as usize] {
            true => 0.0,
            false => surface.rest_volume_of(
                (surface.topology().triangles()).filter(|&t| surface.piece(t) == piece),
            ),
        };
        self.rest = (0..surface.piece_bound()).map(rest).collect();
        Ok((frames + 1, undo))
    }

    /// Measures the state at a time \[s\].
    fn measure(&self, time: f64, fall: &mut Fall) -> Result<(), StressError> {
        let body = self.scene.body(self.body)?;
        let (surface, solver) = (body.surface(), body.solver());
        let fastest = (2.0 * GRAVITY * self.top).sqrt();
        let reach = self.radius + fastest * time;
        let (mut outside, mut speed) = (0.0, 0.0);
        for v in surface.topology().vertices() {
            let p = surface.position(v);
            let beside = p.xz().norm() - reach;
            outside = larger(outside, beside.max(-p.y).max(p.y - self.top));
            let squares = solver.velocity(v).map(|c| f64::from(c).powi(2));
            speed = larger(speed, squares.iter().sum::<f64>().sqrt());
        }
        fall.outside = larger(fall.outside, outside / self.sample.size);
        fall.speed = larger(fall.speed, speed / fastest);
        let mix = self.sample.mix;
        let whole: f64 = self.rest.iter().sum();
        let volumes = surface.piece_volumes().into_iter().zip(&self.rest);
        for ((volume, &rest), piece) in volumes.zip(0..) {
            if rest == 0.0 {
                continue;
            }
            // The wall of a cavity has two negative volumes.
            let ratio = volume / rest;
            let loss = 1.0 - ratio;
            if (mix.volume || mix.springs) && fall.loss.is_none_or(|most| loss > most) {
                fall.loss = Some(loss);
                fall.loser = Some((surface.piece_triangles(piece), rest / whole));
            }
            if mix.volume && time >= self.impact + SETTLING {
                let error = (ratio - 1.0).abs();
                fall.volume_error = Some(larger(fall.volume_error.unwrap_or(0.0), error));
            }
        }
        Ok(())
    }

    fn energies(&self) -> Result<Energies, StressError> {
        let body = self.scene.body(self.body)?;
        let (surface, solver) = (body.surface(), body.solver());
        let params = &self.scene.params.solver;
        Ok(Energies {
            kinetic: solver.kinetic_energy(),
            mechanical: mechanical(surface, solver, params, 0.0),
            elastic: elastic(surface, solver),
            mass: solver.total_mass(),
        })
    }
}

/// The energies of a body \[J\], and its mass \[kg\].
struct Energies {
    kinetic: f64,
    /// The kinetic and potential energy.
    mechanical: f64,
    elastic: f64,
    mass: f64,
}

/// Drops, cuts and measures a body.
///
/// # Errors
/// [`StressError`] when the body cannot be set up, cut or stepped.
pub(super) fn fall(backend: &BackendRequest, sample: &Sample<'_>) -> Result<Fall, StressError> {
    let mut dropped = Dropped::new(backend, sample)?;
    let mut fall = Fall::default();
    let (first, _) = dropped.cut()?;
    for frame in first..whole(sample.seconds / FRAME) {
        dropped.step()?;
        dropped.measure(f64::from(frame + 1) * f64::from(FRAME), &mut fall)?;
    }
    Ok(fall)
}

/// Drops and cuts a body, undoes the cut after some frames, and returns the energy that it gains
/// in a second, relative to that at the start; `None` if the plane misses.
///
/// Joining the pieces may lift them, which counts as no gain, but must not throw them: in the first
/// frame the kinetic energy is limited, afterwards the mechanical one.
///
/// # Errors
/// As [`fall`].
pub(super) fn undo(
    backend: &BackendRequest,
    sample: &Sample<'_>,
    frames: u32,
) -> Result<Option<f64>, StressError> {
    let mut dropped = Dropped::new(backend, sample)?;
    let start = dropped.energies()?.mechanical;
    let (_, undo) = dropped.cut()?;
    let Some(undo) = undo else {
        return Ok(None);
    };
    for _ in 0..frames {
        dropped.step()?;
    }
    let before = dropped.energies()?;
    dropped.scene.undo(dropped.body, undo)?;
    dropped.step()?;
    let joined = dropped.energies()?;
    // What gravity may add to the kinetic energy in a frame.
    let fall = GRAVITY * f64::from(FRAME) * (before.mass / 2.0).sqrt();
    let allowed = ((before.kinetic + before.elastic).sqrt() + fall).powi(2);
    let mut gain = larger(0.0, joined.kinetic - allowed);
    for _ in 0..whole(FRAME.recip()) {
        dropped.step()?;
        let now = dropped.energies()?;
        gain = larger(gain, now.mechanical - joined.mechanical - before.elastic);
    }
    Ok(Some(gain / start))
}

/// Rounds a time to storage.
#[expect(clippy::cast_possible_truncation, reason = "a number of frames")]
fn narrow(seconds: f64) -> f32 {
    seconds as f32
}
