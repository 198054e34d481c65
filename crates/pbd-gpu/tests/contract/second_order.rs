//! Second-order integration, and over-relaxation of the XPBD diagonal.

use incise_mesh::{Surface, VertexId, icosphere};
use incise_pbd_gpu::{
    Contact, Density, Integrator, Material, Solver, SolverParams, Stiffness, Volume,
};

const COMPLIANCE: f32 = 1e-3;
const DT: f32 = 1.0 / 60.0;
const WEIGHTLESS: SolverParams = SolverParams {
    iterations: 1,
    substep: None,
    lift: 0.0,
    conserve: false,
    gravity: [0.0; 3],
    residual: None,
    diagonal_scale: 1.0,
    attachments: false,
    integrator: Integrator::Bdf2,
    threads: None,
};

/// A triangle of which one corner moves, between two that are held: along the middle two springs
/// pull as one.
fn spring() -> (Surface, Solver, VertexId) {
    let points = [[0.0, -0.5, 0.0], [0.0, 0.5, 0.0], [1.0, 0.0, 0.0]];
    let mut surface = Surface::from_triangles(&points, &[[0, 1, 2]]).unwrap();
    let material = Material {
        density: Density::Area(1.0),
        stretch: Stiffness::Compliance(COMPLIANCE),
        bending: None,
        damping: 0.0,
        friction: 0.0,
        volume: None,
        interior_springs: None,
        solid: None,
    };
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    for v in [0, 1].map(VertexId) {
        solver.pin(&mut surface, v).unwrap();
    }
    (surface, solver, VertexId(2))
}

/// Where the free corner is along x at the ends of frames, from `start` on.
fn swing(params: &SolverParams, frames: u32, start: f32) -> Vec<f64> {
    let (mut surface, mut solver, v) = spring();
    surface.positions_mut()[v.index()][0] = start;
    let step = |_| {
        solver.step(&mut surface, DT, params).unwrap();
        surface.position(v).x
    };
    (0..frames).map(step).collect()
}

/// The root mean square of differences: at one time alone they may pass through zero.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
    (squares.sum::<f64>() / a.len() as f64).sqrt()
}

#[test]
fn the_formula_is_of_second_order_and_implicit_euler_of_first() {
    let ways = |integrator, substeps| {
        SolverParams {
            // Two springs share the corner: iterations close them.
            iterations: 24,
            integrator,
            ..WEIGHTLESS
        }
        .with_substeps(DT, substeps)
    };
    let frames = 6;
    let exact = swing(&ways(Integrator::Bdf2, 512), frames, 1.05);
    for (integrator, expected) in [(Integrator::Euler, 1.0), (Integrator::Bdf2, 2.0)] {
        let errors =
            [16, 32, 64].map(|n| apart(&swing(&ways(integrator, n), frames, 1.05), &exact));
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!(
                (order - expected).abs() < 0.25,
                "{integrator:?}: order {order} of {errors:?}"
            );
        }
    }
}

#[test]
fn free_fall_equals_the_formula() {
    let (mut surface, mut solver, v) = spring();
    for pinned in [0, 1].map(VertexId) {
        solver.unpin(&mut surface, pinned).unwrap();
    }
    let params = SolverParams {
        gravity: [0.0, -9.81, 0.0],
        ..WEIGHTLESS
    }
    .with_substeps(DT, 5);
    let (h, g) = (f64::from(DT) / 5.0, -9.81);
    let (mut x, mut u) = ([0.0; 2], [0.0; 2]);
    for frame in 0..4 {
        solver.step(&mut surface, DT, &params).unwrap();
        for substep in 0..5 {
            let (to, at) = if frame + substep == 0 {
                (g * h, g * h * h)
            } else {
                let s = h * 2.0 / 3.0;
                let to = (4.0 * u[1] - u[0]) / 3.0 + g * s;
                (to, (4.0 * x[1] - x[0]) / 3.0 + to * s)
            };
            (x, u) = ([x[1], at], [u[1], to]);
        }
        let (y, speed) = (
            surface.position(v).y,
            f64::from(solver.velocities()[v.index()][1]),
        );
        assert!(
            (y - x[1]).abs() < 1e-6,
            "{y}, not {} in frame {frame}",
            x[1]
        );
        assert!((speed - u[1]).abs() < 1e-5, "{speed}, not {}", u[1]);
    }
}

