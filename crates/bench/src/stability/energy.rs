//! Energy, speed, reach and strain of a body, and the limits that every motion keeps.

use super::case::{Case, LimitShare, Outcome};
use super::error::StressError;
use super::runner::Body;
use incise_mesh::{Surface, VertexId};
use incise_pbd_gpu::{Batch, ConstraintSet, Solver, SolverParams, Stiffness};

/// Limits of a motion on which no unknown work is done.
///
/// Energy is always limited, and with it the speed: ten times that of the lightest vertex if it had
/// all of the energy. A case adds the limits that it knows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Lowest height that the body can reach; potential energy is 0 there \[m\].
    floor: f64,
    /// Largest distance from the origin \[m\]; none where the energy reaches anywhere.
    reach: Option<f64>,
    /// Whether the body regains its rest lengths within [`RECOVERY`].
    recovers: bool,
}

/// Returns the limits of every motion as a second invariant of a case.
pub(super) fn limits_of(case: &Case) -> Case {
    Case {
        invariant: "limits of every motion: the largest share of speed, distance, strain or energy",
        bound: 1.0,
        ..*case
    }
}

/// Time in which a body regains its lengths \[s\]; shorter runs do not check it.
const RECOVERY: f64 = 5.0;
/// Largest mean strain of a body that has its lengths.
const MAX_STRAIN: f64 = 0.05;
/// Largest energy, relative to the energy at the start.
const MAX_ENERGY: f64 = 1.01;
/// Largest speed, relative to the speed that all of the energy allows.
const MAX_SPEED: f64 = 10.0;

impl Limits {
    /// Limits energy; `floor` is the lowest height that vertices can reach \[m\].
    pub(super) const fn above(floor: f64) -> Self {
        Self {
            floor,
            reach: None,
            recovers: false,
        }
    }

    /// Limits the distance from the origin too \[m\].
    pub(super) const fn within(self, reach: f64) -> Self {
        Self {
            reach: Some(reach),
            ..self
        }
    }

    /// Limits the mean strain at the end too.
    pub(super) const fn recovering(self) -> Self {
        Self {
            recovers: true,
            ..self
        }
    }

    /// As [`Limits::recovering`] on a condition.
    pub(super) const fn recovering_if(self, recovers: bool) -> Self {
        Self { recovers, ..self }
    }
}

/// The energy at the start of a motion, and how near the motion comes to its [`Limits`].
///
/// The budget is kinetic, potential and elastic energy. Later energies leave out the elastic part,
/// which is never negative, and rounding for stiff constraints.
struct EnergyBudget {
    limits: Limits,
    /// Energy at the start \[J\].
    budget: f64,
    /// Largest energy so far, relative to the budget.
    ratio: f64,
    share: Option<LimitShare>,
}

impl EnergyBudget {
    fn new(body: &Body<'_>, params: &SolverParams, limits: Limits) -> Self {
        Self {
            limits,
            budget: total(body, params, limits.floor),
            ratio: f64::NEG_INFINITY,
            share: None,
        }
    }

    /// Records the state after a frame.
    fn record(&mut self, body: &Body<'_>, params: &SolverParams) {
        let (surface, solver) = (&body.surface, &body.solver);
        let now = mechanical(surface, solver, params, self.limits.floor);
        let ratio = 1.0 + (now - self.budget) / self.budget;
        self.ratio = if ratio.is_nan() {
            f64::INFINITY
        } else {
            self.ratio.max(ratio)
        };
        let (mut lightest, mut speed, mut distance) = (f64::INFINITY, 0.0_f64, 0.0_f64);
        for v in surface.topology().vertices() {
            distance = distance.max(surface.position(v).norm_squared());
            if surface.positions()[v.index()][3] > 0.0 {
                lightest = lightest.min(f64::from(solver.masses()[v.index()]));
                let squares = solver.velocity(v).map(|c| f64::from(c).powi(2));
                speed = speed.max(squares.iter().sum());
            }
        }
        let most = MAX_SPEED * (2.0 * self.budget / lightest).sqrt();
        self.record_share(speed.sqrt() / most, "speed");
        if let Some(reach) = self.limits.reach {
            self.record_share(distance.sqrt() / reach, "way");
        }
    }

    fn record_share(&mut self, part: f64, of: &'static str) {
        let next = LimitShare { part, of };
        self.share = Some(self.share.map_or(next, |known| known.worse(next)));
    }

    /// Records the strain at the end and returns the largest relative energy.
    fn finish(mut self, body: &Body<'_>, seconds: f64) -> Outcome {
        // A sum of frames in 32 bits may be a little short.
        if self.limits.recovers && seconds > RECOVERY * (1.0 - 1e-6) {
            self.record_share(body.strain() / MAX_STRAIN, "mean strain in the end");
        }
        let outcome = Outcome::from(self.ratio);
        // The energy bounds the speed already: a limit of speed alone is no second invariant.
        let is_second = self.limits.reach.is_some() || self.limits.recovers;
        let share = self.share.filter(|_| is_second);
        share.map_or(outcome, |share| outcome.with(share))
    }
}

