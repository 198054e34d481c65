//! What is asked of a body under torture: its energies, its strain, how far it reaches, how fast it is.

use super::case::{Case, Found, Kept, larger};
use super::failure::Failure;
use super::stage::Mover;
use incise_mesh::{Surface, VertexId};
use incise_pbd_gpu::{Batch, ConstraintSet, Solver, SolverParams, Stiffness};

/// What every motion has to keep in which nothing outside does unknown work, and how much of it a case can say.
///
/// Of all: energy, and with it that no vertex is faster than ten times what all of the energy would make of the
/// lightest one. Where that is all, the rule is no law beside the case's own.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rule {
    /// Height of no potential energy, the lowest that the body can reach \[m\].
    floor: f64,
    /// How far a vertex may come from the origin \[m\]; none where energy may carry it anywhere.
    reach: Option<f64>,
    /// Whether what was let alone for [`RECOVERY`] has the lengths that it has at rest.
    recovers: bool,
}

/// The rule as a law of a case, beside the case's own.
pub(super) fn rule_of(case: &Case) -> Case {
    Case {
        law: "the rule for all motions: speed, way, strain, energy, the worst of what each may be",
        bound: 1.0,
        ..*case
    }
}

/// How long a body may take to have its lengths again \[s\]. Runs that are shorter do not ask.
const RECOVERY: f64 = 5.0;
/// The largest mean strain of a body that has its lengths.
const RECOVERED: f64 = 0.05;
/// The most energy, of what there was.
const KEPT: f64 = 1.01;
/// How much faster than with all of the energy nothing may ever be.
const FASTER: f64 = 10.0;

impl Rule {
    /// `floor` is the lowest height that vertices can reach \[m\].
    pub(super) const fn above(floor: f64) -> Self {
        Self {
            floor,
            reach: None,
            recovers: false,
        }
    }

    /// Nothing comes farther from the origin \[m\].
    pub(super) const fn within(self, reach: f64) -> Self {
        Self {
            reach: Some(reach),
            ..self
        }
    }

    /// The body has its lengths again in the end.
    pub(super) const fn recovering(self) -> Self {
        Self {
            recovers: true,
            ..self
        }
    }

    /// As [`Rule::recovering`], if so.
    pub(super) const fn recovering_if(self, recovers: bool) -> Self {
        Self { recovers, ..self }
    }
}

/// The largest energy of a body over what there was at first, and the rest of the [`Rule`].
///
/// What there was is kinetic and potential energy, and that of constraints with compliance. What is compared
/// with it leaves the latter out: it is never negative, and of next to rigid constraints it is rounding.
#[derive(Debug, Clone)]
pub(super) struct EnergyLaw {
    rule: Rule,
    /// What there was and was put in \[J\].
    budget: f64,
    /// The most that the budget ever was \[J\].
    scale: f64,
    /// The most energy so far, of the budget: 1 and what is beyond it.
    ratio: f64,
    kept: Option<Kept>,
}

impl EnergyLaw {
    /// Notes what a body has.
    pub(super) fn start(mover: &Mover<'_>, params: &SolverParams, rule: Rule) -> Self {
        let budget = total(mover, params, rule.floor);
        Self {
            rule,
            budget,
            scale: budget,
            ratio: f64::NEG_INFINITY,
            kept: None,
        }
    }

    /// Adds work that was done on the body, or takes it off \[J\].
    pub(super) fn add_work(&mut self, work: f64) {
        self.budget += work;
        self.scale = self.scale.max(self.budget);
    }

    /// From now on there is no more than that \[J\].
    pub(super) fn lower(&mut self, most: f64) {
        self.budget = self.budget.min(most);
    }

    /// Looks at the body after a frame.
    pub(super) fn look(&mut self, mover: &Mover<'_>, params: &SolverParams) {
        let (surface, solver) = (&mover.surface, &mover.solver);
        let now = mechanical(surface, solver, params, self.rule.floor);
        // A budget that work has taken from may be next to nothing, or less than it.
        let ratio = 1.0 + (now - self.budget) / self.scale;
        self.ratio = if ratio.is_nan() {
            f64::INFINITY
        } else {
            self.ratio.max(ratio)
        };
        let (mut lightest, mut speed, mut way) = (f64::INFINITY, 0.0_f64, 0.0_f64);
        for v in surface.topology().vertices() {
            way = way.max(surface.position(v).norm_squared());
            if surface.positions[v.index()][3] > 0.0 {
                lightest = lightest.min(f64::from(solver.masses()[v.index()]));
                let squares = solver.velocity(v).map(|c| f64::from(c).powi(2));
                speed = speed.max(squares.iter().sum());
            }
        }
        let most = FASTER * (2.0 * self.scale / lightest).sqrt();
        self.keep(speed.sqrt() / most, "speed");
        if let Some(reach) = self.rule.reach {
            self.keep(way.sqrt() / reach, "way");
        }
    }

