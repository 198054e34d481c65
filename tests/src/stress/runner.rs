//! Runner, bodies and materials of the stress tests.

use incise_mesh::{Surface, Vec3, VertexId, icosphere};
use incise_models::place;
use incise_pbd_gpu::{Material, Solver, SolverParams};
use incise_test_support::closed_forms::Advance;
use incise_test_support::energy::{EnergyBudget, Limits};
use incise_test_support::params::set_ground;

/// A stress test: panics where an invariant does not hold.
pub type Case = (&'static str, fn(&mut Runner<'_>));

/// The backend of the tests.
pub struct Runner<'a> {
    /// Steps a body and reads its state back.
    pub advance: Advance<'a>,
    /// A GPU runs a tenth of the frames and is read back after every tenth of them.
    pub is_gpu: bool,
}

impl Runner<'_> {
    /// Returns one value on the GPU, another on the CPU.
    pub(super) fn pick<T>(&self, gpu: T, cpu: T) -> T {
        if self.is_gpu { gpu } else { cpu }
    }

    /// Steps a body.
    pub(super) fn step(&mut self, body: &mut Body, dt: f32, params: &SolverParams, frames: u32) {
        (self.advance)(&mut body.surface, &mut body.solver, dt, params, frames);
    }

    /// Steps a body and asserts its limits throughout.
    pub(super) fn watch(
        &mut self,
        body: &mut Body,
        dt: f32,
        params: &SolverParams,
        frames: u32,
        limits: Limits,
        context: &str,
    ) {
        let mut budget = EnergyBudget::new(&body.surface, &body.solver, params, limits);
        let interval = self.pick(10, 1);
        for _ in 0..frames / interval {
            self.step(body, dt, params, interval);
            let seconds = f64::from(dt) * f64::from(interval);
            budget.check(&body.surface, &body.solver, params, seconds, context);
        }
        budget.finish(&body.surface, &body.solver, context);
    }
}

/// A body in motion.
#[derive(Debug, Clone)]
pub struct Body {
    /// The surface.
    pub surface: Surface,
    /// Its solver.
    pub solver: Solver,
}

impl Body {
    /// Sets a body up; it may be deformed already.
    #[must_use]
    pub fn new(mut surface: Surface, material: &Material) -> Self {
        let solver = Solver::new(&mut surface, material).expect("a body that can be simulated");
        Self { surface, solver }
    }

    /// Sets a body up above the [ground](Self::put_on_ground).
    #[must_use]
    pub(super) fn on_ground(surface: Surface, material: &Material) -> Self {
        let mut body = Self::new(surface, material);
        body.put_on_ground();
        body
    }

    /// Adds a horizontal plane through the origin.
    pub(super) fn put_on_ground(&mut self) {
        set_ground(&mut self.solver, 0.0);
    }

    /// Pins a vertex where it is.
    pub(super) fn pin(&mut self, v: VertexId) {
        (self.solver.pin(&mut self.surface, v)).expect("a vertex");
    }

    /// Moves the target of a pin.
    pub(super) fn set_target(&mut self, v: VertexId, to: [f32; 3]) {
        self.solver.set_pin_target(v, to).expect("a pinned vertex");
    }

    /// Lets a pinned vertex go.
    pub(super) fn unpin(&mut self, v: VertexId) {
        (self.solver.unpin(&mut self.surface, v)).expect("a pinned vertex");
    }

    /// Gives every vertex the same velocity [m/s].
    pub(super) fn throw(&mut self, velocity: [f32; 3]) {
        for v in self.surface.topology().vertices() {
            self.solver.set_velocity(v, velocity).expect("a vertex");
        }
    }

    /// Mean strain of the edges.
    pub(super) fn strain(&self) -> f64 {
        self.solver.stretch_error(&self.surface)
    }
}

/// A sphere of radius 0.5 m around a point at that height \[m\].
#[must_use]
pub fn ball(subdivisions: u32, height: f64) -> Surface {
    let mut surface = icosphere(subdivisions, 0.5);
    place(&mut surface, |p| p + Vec3::new(0.0, height, 0.0));
    surface
}

/// Largest distance along an axis between vertices of two states \[m\].
#[must_use]
pub fn largest_offset(one: &[[f32; 4]], other: &[[f32; 4]]) -> f64 {
    let both = one.iter().zip(other);
    both.flat_map(|(a, b)| (0..3).map(|k| f64::from((a[k] - b[k]).abs())))
        .fold(0.0, |most, way| if way <= most { most } else { way })
}
