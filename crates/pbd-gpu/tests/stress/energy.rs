//! Energy of a body and the limits that every motion without outside work keeps; for `stress`.

use incise_mesh::{Surface, VertexId};
use incise_pbd_gpu::{Batch, ConstraintSet, Solver, SolverParams, Stiffness};
use std::f64::consts::TAU;

/// Largest energy, relative to the energy at the start.
const MAX_ENERGY: f64 = 1.01;
/// Largest speed, relative to that of the lightest vertex if it had all of the energy.
const MAX_SPEED: f64 = 10.0;
/// Largest mean strain of a body that had [`RECOVERY`] to regain its lengths.
pub(crate) const MAX_STRAIN: f64 = 0.05;
/// Time in which a body regains its lengths \[s\].
const RECOVERY: f64 = 5.0;

/// Limits of a motion, beside those of its energy.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// Lowest height that the body can reach; potential energy is 0 there \[m\].
    floor: f64,
    /// Largest distance from the origin \[m\].
    reach: f64,
    /// Whether mean strain is limited after [`RECOVERY`].
    recovers: bool,
}

impl Limits {
    /// Limits energy only.
    pub(crate) const fn above(floor: f64) -> Self {
        Self {
            floor,
            reach: f64::INFINITY,
            recovers: false,
        }
    }

    /// Limits the distance from the origin too \[m\].
    pub(crate) const fn within(self, reach: f64) -> Self {
        Self { reach, ..self }
    }

    /// Limits mean strain at the end too.
    pub(crate) const fn recovering(self) -> Self {
        Self {
            recovers: true,
            ..self
        }
    }
}

/// The energy that a body has at first, and the work done on it since.
#[derive(Debug, Clone)]
pub(crate) struct EnergyBudget {
    limits: Limits,
    budget: f64,
    /// Largest budget so far \[J\].
    scale: f64,
    seconds: f64,
}

impl EnergyBudget {
    /// Takes up the kinetic, potential and elastic energy of a body.
    pub(crate) fn new(
        surface: &Surface,
        solver: &Solver,
        params: &SolverParams,
        limits: Limits,
    ) -> Self {
        let budget = total(surface, solver, params, limits.floor);
        Self {
            limits,
            budget,
            scale: budget,
            seconds: 0.0,
        }
    }

    /// Adds work done on the body \[J\].
    pub(crate) fn add_work(&mut self, work: f64) {
        self.budget += work;
        self.scale = self.scale.max(self.budget);
    }

    /// Lowers the budget to at most `energy` \[J\].
    pub(crate) fn lower(&mut self, energy: f64) {
        self.budget = self.budget.min(energy);
    }

    /// Asserts that a body keeps its limits after `seconds` more.
    pub(crate) fn check(
        &mut self,
        surface: &Surface,
        solver: &Solver,
        params: &SolverParams,
        seconds: f64,
        context: &str,
    ) {
        // Elastic energy is left out: it is never negative, and rounding for stiff constraints.
        let energy = mechanical(surface, solver, params, self.limits.floor);
        let ratio = 1.0 + (energy - self.budget) / self.scale;
        assert!(ratio <= MAX_ENERGY, "{context}: {ratio} of its energy");
        let free = surface.topology().vertices();
        let free = free.filter(|v| surface.positions()[v.index()][3] > 0.0);
        let (mut lightest, mut fastest) = (f64::INFINITY, 0.0_f64);
        for v in free {
            lightest = lightest.min(solver.masses()[v.index()].into());
            let squares = solver.velocity(v).map(|c| f64::from(c).powi(2));
            fastest = fastest.max(squares.iter().sum());
        }
        let most = MAX_SPEED * (2.0 * self.scale / lightest).sqrt();
        assert!(fastest.sqrt() <= most, "{context}: {fastest} (m/s)^2");
        let distance = max_distance(surface);
        assert!(
            distance <= self.limits.reach,
            "{context}: {distance} m from the origin"
        );
        self.seconds += seconds;
    }

    /// Asserts, at the end of a motion, that a body has its lengths again.
    pub(crate) fn finish(&self, surface: &Surface, solver: &Solver, context: &str) {
        // A sum of frames in 32 bits may be a little short.
        if self.limits.recovers && self.seconds > RECOVERY * (1.0 - 1e-6) {
            let strain = solver.stretch_error(surface);
            assert!(strain <= MAX_STRAIN, "{context}: mean strain {strain}");
        }
    }
}

/// Returns the maximum distance of a vertex from the origin \[m\].
pub(crate) fn max_distance(surface: &Surface) -> f64 {
    let all = surface.topology().vertices();
    all.map(|v| surface.position(v).norm())
        .fold(0.0, |most, way| if way <= most { most } else { way })
}

/// Kinetic, potential and elastic energy \[J\].
pub(crate) fn total(surface: &Surface, solver: &Solver, params: &SolverParams, floor: f64) -> f64 {
    mechanical(surface, solver, params, floor) + elastic(surface, solver)
}

/// Kinetic energy and that of gravity above `floor` \[J\].
pub(crate) fn mechanical(
    surface: &Surface,
    solver: &Solver,
    params: &SolverParams,
    floor: f64,
) -> f64 {
    let [gx, gy, gz] = params.gravity.map(f64::from);
    let free = surface.topology().vertices();
    let free = free.filter(|v| surface.positions()[v.index()][3] > 0.0);
    let potential = free.map(|v| {
        let p = surface.position(v);
        let height = gx * p.x + gy * (p.y - floor) + gz * p.z;
        -f64::from(solver.masses()[v.index()]) * height
    });
    solver.kinetic_energy() + potential.sum::<f64>()
}

/// Energy stored in constraints with compliance: half of the squared error over the compliance.
fn elastic(surface: &Surface, solver: &Solver) -> f64 {
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
    if let (Some(compliance), Some(set)) = (material.bending.and_then(compliance), solver.bending())
    {
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
fn batches<const N: usize>(set: &ConstraintSet<N>) -> impl Iterator<Item = &Batch<N>> {
    set.batches().iter().chain([set.overflow()])
}

/// Returns a compliance above 0.
fn compliance(stiffness: Stiffness) -> Option<f64> {
    match stiffness {
        Stiffness::Compliance(value) if value > 0.0 => Some(value.into()),
        _ => None,
    }
}

/// The same angle between -pi and pi.
pub(crate) fn wrapped(angle: f64) -> f64 {
    angle - (angle / TAU).round() * TAU
}

/// Signed angle between the normals at an edge, in the vertex order of bending constraints \[rad\].
pub(crate) fn hinge_angle(surface: &Surface, vertices: [VertexId; 4]) -> f64 {
    let [p0, p1, p2, p3] = vertices.map(|v| surface.position(v));
    let edge = p1 - p0;
    let (first, second) = (edge.cross(&(p2 - p0)), (p3 - p0).cross(&edge));
    (-edge.norm() * (p2 - p0).dot(&second)).atan2(first.dot(&second))
}