#[test]
fn a_changed_state_restarts_with_first_order() {
    let euler = SolverParams {
        integrator: Integrator::Euler,
        ..WEIGHTLESS
    };
    let (mut surface, mut solver, v) = spring();
    solver.set_velocity(v, [1.0, 0.0, 0.0]).unwrap();
    solver.step(&mut surface, DT, &WEIGHTLESS).unwrap();
    let next = |change: &dyn Fn(&mut Surface, &mut Solver), params: &SolverParams, dt| {
        let (mut surface, mut solver) = (surface.clone(), solver.clone());
        change(&mut surface, &mut solver);
        solver.step(&mut surface, dt, params).unwrap();
        surface.positions()[v.index()]
    };
    let moved =
        |surface: &mut Surface, _: &mut Solver| surface.positions_mut()[v.index()][1] += 0.01;
    let pushed = |_: &mut Surface, solver: &mut Solver| {
        solver.set_velocity(v, [0.0, 1.0, 0.0]).unwrap();
    };
    let untouched = |_: &mut Surface, _: &mut Solver| {};
    assert_eq!(
        next(&moved, &WEIGHTLESS, DT),
        next(&moved, &euler, DT),
        "moved"
    );
    assert_eq!(
        next(&pushed, &WEIGHTLESS, DT),
        next(&pushed, &euler, DT),
        "pushed"
    );
    assert_eq!(
        next(&untouched, &WEIGHTLESS, DT / 2.0),
        next(&untouched, &euler, DT / 2.0),
        "another time step"
    );
    assert_ne!(
        next(&untouched, &WEIGHTLESS, DT),
        next(&untouched, &euler, DT),
        "left alone"
    );
}

#[test]
fn iterations_converge_to_one_result_at_any_diagonal_scale() {
    let by = |diagonal_scale| {
        let params = SolverParams {
            iterations: 60,
            diagonal_scale,
            ..WEIGHTLESS
        }
        .with_substeps(DT, 4);
        swing(&params, 5, 1.05)
    };
    let (whole, half) = (by(1.0), by(0.5));
    assert!(apart(&whole, &half) < 1e-6, "{whole:?} and {half:?}");
    let once = SolverParams {
        diagonal_scale: 0.5,
        ..WEIGHTLESS
    };
    let alone = apart(&swing(&once, 5, 1.05), &swing(&WEIGHTLESS, 5, 1.05));
    assert!(alone > 1e-4, "one iteration tells them apart: {alone}");
}

#[test]
fn diagonal_scales_out_of_range_are_errors() {
    let (mut surface, mut solver, _) = spring();
    for diagonal_scale in [0.49, 1.01, f32::NAN, -1.0] {
        let params = SolverParams {
            diagonal_scale,
            ..WEIGHTLESS
        };
        let refused = solver.step(&mut surface, DT, &params).unwrap_err();
        let text = format!("diagonal_scale is {diagonal_scale}; it must be from 0.5 to 1");
        assert_eq!(refused.to_string(), text);
    }
}

#[test]
fn a_moving_plane_is_followed_in_every_substep() {
    let (mut surface, mut solver, v) = spring();
    let (rate, normal) = (0.5, [1.0, 0.0, 0.0]);
    for integrator in [Integrator::Euler, Integrator::Bdf2] {
        let params = SolverParams {
            integrator,
            ..WEIGHTLESS
        }
        .with_substeps(DT, 4);
        for _ in 0..5 {
            let start = surface.positions()[v.index()][0];
            let plane = Contact {
                gap_rate: rate,
                ..Contact::plane(v, normal, start)
            };
            solver.set_contacts(&[plane]).unwrap();
            solver.step(&mut surface, DT, &params).unwrap();
            let moved = surface.positions()[v.index()][0] - start;
            assert!(moved > rate * DT - 1e-6, "{moved} m with {integrator:?}");
        }
    }
}

#[test]
fn a_volume_recovers_at_the_same_rate_with_both_integrators() {
    for integrator in [Integrator::Euler, Integrator::Bdf2] {
        let mut surface = icosphere(2, 0.5);
        let material = Material {
            density: Density::Area(1.0),
            stretch: Stiffness::Compliance(1e3),
            bending: None,
            volume: Some(Volume::default()),
            interior_springs: None,
            solid: None,
            damping: 0.0,
            friction: 0.0,
        };
        let mut solver = Solver::new(&mut surface, &material).unwrap();
        let rest = surface.volume();
        for p in surface.positions_mut() {
            p[..3].iter_mut().for_each(|c| *c *= 0.9);
        }
        let params = SolverParams {
            integrator,
            ..WEIGHTLESS
        }
        .with_substeps(DT, 4);
        // Three rest volumes per second, from the cube of 0.9.
        let mut expected = 0.729;
        for frame in 0..4 {
            solver.step(&mut surface, DT, &params).unwrap();
            expected += 3.0 * f64::from(DT);
            let found = surface.volume() / rest;
            assert!(
                (found - expected).abs() < 0.01,
                "{found}, not {expected}, in frame {frame} with {integrator:?}"
            );
        }
    }
}
