//! The solver with many iterations against the reference.

use incise_mesh::{Surface, VertexId, icosphere};
use incise_pbd_gpu::{Collider, Material, Solver, SolverParams, Stiffness};
use incise_reference::{Model, ReferenceError, State, Stepper};

/// A sheet of `n` by `n` squares with a side of 1 m, in the plane of x and z.
fn sheet(n: u32) -> Surface {
    let size = 1.0 / n as f32;
    let mut points = Vec::new();
    let mut faces = Vec::new();
    for i in 0..=n {
        for j in 0..=n {
            points.push([i as f32 * size, 0.0, j as f32 * size]);
            if i < n && j < n {
                let a = i * (n + 1) + j;
                let (b, c, d) = (a + 1, a + n + 2, a + n + 1);
                // Diagonals alternate, so that no direction is weaker.
                if (i + j) % 2 == 0 {
                    faces.extend([[a, b, c], [a, c, d]]);
                } else {
                    faces.extend([[a, b, d], [b, c, d]]);
                }
            }
        }
    }
    Surface::from_triangles(&points, &faces).unwrap()
}

/// Compliances of stretch [m/N] and of bending [rad/(N m)].
#[derive(Debug, Clone, Copy)]
struct Compliances {
    stretch: f32,
    bending: f32,
}

impl Compliances {
    const fn new(stretch: f32, bending: f32) -> Self {
        Self { stretch, bending }
    }
}

/// The sheet thrown while two corners are held; the largest distance of a vertex between the
/// shipped solver and the reference after `steps` of `h` \[s\], over the length of an edge. The
/// reference bends `wrong` times as easily.
fn gap(compliances: Compliances, wrong: f64, h: f32, steps: u32) -> f64 {
    let n = 6;
    let mut surface = sheet(n);
    let material = Material {
        stretch: Stiffness::Compliance(compliances.stretch),
        bending: Some(Stiffness::Compliance(compliances.bending)),
        ..Material::default()
    };
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    for (v, i) in surface.topology().vertices().zip(0_u8..) {
        let wave = f32::from(i).sin();
        solver
            .set_velocity(v, [0.1 * wave, 0.3 * wave, 0.2])
            .unwrap();
    }
    for v in [0, n * (n + 1)] {
        solver.pin(&mut surface, VertexId(v)).unwrap();
    }
    let params = SolverParams {
        iterations: 1000,
        ..SolverParams::paper()
    };
    let mut model = Model::of(&solver, &surface, &params).unwrap();
    model.bending.compliance *= wrong;
    let mut state = State::of(&solver, &surface);
    let mut stepper = Stepper::new(&model).unwrap();
    for _ in 0..steps {
        solver.step(&mut surface, h, &params).unwrap();
        let report = stepper.step(&mut state, h.into(), &[]).unwrap();
        assert!(
            report.decrement < 1e-10,
            "{:e} of the first decrement",
            report.decrement
        );
    }
    let found = State::of(&solver, &surface);
    let apart = found.x.iter().zip(&state.x).map(|(a, b)| (a - b).norm());
    f64::from(n) * apart.fold(0.0, f64::max)
}

const MATERIALS: [Compliances; 4] = [
    Compliances::new(1e-3, 1e-1),
    Compliances::new(1e-4, 1e-2),
    Compliances::new(1e-6, 1e-2),
    Compliances::new(1e-5, 1.0),
];

#[test]
fn a_converged_step_is_that_of_the_reference() {
    // Projections push along the gradients of their way, not along those of its end. The difference
    // goes faster with the substep than what a step moves; that of another body would stay.
    for material in MATERIALS {
        let [coarse, fine] = [90.0, 480.0].map(|rate| gap(material, 1.0, 1.0 / rate, 1));
        assert!(coarse < 5e-4, "{coarse:e} edges of {material:?}");
        assert!(fine < 5e-6, "{fine:e} edges of {material:?}");
        assert!(
            coarse > 16.0 * fine,
            "{coarse:e} and {fine:e} edges of {material:?}"
        );
        for wrong in [0.9, 1.1] {
            let off = gap(material, wrong, 1.0 / 480.0, 1);
            assert!(
                off > 4.0 * fine,
                "{off:e} edges with {wrong} times the bending of {material:?}"
            );
        }
    }
}

#[test]
fn so_is_a_motion() {
    for material in &MATERIALS[..3] {
        let rates = [(75.0, 15), (150.0, 30)];
        let [coarse, fine] = rates.map(|(rate, steps)| gap(*material, 1.0, 1.0 / rate, steps));
        assert!(coarse < 1e-3, "{coarse:e} edges of {material:?}");
        assert!(
            coarse > 2.0 * fine,
            "{coarse:e} and {fine:e} edges of {material:?}"
        );
    }
}

#[test]
fn a_ball_of_rigid_edges_swings_and_keeps_them() {
    let mut surface = icosphere(1, 1.0);
    let material = Material {
        stretch: Stiffness::Pbd(1.0),
        bending: Some(Stiffness::Compliance(1e-2)),
        ..Material::default()
    };
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    solver.pin(&mut surface, VertexId(0)).unwrap();
    let model = Model::of(&solver, &surface, &SolverParams::paper()).unwrap();
    let mut state = State::of(&solver, &surface);
    let mut stepper = Stepper::new(&model).unwrap();
    for step in 0..20 {
        let report = stepper.step(&mut state, 1.0 / 60.0, &[]).unwrap();
        assert!(
            report.decrement < 1e-11,
            "{:e} of the first decrement",
            report.decrement
        );
        for (&[a, b], rest) in model.stretch.vertices.iter().zip(&model.stretch.rest) {
            let off = (state.x[b] - state.x[a]).norm() - rest;
            assert!(
                off.abs() < 1e-12,
                "an edge is off by {off:e} m in step {step}"
            );
        }
    }
    let moved = (state.x.iter()).zip(State::of(&solver, &surface).x);
    let far = moved.fold(0.0, |far: f64, (a, b)| far.max((a - b).norm()));
    assert!(far > 0.1, "it swings, but only by {far} m");
}

#[test]
fn bodies_without_an_energy_are_refused() {
    let material = |stretch, friction| Material {
        stretch,
        bending: None,
        friction,
        ..Material::default()
    };
    let ground = Collider::ground(0.0);
    let on = |material: Material, colliders: &[Collider]| {
        let mut surface = sheet(2);
        let mut solver = Solver::new(&mut surface, &material).unwrap();
        let colliders: Vec<_> = colliders.iter().map(|&c| c.into()).collect();
        solver.set_colliders(&colliders).unwrap();
        Model::of(&solver, &surface, &SolverParams::paper())
    };
    let model = |material| on(material, &[ground]);
    let k = 0.5;
    assert_eq!(
        model(material(Stiffness::Pbd(k), 0.0)),
        Err(ReferenceError::NoEnergy { k })
    );
    let coefficient = 0.5;
    assert_eq!(
        model(material(Stiffness::Pbd(1.0), coefficient)),
        Err(ReferenceError::Friction { coefficient })
    );
    assert_eq!(
        on(material(Stiffness::Pbd(1.0), 0.0), &[ground, ground]),
        Err(ReferenceError::Collider)
    );
}
