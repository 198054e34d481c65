//! Dropped, crushed and torn bodies stay finite and come to rest.

use incise_mesh::{Surface, VertexId};
use incise_pbd_gpu::{Collider, Material, Solver, SolverParams, Stiffness};
use incise_test_support::surfaces::{edge_keys, sphere};

const PARAMS: SolverParams = SolverParams::paper();

/// Returns the solver of a body on the ground.
fn on_ground(surface: &mut Surface, material: &Material) -> Solver {
    let mut solver = Solver::new(surface, material).unwrap();
    solver
        .set_colliders(&[Collider::ground(0.0).into()])
        .unwrap();
    solver
}

fn drop_it(surface: &mut Surface, material: &Material, frames: u32) -> Solver {
    let mut solver = on_ground(surface, material);
    let limit = {
        let (mass, height) = (solver.total_mass(), f64::from(surface.bounds().max[1]));
        mass * 9.81 * height
    };
    for frame in 0..frames {
        solver.step(surface, 1.0 / 60.0, &PARAMS).unwrap();
        let energy = solver.kinetic_energy();
        assert!(
            energy < 1.01 * limit,
            "{energy} J in frame {frame}, there were {limit} J"
        );
    }
    solver
}

#[test]
fn a_hollow_ball_crumples_and_comes_to_rest() {
    for bending in [None, Some(0.0), Some(0.2), Some(1.0)] {
        let material = Material {
            bending: bending.map(Stiffness::Pbd),
            ..Material::default()
        };
        let mut surface = sphere(4, [0.0, 1.5, 0.0]);
        let solver = drop_it(&mut surface, &material, 600);
        let error = solver.stretch_error(&surface);
        assert!(error < 0.1, "edges are off by {error}, bending {bending:?}");
        let energy = solver.kinetic_energy();
        assert!(energy < 1e-3, "{energy} J are left, bending {bending:?}");
    }
}

#[test]
fn degenerate_shapes_stay_finite() {
    let squash: [fn(&mut [f32; 4]); 4] = [
        |p| *p = [0.0, 1.0, 0.0, p[3]],
        |p| *p = [p[0], 1.0, 0.0, p[3]],
        |p| *p = [p[0], 1.0, p[2], p[3]],
        |p| *p = [-p[0], 2.0 - p[1], -p[2], p[3]],
    ];
    for (case, squash) in squash.iter().enumerate() {
        let mut surface = sphere(3, [0.0, 1.0, 0.0]);
        let material = Material {
            bending: Some(Stiffness::Pbd(1.0)),
            ..Material::default()
        };
        let mut solver = on_ground(&mut surface, &material);
        surface.positions_mut().iter_mut().for_each(squash);
        for _ in 0..300 {
            solver.step(&mut surface, 1.0 / 60.0, &PARAMS).unwrap();
        }
        let speed = (2.0 * solver.kinetic_energy() / solver.total_mass()).sqrt();
        assert!(speed < 20.0, "{speed} m/s in case {case}");
    }
}

#[test]
fn any_time_step_and_stiffness_stay_bounded() {
    for frames_per_second in [15.0, 60.0, 600.0, 6000.0] {
        for compliance in [0.0, 1e-12, 1e-6, 1e-3, 1.0, 1e3] {
            for (iterations, substeps) in [(1, 1), (1, 8), (10, 1)] {
                let stiffness = Stiffness::Compliance(compliance);
                let material = Material {
                    stretch: stiffness,
                    bending: Some(stiffness),
                    ..Material::default()
                };
                let mut surface = sphere(2, [0.0, 1.1, 0.0]);
                let mut solver = on_ground(&mut surface, &material);
                let params = SolverParams {
                    iterations,
                    ..PARAMS
                }
                .with_substeps(1.0 / frames_per_second, substeps);
                let limit = solver.total_mass() * 9.81 * 2.1;
                for _ in 0..200 {
                    solver
                        .step(&mut surface, 1.0 / frames_per_second, &params)
                        .unwrap();
                    let energy = solver.kinetic_energy();
                    assert!(
                        energy < 1.01 * limit,
                        "{energy} J of {limit} J at {frames_per_second} Hz, {compliance} m/N, \
                         {iterations} iterations, {substeps} substeps"
                    );
                }
            }
        }
    }
}

