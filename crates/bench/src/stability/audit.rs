//! What is asked of a body under torture: its energies, its strain, how far it reaches.

use super::failure::Failure;
use super::stage::Mover;
use incise_mesh::{Surface, VertexId};
use incise_pbd_gpu::{Batch, ConstraintSet, Solver, SolverParams, Stiffness};

/// The largest energy of a body over what there was at first.
///
/// What there was is kinetic and potential energy, and that of constraints with compliance. What is compared
/// with it leaves the latter out: it is never negative, and of next to rigid constraints it is rounding.
#[derive(Debug, Clone)]
pub(super) struct EnergyLaw {
    /// Height of no potential energy, the lowest that the body can reach \[m\].
    floor: f64,
    /// What there was and was put in \[J\].
    budget: f64,
    /// The most that the budget ever was \[J\].
    scale: f64,
    /// The most energy so far, of the budget: 1 and what is beyond it.
    pub(super) ratio: f64,
}

impl EnergyLaw {
    /// Notes what a body has. `floor` is the lowest height that its vertices can reach \[m\].
    pub(super) fn start(mover: &Mover<'_>, params: &SolverParams, floor: f64) -> Self {
        let Mover {
            surface, solver, ..
        } = mover;
        let budget = mechanical(surface, solver, params, floor) + elastic(surface, solver);
        Self {
            floor,
            budget,
            scale: budget,
            ratio: f64::NEG_INFINITY,
        }
    }

    /// Adds work that was done on the body, or takes it off \[J\].
    pub(super) fn add_work(&mut self, work: f64) {
        self.budget += work;
        self.scale = self.scale.max(self.budget);
    }

    /// Looks at the body after a frame.
    pub(super) fn look(&mut self, mover: &Mover<'_>, params: &SolverParams) {
        let now = mechanical(&mover.surface, &mover.solver, params, self.floor);
        // A budget that work has taken from may be next to nothing, or less than it.
        let ratio = 1.0 + (now - self.budget) / self.scale;
        self.ratio = if ratio.is_nan() {
            f64::INFINITY
        } else {
            self.ratio.max(ratio)
        };
    }
}

/// Runs frames under the energy law; returns the largest energy of the budget.
///
/// # Errors
/// As [`Mover::step`].
pub(super) fn energy_over(
    mover: &mut Mover<'_>,
    dt: f32,
    params: &SolverParams,
    frames: u32,
    floor: f64,
) -> Result<f64, Failure> {
    let mut law = EnergyLaw::start(mover, params, floor);
    for _ in 0..frames {
        mover.step(dt, params)?;
        law.look(mover, params);
    }
    Ok(law.ratio)
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
        .fold(0.0, f64::max)
        .sqrt()
}

/// The farthest vertex from the origin \[m\].
pub(super) fn farthest(surface: &Surface) -> f64 {
    let all = surface.topology().vertices();
    all.map(|v| surface.position(v).norm()).fold(0.0, f64::max)
}
