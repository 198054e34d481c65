//! A step of an incision preserves momentum and angular momentum, and adds no energy to a fall.

use incise_cut::{CutParams, Cutter, Incision};
use incise_mesh::{Surface, Vec3, VertexId, cube_sphere};
use incise_pbd_gpu::{Batch, Density, Material, Solver, SolverParams, Stiffness};

/// Compliance of stretch \[m/N\].
const COMPLIANCE: f32 = 1e-4;

/// Rounding of sums in 32 bits, relative to the sum of absolute values.
const ROUNDING: f64 = 2e-6;

/// Maximum rise of energy by a step, relative to the energy before it.
const MAX_RISE: f64 = 1e-6;

/// Returns the energy in the edges \[J\]: half the squared error over the compliance.
fn elastic_energy(surface: &Surface, solver: &Solver) -> f64 {
    let energy = |[a, b]: [VertexId; 2], rest: f32| {
        let length = (surface.position(b) - surface.position(a)).norm();
        (length - f64::from(rest)).powi(2) / (2.0 * f64::from(COMPLIANCE))
    };
    let of_batch = |batch: &Batch<2>| -> f64 {
        let edges = batch.vertices().iter().zip(batch.rest());
        edges.map(|(&edge, &rest)| energy(edge, rest)).sum()
    };
    let set = solver.stretch();
    let batches = set.batches().iter().chain([set.overflow()]);
    batches.map(of_batch).sum()
}

/// The preserved sums and the energy of a body.
struct Sums {
    momentum: Vec3,
    angular: Vec3,
    energy: f64,
}

impl Sums {
    fn new(surface: &Surface, solver: &Solver) -> Self {
        let about = [3.0, -1.0, 0.5];
        Self {
            momentum: solver.momentum().into(),
            angular: solver.angular_momentum(surface, about).into(),
            energy: solver.kinetic_energy() + elastic_energy(surface, solver),
        }
    }
}

/// Cuts a falling ball step by step and compares its sums before and after each cut alone.
///
/// `spin` is its angular velocity \[rad/s\].
fn cut_a_falling_ball(spin: [f32; 3], compare: impl Fn(&Sums, &Sums, f64)) {
    let mut surface = cube_sphere(8, 0.5);
    let material = Material {
        stretch: Stiffness::Compliance(COMPLIANCE),
        density: Density::Volume(800.0),
        bending: None,
        ..Material::default()
    };
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    let [a, b, c] = spin;
    for v in surface.topology().vertices() {
        let [x, y, z, _] = surface.positions()[v.index()];
        let velocity = [b * z - c * y, c * x - a * z - 1.0, a * y - b * x];
        solver.set_velocity(v, velocity).unwrap();
    }
    let mut cutter = Cutter::new(&surface);
    let mut incision = Incision::default();
    let mut cuts = 0;
    for frame in 0..60u8 {
        let stepped = solver.step(&mut surface, 1.0 / 60.0, &SolverParams::default());
        stepped.unwrap();
        cutter.refit(&surface);
        // The blade falls with the body.
        let bounds = surface.bounds();
        let y = f32::midpoint(bounds.min[1], bounds.max[1]) + 0.02;
        let x = -0.8 + 0.03 * f32::from(frame);
        let pose = [[x, y, -1.0], [x, y, 1.0]];
        let before = Sums::new(&surface, &solver);
        let speed = (2.0 * solver.kinetic_energy() / solver.total_mass()).sqrt();
        let params = CutParams::default();
        let outcome = cutter.advance(&mut surface, &mut incision, &pose, &params);
        let outcome = outcome.unwrap();
        if outcome.is_miss() {
            continue;
        }
        cuts += 1;
        solver.apply_delta(&mut surface, &outcome.delta).unwrap();
        let after = Sums::new(&surface, &solver);
        compare(&before, &after, solver.total_mass() * speed);
    }
    assert!(cuts > 10, "{cuts} steps");
    assert_eq!(surface.piece_count(), 2, "the blade is out");
}

#[test]
fn steps_preserve_the_momentum_of_a_spinning_ball() {
    cut_a_falling_ball([0.1, -0.2, 0.3], |before, after, scale| {
        let lost = (after.momentum - before.momentum).norm();
        assert!(lost <= ROUNDING * scale, "momentum changed by {lost}");
        let lost = (after.angular - before.angular).norm();
        assert!(
            lost <= 4.0 * ROUNDING * scale,
            "angular momentum changed by {lost}"
        );
    });
}

#[test]
fn steps_add_no_energy_to_a_falling_ball() {
    cut_a_falling_ball([0.0; 3], |before, after, _| {
        let rise = (after.energy - before.energy) / before.energy;
        assert!(rise <= MAX_RISE, "the energy rises by {rise}");
    });
}
