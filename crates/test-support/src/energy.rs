//! Energy of a body, and the limits that every motion without outside work keeps.

use incise_mesh::{Surface, VertexId};
use incise_pbd_gpu::{Batch, ConstraintSet, Solver, SolverParams, Stiffness};
use std::f64::consts::TAU;

/// Largest energy, relative to the energy at the start.
pub const MAX_ENERGY: f64 = 1.01;
/// Largest speed, relative to that of the lightest vertex if it had all of the energy.
const MAX_SPEED: f64 = 10.0;
/// Largest mean strain of a body that had `RECOVERY` to regain its lengths.
pub const MAX_STRAIN: f64 = 0.05;
/// Time in which a body regains its lengths \[s\].
const RECOVERY: f64 = 5.0;

/// Limits of a motion, beside those of its energy and speed.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Lowest height that the body can reach; potential energy is 0 there \[m\].
    floor: f64,
    /// Largest distance from the origin \[m\]; none where the energy reaches anywhere.
    reach: Option<f64>,
    /// Whether mean strain is limited after [`RECOVERY`].
    recovers: bool,
}

impl Limits {
    /// Limits energy and speed only; `floor` is the lowest height that vertices can reach \[m\].
    #[must_use]
    pub const fn above(floor: f64) -> Self {
        Self {
            floor,
            reach: None,
            recovers: false,
        }
    }

    /// Limits the distance from the origin too \[m\].
    #[must_use]
    pub const fn within(self, reach: f64) -> Self {
        Self {
            reach: Some(reach),
            ..self
        }
    }

    /// Limits mean strain at the end too, on a condition.
    #[must_use]
    pub const fn recovering_if(self, recovers: bool) -> Self {
        Self { recovers, ..self }
    }

    /// Limits mean strain at the end too.
    #[must_use]
    pub const fn recovering(self) -> Self {
        self.recovering_if(true)
    }

    /// Returns whether more than energy and speed is limited.
    #[must_use]
    pub const fn has_more_than_energy(&self) -> bool {
        self.reach.is_some() || self.recovers
    }
}

/// A quantity relative to its limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitShare {
    /// The quantity over its limit.
    pub part: f64,
    /// The name of the quantity.
    pub of: &'static str,
}

impl LimitShare {
    /// Returns the larger share; NaN is larger than any.
    #[must_use]
    pub fn worse(self, other: Self) -> Self {
        if other.part > self.part || other.part.is_nan() {
            other
        } else {
            self
        }
    }
}

/// The energy that a body has at first and the work done on it since, and how near its motion comes
/// to its [`Limits`].
///
/// The budget is kinetic, potential and elastic energy. Later energies leave out the elastic part,
/// which is never negative, and rounding for stiff constraints.
#[derive(Debug, Clone)]
pub struct EnergyBudget {
    limits: Limits,
    budget: f64,
    /// Largest budget so far \[J\].
    scale: f64,
    seconds: f64,
    /// Largest energy so far, relative to the budget; infinite for NaN.
    pub ratio: f64,
    /// Largest share of the other limits so far.
    pub share: Option<LimitShare>,
}

impl EnergyBudget {
    /// Takes up the kinetic, potential and elastic energy of a body.
    #[must_use]
    pub fn new(surface: &Surface, solver: &Solver, params: &SolverParams, limits: Limits) -> Self {
        let budget = total(surface, solver, params, limits.floor);
        Self {
            limits,
            budget,
            scale: budget,
            seconds: 0.0,
            ratio: f64::NEG_INFINITY,
            share: None,
        }
    }

    /// Adds work done on the body \[J\].
    pub fn add_work(&mut self, work: f64) {
        self.budget += work;
        self.scale = self.scale.max(self.budget);
    }

    /// Lowers the budget to at most `energy` \[J\].
    pub fn lower(&mut self, energy: f64) {
        self.budget = self.budget.min(energy);
    }

    /// Records the state of a body after `seconds` more.
    pub fn record(
        &mut self,
        surface: &Surface,
        solver: &Solver,
        params: &SolverParams,
        seconds: f64,
    ) {
        let now = mechanical(surface, solver, params, self.limits.floor);
        let ratio = 1.0 + (now - self.budget) / self.scale;
        self.ratio = match ratio.is_nan() {
            true => f64::INFINITY,
            false => self.ratio.max(ratio),
        };
        let (mut lightest, mut speed, mut distance) = (f64::INFINITY, 0.0_f64, 0.0_f64);
        for v in surface.topology().vertices() {
            distance = distance.max(surface.position(v).norm_squared());
            if surface.positions()[v.index()][3] > 0.0 {
                lightest = lightest.min(solver.masses()[v.index()].into());
                let squares = solver.velocity(v).map(|c| f64::from(c).powi(2));
                speed = speed.max(squares.iter().sum());
            }
        }
        let most = MAX_SPEED * (2.0 * self.scale / lightest).sqrt();
        self.add_share(speed.sqrt() / most, "speed");
        if let Some(reach) = self.limits.reach {
            self.add_share(distance.sqrt() / reach, "way");
        }
        self.seconds += seconds;
    }

