//! Checks that free bodies keep momentum and energy, and move alike at every frame rate.

#![expect(
    clippy::cast_possible_truncation,
    reason = "velocities and times are rounded to storage"
)]

use incise_mesh::{Surface, VertexId, icosphere};
use incise_models::{Model, build_model};
use incise_pbd_gpu::{Material, Solver, SolverParams};

type Vec3 = [f64; 3];

fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn length(a: Vec3) -> f64 {
    a.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// Returns the center of mass \[m\].
fn center(surface: &Surface, solver: &Solver) -> Vec3 {
    let particles = match solver.is_solid() {
        true => solver.nodes(),
        false => surface.positions(),
    };
    let mut sum = [0.0; 3];
    for p in particles.iter().filter(|p| p[3] > 0.0) {
        (0..3).for_each(|k| sum[k] += f64::from(p[k]) / f64::from(p[3]));
    }
    sum.map(|c| c / solver.total_mass())
}

/// Returns the angular momentum about the center of mass [kg m^2/s] and the kinetic energy of the
/// motion relative to it \[J\].
fn spin(surface: &Surface, solver: &Solver) -> (Vec3, f64) {
    let angular = solver.angular_momentum(surface, center(surface, solver));
    let (mass, momentum) = (solver.total_mass(), length(solver.momentum()));
    let relative = solver.kinetic_energy() - 0.5 * momentum * momentum / mass;
    (angular, relative)
}

/// Ten seconds of flight at 1.2 m/s and 5.5 rad/s: more than eight turns.
#[test]
fn a_spinning_body_keeps_angular_momentum_and_energy() {
    // Softer ones take up a part of the energy as they widen.
    let solid = Material::solid(1e7, 0.45, 1000.0);
    let bodies = [
        ("a solid ball", icosphere(2, 1.0), solid),
        ("a ball as a shell", icosphere(2, 1.0), Material::shell()),
        ("a solid bunny", build_model(Model::Bunny), solid),
    ];
    for (name, mut surface, material) in bodies {
        let mut solver = Solver::new(&mut surface, &material).expect("a valid body");
        let about = center(&surface, &solver);
        for v in surface.topology().vertices() {
            let p = surface.positions()[v.index()];
            let arm = [0, 1, 2].map(|k: usize| f64::from(p[k]) - about[k]);
            let turn = cross([2.0, 5.0, 1.0], arm);
            let velocity = [0, 1, 2].map(|k: usize| ([1.0, 0.5, -0.3][k] + turn[k]) as f32);
            solver.set_velocity(v, velocity).expect("a finite velocity");
        }
        let params = SolverParams {
            gravity: [0.0; 3],
            ..SolverParams::default()
        };
        // Nodes of a solid take the velocities of its vertices when it is stepped.
        solver
            .step(&mut surface, 1.0 / 60.0, &params)
            .expect("a valid frame");
        let (angular, energy) = spin(&surface, &solver);
        for _ in 0..600 {
            solver
                .step(&mut surface, 1.0 / 60.0, &params)
                .expect("a valid frame");
        }
        let (angular_then, energy_then) = spin(&surface, &solver);
        let change = [0, 1, 2].map(|k: usize| angular_then[k] - angular[k]);
        let change = length(change) / length(angular);
        assert!(change < 1e-4, "{name}: {change} of the angular momentum");
        let kept = energy_then / energy;
        assert!(
            (0.995..1.001).contains(&kept),
            "{name}: {kept} of the energy"
        );
    }
}

/// Hangs a bunny on its highest vertices for five seconds, in frames of the given times \[s\].
fn hang(mut times: impl FnMut() -> f32) -> (Surface, f64) {
    let mut surface = build_model(Model::Bunny);
    let mut solver = Solver::new(&mut surface, &Material::soft_body()).expect("a valid body");
    let mut vertices: Vec<VertexId> = surface.topology().vertices().collect();
    let height = |v: &VertexId| surface.positions()[v.index()][1];
    vertices.sort_by(|a, b| height(b).total_cmp(&height(a)));
    for &v in &vertices[..4] {
        solver.pin(&mut surface, v).expect("a vertex of the body");
    }
    let params = SolverParams::default();
    let mut left = 5.0_f64;
    while left > 1e-6 {
        let dt = times().min(left as f32);
        solver.step(&mut surface, dt, &params).expect("a frame");
        left -= f64::from(dt);
    }
    (surface, solver.mean_rest_length())
}

#[test]
fn a_hanging_body_hangs_alike_at_every_frame_rate() {
    let (expected, edge) = hang(|| 1.0 / 60.0);
    let mut seed = 1_u32;
    let mut random = move || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        1.0 / (20.0 + 180.0 * (seed >> 8) as f32 / (1 << 24) as f32)
    };
    let mut long = false;
    let runs = [
        ("30 Hz", hang(|| 1.0 / 30.0)),
        ("144 Hz", hang(|| 1.0 / 144.0)),
        ("random frames", hang(&mut random)),
        (
            "60 and 120 Hz in turn",
            hang(|| {
                long = !long;
                if long { 1.0 / 60.0 } else { 1.0 / 120.0 }
            }),
        ),
    ];
    for (name, (surface, _)) in &runs {
        let pairs = expected.positions().iter().zip(surface.positions());
        let distance = |(a, b): (&[f32; 4], &[f32; 4])| {
            length([0, 1, 2].map(|k: usize| f64::from(a[k]) - f64::from(b[k])))
        };
        let largest = pairs.map(distance).fold(0.0, f64::max) / edge;
        assert!(largest < 0.02, "{name}: {largest} edges");
    }
}