#[test]
fn compliance_does_not_depend_on_iterations() {
    // A hanging ball of soft rubber sags by the same length, whatever the number of iterations.
    let sag = |iterations: u32| {
        let material = Material {
            stretch: Stiffness::Compliance(0.02),
            bending: None,
            damping: 2.0,
            ..Material::default()
        };
        let mut surface = sphere(1, [0.0; 3]);
        let mut solver = Solver::new(&mut surface, &material).unwrap();
        solver.pin(&mut surface, VertexId(1)).unwrap();
        let params = SolverParams {
            iterations,
            ..SolverParams::paper()
        };
        for _ in 0..1200 {
            solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
        }
        f64::from(surface.bounds().min[1])
    };
    let (few, many) = (sag(20), sag(80));
    assert!(
        (few - many).abs() < 0.01 * many.abs(),
        "{few} m against {many} m"
    );
}

#[test]
fn the_rest_state_depends_on_neither_time_step_nor_damping() {
    let sag = |h: f32, damping: f32| {
        let material = Material {
            stretch: Stiffness::Compliance(0.02),
            bending: None,
            damping,
            ..Material::default()
        };
        let mut surface = sphere(1, [0.0; 3]);
        let mut solver = Solver::new(&mut surface, &material).unwrap();
        // A body on a single pin would swing without end: damping slows no rigid motion.
        let mut vertices: Vec<VertexId> = surface.topology().vertices().collect();
        vertices.sort_by(|&a, &b| surface.position(b).y.total_cmp(&surface.position(a).y));
        for &v in &vertices[..6] {
            solver.pin(&mut surface, v).unwrap();
        }
        let params = SolverParams {
            iterations: 100,
            ..SolverParams::paper()
        };
        let mut seconds = 0.0;
        while seconds < 10.0 {
            solver.step(&mut surface, h, &params).unwrap();
            seconds += h;
        }
        f64::from(surface.bounds().min[1])
    };
    let expected = sag(1.0 / 60.0, 2.0);
    for (h, damping) in [(1.0 / 60.0, 10.0), (1.0 / 240.0, 2.0)] {
        let found = sag(h, damping);
        assert!(
            (found - expected).abs() < 2e-3 * expected.abs(),
            "{found} m with {damping}/s in steps of {h} s, not {expected} m"
        );
    }
}

#[test]
fn a_mesh_has_each_edge_once() {
    let mut surface = sphere(3, [0.0; 3]);
    let solver = Solver::new(&mut surface, &Material::default()).unwrap();
    assert_eq!(solver.stretch().len(), edge_keys(&surface).len());
    solver.validate(&surface).unwrap();
}

/// Frames of any length consist of equal substeps, whose number varies.
#[test]
fn jittering_time_steps_add_no_energy() {
    for material in [
        Material {
            bending: None,
            ..Material::default()
        },
        Material::default(),
    ] {
        for seed in 1..5_u32 {
            let mut surface = sphere(2, [0.0, 1.1, 0.0]);
            let mut solver = on_ground(&mut surface, &material);
            let energy = |surface: &Surface, solver: &Solver| {
                let weight = |v: VertexId| {
                    let mass = f64::from(solver.masses()[v.index()]);
                    mass * 9.81 * surface.position(v).y
                };
                let all = surface.topology().vertices();
                solver.kinetic_energy() + all.map(weight).sum::<f64>()
            };
            let params = SolverParams {
                substep: Some(1.0 / 600.0),
                ..PARAMS
            };
            let at_first = energy(&surface, &solver);
            let mut random = seed;
            for frame in 0..600 {
                random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let part = (random >> 8) as f32 / (1 << 24) as f32;
                let dt = 10.0_f32.powf(part) / 600.0;
                solver.step(&mut surface, dt, &params).unwrap();
                let now = energy(&surface, &solver);
                assert!(
                    now < 1.01 * at_first,
                    "{now} J of {at_first} in frame {frame}, seed {seed}"
                );
            }
        }
    }
}