    /// Records the strain of a body at the end of its motion.
    pub fn record_end(&mut self, surface: &Surface, solver: &Solver) {
        // A sum of frames in 32 bits may be a little short.
        if self.limits.recovers && self.seconds > RECOVERY * (1.0 - 1e-6) {
            let strain = solver.stretch_error(surface);
            self.add_share(strain / MAX_STRAIN, "mean strain in the end");
        }
    }

    fn add_share(&mut self, part: f64, of: &'static str) {
        let next = LimitShare { part, of };
        self.share = Some(self.share.map_or(next, |known| known.worse(next)));
    }

    /// Asserts that a body keeps its limits after `seconds` more.
    ///
    /// # Panics
    /// If it does not.
    pub fn check(
        &mut self,
        surface: &Surface,
        solver: &Solver,
        params: &SolverParams,
        seconds: f64,
        context: &str,
    ) {
        self.record(surface, solver, params, seconds);
        self.assert_kept(context);
    }

    /// Asserts, at the end of a motion, that a body has its lengths again.
    ///
    /// # Panics
    /// If it does not.
    pub fn finish(&mut self, surface: &Surface, solver: &Solver, context: &str) {
        self.record_end(surface, solver);
        self.assert_kept(context);
    }

    fn assert_kept(&self, context: &str) {
        let ratio = self.ratio;
        assert!(ratio <= MAX_ENERGY, "{context}: {ratio} of its energy");
        if let Some(LimitShare { part, of }) = self.share {
            assert!(part <= 1.0, "{context}: {of}, {part} of its limit");
        }
    }
}

/// Returns the maximum distance of a vertex from the origin \[m\].
#[must_use]
pub fn max_distance(surface: &Surface) -> f64 {
    let all = surface.topology().vertices();
    all.map(|v| surface.position(v).norm())
        .fold(0.0, |most, way| if way <= most { most } else { way })
}

/// Returns the kinetic, potential and elastic energy \[J\].
#[must_use]
pub fn total(surface: &Surface, solver: &Solver, params: &SolverParams, floor: f64) -> f64 {
    mechanical(surface, solver, params, floor) + elastic(surface, solver)
}

/// Returns the kinetic energy and that of gravity above `floor` \[J\].
#[must_use]
pub fn mechanical(surface: &Surface, solver: &Solver, params: &SolverParams, floor: f64) -> f64 {
    let [gx, gy, gz] = params.gravity.map(f64::from);
    let free = surface.topology().vertices();
    let free = free.filter(|v| surface.positions()[v.index()][3] > 0.0);
    let potential = free.map(|v| {
        let p = surface.position(v);
        let mass = f64::from(solver.masses()[v.index()]);
        -mass * (gx * p.x + gy * (p.y - floor) + gz * p.z)
    });
    solver.kinetic_energy() + potential.sum::<f64>()
}

/// Returns the energy in constraints with compliance \[J\]: half the squared error over the
/// compliance.
#[must_use]
pub fn elastic(surface: &Surface, solver: &Solver) -> f64 {
    let material = solver.material();
    let mut sum = 0.0;
    if let Some(compliance) = compliance(material.stretch) {
        for batch in batches(solver.stretch()) {
            for (&[a, b], &rest) in batch.vertices().iter().zip(batch.rest()) {
                let length = (surface.position(b) - surface.position(a)).norm();
                sum += (length - f64::from(rest)).powi(2) / (2.0 * compliance);
            }
        }
    }
    let bending = material.bending.and_then(compliance);
    if let (Some(compliance), Some(set)) = (bending, solver.bending()) {
        for batch in batches(set) {
            for (&vertices, &rest) in batch.vertices().iter().zip(batch.rest()) {
                let turn = wrapped(hinge_angle(surface, vertices) - f64::from(rest));
                sum += turn.powi(2) / (2.0 * compliance);
            }
        }
    }
    sum
}

/// Returns the batches of a set, the overflow last.
pub fn batches<const N: usize>(set: &ConstraintSet<N>) -> impl Iterator<Item = &Batch<N>> {
    set.batches().iter().chain([set.overflow()])
}

/// Returns a compliance above 0.
fn compliance(stiffness: Stiffness) -> Option<f64> {
    match stiffness {
        Stiffness::Compliance(value) if value > 0.0 => Some(value.into()),
        _ => None,
    }
}

/// Returns the same angle between -pi and pi.
#[must_use]
pub fn wrapped(angle: f64) -> f64 {
    angle - (angle / TAU).round() * TAU
}

/// Returns the signed angle between the normals at an edge, in the vertex order of bending
/// constraints \[rad\].
#[must_use]
pub fn hinge_angle(surface: &Surface, vertices: [VertexId; 4]) -> f64 {
    let [p0, p1, p2, p3] = vertices.map(|v| surface.position(v));
    let edge = p1 - p0;
    let (first, second) = (edge.cross(&(p2 - p0)), (p3 - p0).cross(&edge));
    (-edge.norm() * (p2 - p0).dot(&second)).atan2(first.dot(&second))
}