    fn keep(&mut self, part: f64, of: &'static str) {
        let next = Kept { part, of };
        self.kept = Some(self.kept.map_or(next, |known| known.worse(next)));
    }

    /// What the law came to: judged by energy.
    pub(super) fn found(&self) -> Found {
        let found = Found::from(self.ratio);
        // Who keeps energy is not too fast: of speed alone the law beside it says more.
        let says_more = self.rule.reach.is_some() || self.rule.recovers;
        let kept = self.kept.filter(|_| says_more);
        kept.map_or(found, |kept| found.with(kept))
    }

    /// Looks at the body after the last frame of so many seconds.
    fn end(&mut self, mover: &Mover<'_>, seconds: f64) {
        // A clock in 32 bits is a little slow or fast.
        if self.rule.recovers && seconds > RECOVERY * (1.0 - 1e-6) {
            self.keep(mover.strain() / RECOVERED, "mean strain in the end");
        }
    }
}

/// Runs frames under the rule; judged by the largest energy of the budget.
///
/// # Errors
/// As [`Mover::step`].
pub(super) fn energy_over(
    mover: &mut Mover<'_>,
    dt: f32,
    params: &SolverParams,
    frames: u32,
    rule: Rule,
) -> Result<Found, Failure> {
    energy_watched(mover, (dt, params), frames, rule, |_, _| Ok(()))
}

/// As [`energy_over`]; `watch` is shown every frame's end, with its number.
///
/// # Errors
/// As [`Mover::step`], and those of `watch`.
pub(super) fn energy_watched(
    mover: &mut Mover<'_>,
    (dt, params): (f32, &SolverParams),
    frames: u32,
    rule: Rule,
    mut watch: impl FnMut(&Mover<'_>, u32) -> Result<(), Failure>,
) -> Result<Found, Failure> {
    let mut law = EnergyLaw::start(mover, params, rule);
    for frame in 0..frames {
        mover.step(dt, params)?;
        law.look(mover, params);
        watch(mover, frame)?;
    }
    law.end(mover, f64::from(dt) * f64::from(frames));
    Ok(law.found())
}

/// As [`energy_over`], for cases that judge something else: energy is a part of the rule then.
///
/// # Errors
/// As [`Mover::step`].
pub(super) fn keeping(
    mover: &mut Mover<'_>,
    dt: f32,
    params: &SolverParams,
    frames: u32,
    rule: Rule,
) -> Result<Found, Failure> {
    Ok(energy_over(mover, dt, params, frames, rule)?.with_energy())
}

impl Found {
    /// What is judged by its energy, with that as a part of the rule.
    pub(super) fn with_energy(self) -> Self {
        self.with(Kept {
            part: self.value / KEPT,
            of: "energy",
        })
    }
}

/// All energy of a body \[J\].
pub(super) fn total(mover: &Mover<'_>, params: &SolverParams, floor: f64) -> f64 {
    let (surface, solver) = (&mover.surface, &mover.solver);
    mechanical(surface, solver, params, floor) + elastic(surface, solver)
}

/// Kinetic energy and that of gravity above `floor` \[J\].
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
        let free = if surface.positions[v.index()][3] > 0.0 {
            mass
        } else {
            0.0
        };
        -free * (gx * p.x + gy * (p.y - floor) + gz * p.z)
    };
    solver.kinetic_energy() + surface.topology().vertices().map(weight).sum::<f64>()
}

/// What constraints with compliance have stored \[J\]: half of the squared error by the compliance.
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

/// The constraints of a set by color, those without one last.
fn all<const N: usize>(set: &ConstraintSet<N>) -> impl Iterator<Item = &Batch<N>> {
    set.batches().iter().chain([set.overflow()])
}

/// A compliance above 0.
fn compliance(stiffness: Stiffness) -> Option<f64> {
    match stiffness {
        Stiffness::Compliance(value) if value > 0.0 => Some(f64::from(value)),
        _ => None,
    }
}

/// The signed angle between the normals at an edge, the order of vertices being the constraints' own \[rad\].
pub(super) fn angle(surface: &Surface, vertices: [VertexId; 4]) -> f64 {
    let [p0, p1, p2, p3] = vertices.map(|v| surface.position(v));
    let edge = p1 - p0;
    let (first, second) = (edge.cross(&(p2 - p0)), (p3 - p0).cross(&edge));
    (-edge.norm() * (p2 - p0).dot(&second)).atan2(first.dot(&second))
}

/// The fastest vertex [m/s].
pub(super) fn fastest(solver: &Solver) -> f64 {
    let speed = |v: &[f32; 4]| v[..3].iter().map(|&c| f64::from(c).powi(2)).sum::<f64>();
    solver
        .velocities()
        .iter()
        .map(speed)
        .fold(0.0, larger)
        .sqrt()
}

/// The farthest vertex from the origin \[m\].
pub(super) fn farthest(surface: &Surface) -> f64 {
    let all = surface.topology().vertices();
    all.map(|v| surface.position(v).norm()).fold(0.0, larger)
}