/// Runs frames within limits; the value is the largest energy relative to the start.
///
/// # Errors
/// As [`Body::step`].
pub(super) fn energy_over(
    body: &mut Body<'_>,
    dt: f32,
    params: &SolverParams,
    frames: u32,
    limits: Limits,
) -> Result<Outcome, StressError> {
    energy_watched(body, (dt, params), frames, limits, |_, _| Ok(()))
}

/// As [`energy_over`]; calls `watch` with the number of every frame at its end.
///
/// # Errors
/// As [`Body::step`], and those of `watch`.
pub(super) fn energy_watched(
    body: &mut Body<'_>,
    (dt, params): (f32, &SolverParams),
    frames: u32,
    limits: Limits,
    mut watch: impl FnMut(&Body<'_>, u32) -> Result<(), StressError>,
) -> Result<Outcome, StressError> {
    let mut budget = EnergyBudget::new(body, params, limits);
    for frame in 0..frames {
        body.step(dt, params)?;
        budget.record(body, params);
        watch(body, frame)?;
    }
    Ok(budget.finish(body, f64::from(dt) * f64::from(frames)))
}

/// As [`energy_over`] for cases with another value: energy is one of the limits then.
///
/// # Errors
/// As [`Body::step`].
pub(super) fn within_limits(
    body: &mut Body<'_>,
    dt: f32,
    params: &SolverParams,
    frames: u32,
    limits: Limits,
) -> Result<Outcome, StressError> {
    Ok(energy_over(body, dt, params, frames, limits)?.with_energy())
}

impl Outcome {
    /// Adds the value, an energy, as one of the limits.
    pub(super) fn with_energy(self) -> Self {
        self.with(LimitShare {
            part: self.value / MAX_ENERGY,
            of: "energy",
        })
    }
}

/// Returns the kinetic, potential and elastic energy of a body \[J\].
fn total(body: &Body<'_>, params: &SolverParams, floor: f64) -> f64 {
    let (surface, solver) = (&body.surface, &body.solver);
    mechanical(surface, solver, params, floor) + elastic(surface, solver)
}

/// Returns the kinetic energy and that of gravity above `floor` \[J\].
pub(super) fn mechanical(
    surface: &Surface,
    solver: &Solver,
    params: &SolverParams,
    floor: f64,
) -> f64 {
    let [gx, gy, gz] = params.gravity.map(f64::from);
    let weight = |v: VertexId| {
        let p = surface.position(v);
        let mass = f64::from(solver.masses()[v.index()]);
        let free = if surface.positions()[v.index()][3] > 0.0 {
            mass
        } else {
            0.0
        };
        -free * (gx * p.x + gy * (p.y - floor) + gz * p.z)
    };
    solver.kinetic_energy() + surface.topology().vertices().map(weight).sum::<f64>()
}

/// Returns the energy in compliant constraints \[J\]: half the squared error over the compliance.
pub(super) fn elastic(surface: &Surface, solver: &Solver) -> f64 {
    let material = solver.material();
    let mut sum = 0.0;
    if let Some(compliance) = compliance(material.stretch) {
        for batch in all(solver.stretch()) {
            for (&[a, b], &rest) in batch.vertices().iter().zip(batch.rest()) {
                let length = (surface.position(b) - surface.position(a)).norm();
                sum += (length - f64::from(rest)).powi(2) / (2.0 * compliance);
            }
        }
    }
    let bending = material.bending.and_then(compliance);
    if let (Some(compliance), Some(set)) = (bending, solver.bending()) {
        for batch in all(set) {
            for (&vertices, &rest) in batch.vertices().iter().zip(batch.rest()) {
                let turn = angle(surface, vertices) - f64::from(rest);
                let turn = turn - (turn / std::f64::consts::TAU).round() * std::f64::consts::TAU;
                sum += turn.powi(2) / (2.0 * compliance);
            }
        }
    }
    sum
}

/// Returns the batches of a set, the overflow last.
fn all<const N: usize>(set: &ConstraintSet<N>) -> impl Iterator<Item = &Batch<N>> {
    set.batches().iter().chain([set.overflow()])
}

/// Returns a compliance above 0.
fn compliance(stiffness: Stiffness) -> Option<f64> {
    match stiffness {
        Stiffness::Compliance(value) if value > 0.0 => Some(f64::from(value)),
        _ => None,
    }
}

/// Returns the signed angle between the normals at an edge, in a constraint's vertex order \[rad\].
fn angle(surface: &Surface, vertices: [VertexId; 4]) -> f64 {
    let [p0, p1, p2, p3] = vertices.map(|v| surface.position(v));
    let edge = p1 - p0;
    let (first, second) = (edge.cross(&(p2 - p0)), (p3 - p0).cross(&edge));
    (-edge.norm() * (p2 - p0).dot(&second)).atan2(first.dot(&second))
}
