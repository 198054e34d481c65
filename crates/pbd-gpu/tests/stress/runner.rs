//! Runner, bodies and materials of the stress tests.

use crate::energy::{EnergyBudget, Limits};
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, VertexId, icosphere};
use incise_pbd_gpu::{Material, Solver, SolverParams, Stiffness};

/// A stress test: panics where an invariant does not hold.
pub(crate) type Case = (&'static str, fn(&mut Runner<'_>));

/// Length of a frame \[s\].
pub(crate) const FRAME: f32 = 1.0 / 60.0;

/// Ground at height 0 and ten iterations of one substep, which is harder than the default.
pub(crate) const GROUND: SolverParams = SolverParams {
    iterations: 10,
    substeps: 1,
    gravity: [0.0, -9.81, 0.0],
    ground: Some(0.0),
    diagonal_scale: 0.5,
    attachments: true,
    ..SolverParams::paper()
};

/// As [`GROUND`], without the ground.
pub(crate) const HANGING: SolverParams = SolverParams {
    ground: None,
    ..GROUND
};

/// As [`HANGING`], without gravity.
pub(crate) const WEIGHTLESS: SolverParams = SolverParams {
    gravity: [0.0; 3],
    ..HANGING
};

/// Steps a body by a number of frames of a length \[s\] and brings its state back.
pub(crate) type Advance<'a> = &'a mut dyn FnMut(&mut Surface, &mut Solver, f32, &SolverParams, u32);

/// The backend of the tests.
pub(crate) struct Runner<'a> {
    pub(crate) advance: Advance<'a>,
    /// A GPU runs a tenth of the frames and is read back after every tenth of them.
    pub(crate) is_gpu: bool,
}

impl Runner<'_> {
    /// Returns one value on the GPU, another on the CPU.
    pub(crate) fn pick<T>(&self, gpu: T, cpu: T) -> T {
        if self.is_gpu { gpu } else { cpu }
    }

    /// Steps a body.
    pub(crate) fn step(&mut self, body: &mut Body, dt: f32, params: &SolverParams, frames: u32) {
        (self.advance)(&mut body.surface, &mut body.solver, dt, params, frames);
    }

    /// Steps a body and asserts its limits throughout.
    pub(crate) fn watch(
        &mut self,
        body: &mut Body,
        (dt, params): (f32, &SolverParams),
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
pub(crate) struct Body {
    pub(crate) surface: Surface,
    pub(crate) solver: Solver,
}

impl Body {
    /// Sets a body up; it may be deformed already.
    pub(crate) fn new(mut surface: Surface, material: &Material) -> Self {
        let solver = Solver::new(&mut surface, material).expect("a body that can be simulated");
        Self { surface, solver }
    }

    /// Pins a vertex where it is.
    pub(crate) fn pin(&mut self, v: VertexId) {
        (self.solver.pin(&mut self.surface, v)).expect("a vertex");
    }

    /// Moves the target of a pin.
    pub(crate) fn set_target(&mut self, v: VertexId, to: [f32; 3]) {
        self.solver.set_pin_target(v, to).expect("a pinned vertex");
    }

    /// Lets a pinned vertex go.
    pub(crate) fn unpin(&mut self, v: VertexId) {
        (self.solver.unpin(&mut self.surface, v)).expect("a pinned vertex");
    }

    /// Gives every vertex the same velocity [m/s].
    pub(crate) fn throw(&mut self, velocity: [f32; 3]) {
        for v in self.surface.topology().vertices() {
            self.solver.set_velocity(v, velocity).expect("a vertex");
        }
    }

    /// Mean strain of the edges.
    pub(crate) fn strain(&self) -> f64 {
        self.solver.stretch_error(&self.surface)
    }
}

/// A shell of 1 kg/m^2 with compliances of stretch [m/N] and of bending [rad/(N m)].
pub(crate) fn elastic_shell(stretch: f32, bending: f32) -> Material {
    Material {
        stretch: Stiffness::Compliance(stretch),
        bending: Some(Stiffness::Compliance(bending)),
        ..Material::default()
    }
}

/// Shells without compliance and with little: of stiffnesses, rigid, elastic.
pub(crate) fn shells() -> [(&'static str, Material); 3] {
    let paper = Material {
        bending: Some(Stiffness::Pbd(1.0)),
        ..Material::default()
    };
    [
        ("stiffness 1", paper),
        ("compliance 0", elastic_shell(0.0, 0.0)),
        ("compliance 1e-5", elastic_shell(1e-5, 1e-2)),
    ]
}

/// A sphere of radius 0.5 m around a point at that height \[m\].
pub(crate) fn ball(subdivisions: u32, height: f64) -> Surface {
    let mut surface = icosphere(subdivisions, 0.5);
    place(&mut surface, |p| p + Vec3::new(0.0, height, 0.0));
    surface
}

/// Moves every vertex, its rest position too.
pub(crate) fn place(surface: &mut Surface, to: impl Fn(Vec3) -> Vec3) {
    for i in 0..surface.positions().len() {
        let rest = to(surface.rest_position(VertexId::from_index(i)));
        surface.rest_positions_mut()[i] = to_f32(rest);
    }
    pose(surface, to);
}

/// Moves every vertex; rest positions stay.
pub(crate) fn pose(surface: &mut Surface, to: impl Fn(Vec3) -> Vec3) {
    for i in 0..surface.positions().len() {
        let [x, y, z] = to_f32(to(surface.position(VertexId::from_index(i))));
        surface.positions_mut()[i] = [x, y, z, surface.positions()[i][3]];
    }
}

/// Largest distance along an axis between vertices of two states \[m\].
pub(crate) fn largest_offset(one: &[[f32; 4]], other: &[[f32; 4]]) -> f64 {
    let both = one.iter().zip(other);
    both.flat_map(|(a, b)| (0..3).map(|k| f64::from((a[k] - b[k]).abs())))
        .fold(0.0, |most, way| if way <= most { most } else { way })
}

/// Seeded numbers (splitmix64, Steele et al. 2014).
#[derive(Debug, Clone)]
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// Returns a number from -1 to 1.
    pub(crate) fn next(&mut self) -> f64 {
        incise_test_support::random::split_mix(&mut self.0) * 2.0 - 1.0
    }

    /// Returns a number between two, its logarithm uniform.
    pub(crate) fn log(&mut self, low: f64, high: f64) -> f32 {
        (low * (high / low).powf(f64::midpoint(self.next(), 1.0))) as f32
    }
}
