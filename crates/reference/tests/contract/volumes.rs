//! Volume constraints of the reference against closed forms of a tetrahedron and the solver.

use crate::common::{gravity, run};
use incise_mesh::icosphere;
use incise_pbd_gpu::{Material, Solver, SolverParams, Stiffness, Volume};
use incise_reference::{Constraints, Model, Piece, State, Stepper, Volumes};
use nalgebra::Vector3;

/// The corners of a regular tetrahedron, by their distance from its center \[m\].
fn corners(radius: f64) -> Vec<Vector3<f64>> {
    let c = radius / 3.0_f64.sqrt();
    vec![
        Vector3::new(c, c, c),
        Vector3::new(c, -c, -c),
        Vector3::new(-c, c, -c),
        Vector3::new(-c, -c, c),
    ]
}

/// What a regular tetrahedron encloses by the cube of its radius.
const SHARE: f64 = 0.513_200_239_279_667_3;

/// The length of an edge by the radius.
const EDGE: f64 = 1.632_993_161_855_452;

/// A tetrahedron with a radius of 1 m at rest, of 1 kg a corner.
fn tetrahedron(compressibility: f64, pressure: f64) -> Model {
    let triangles = vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
    Model {
        mass: vec![1.0; 4],
        volumes: Volumes {
            pieces: vec![Piece::new(triangles, SHARE).unwrap()],
            compressibility,
            pressure,
        },
        ..Model::default()
    }
}

/// As that, with edges.
fn framed(compressibility: f64, pressure: f64, compliance: f64) -> Model {
    Model {
        stretch: Constraints {
            vertices: vec![[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]],
            rest: vec![EDGE; 6],
            compliance,
        },
        ..tetrahedron(compressibility, pressure)
    }
}

/// How far the corners are from the center, on average \[m\].
fn radius(state: &State) -> f64 {
    let center = state.x.iter().sum::<Vector3<f64>>() / 4.0;
    state.x.iter().map(|x| (x - center).norm()).sum::<f64>() / 4.0
}

/// The zero of a function that grows, between two numbers.
fn zero(of: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..200 {
        let middle = f64::midpoint(low, high);
        if of(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    f64::midpoint(low, high)
}

#[test]
fn the_numbers_of_a_tetrahedron_are_its_own() {
    let model = tetrahedron(0.0, 1.0);
    let x = corners(1.0);
    assert!((model.volumes.pieces[0].volume(&x) - SHARE).abs() < 1e-15);
    assert!(((x[1] - x[0]).norm() - EDGE).abs() < 1e-15);
}

/// All four corners move alike, so it is one oscillator, as long as no rounding grows that makes it
/// flat: `m r'' = -d/dr (s r^3 - s)^2 / (2 c s)` with `s` the share and four masses.
#[test]
fn a_tetrahedron_breathes_as_backward_euler_says() {
    for (compressibility, start, h) in
        [(1e-4, 1.001, 1e-3), (1e-6, 1.001, 1e-3), (1e-2, 1.05, 0.01)]
    {
        let model = tetrahedron(compressibility, 1.0);
        let mut state = State::at(corners(start));
        let mut stepper = Stepper::new(&model).unwrap();
        let force = |r: f64| 3.0 * SHARE * r * r * (r.powi(3) - 1.0) / compressibility;
        let (mut before, mut now): (f64, f64) = (start, start);
        for step in 0..200 {
            stepper.step(&mut state, h, &[]).unwrap();
            let inertia = 4.0 / (h * h);
            let lacks = |r: f64| inertia * (r - 2.0 * now + before) + force(r);
            let next = zero(lacks, 0.5, 2.0);
            (before, now) = (now, next);
            let off = (radius(&state) - now).abs();
            assert!(
                off < 1e-10,
                "off by {off:e} m in step {step} at {compressibility} / Pa"
            );
        }
        assert!((now - start).abs() > 1e-4, "it moves");
    }
}

/// Where edges pull as hard as the volume pushes (edges that are pressed buckle, so it is more than
/// at rest): `6 k (e r - e) e = p 3 s r^2` with `p = (P - r^3) / c`.
#[test]
fn pressure_inflates_until_the_edges_hold() {
    for (compressibility, pressure, compliance) in [
        (1e-3, 2.0, 1e-2),
        (1e-5, 1.5, 1e-3),
        (0.0, 3.0, 1e-2),
        (0.0, 1.1, 1e-4),
    ] {
        let mut model = framed(compressibility, pressure, compliance);
        model.damping = 20.0;
        let mut state = State::at(corners(1.0));
        let report = run(&model, &mut state, 0.05, 2000);
        let pull = |r: f64| 6.0 * EDGE * EDGE * (r - 1.0) / compliance;
        let push = |r: f64| 3.0 * SHARE * r * r * (pressure - r.powi(3)) / compressibility;
        let expected = if compressibility > 0.0 {
            zero(|r| pull(r) - push(r), 0.3, 2.0)
        } else {
            f64::cbrt(pressure)
        };
        let found = radius(&state);
        assert!(
            (found - expected).abs() < 1e-10,
            "{found} m, not {expected} m at {pressure} volumes"
        );
        let balance = pull(expected) / (3.0 * SHARE * expected.powi(2));
        let off = (report.pressure[0] / balance - 1.0).abs();
        assert!(off < 1e-8, "{} Pa, not {balance} Pa", report.pressure[0]);
    }
}

/// What is kept to the bit of rounding does no work, and pushes nobody else.
#[test]
fn a_rigid_volume_is_kept_in_a_throw() {
    let mut model = framed(0.0, 1.0, 1e-3);
    model.gravity = gravity();
    let mut state = State::at(corners(1.0));
    state.v = vec![
        Vector3::new(3.0, 1.0, 0.0),
        Vector3::new(-2.0, 0.0, 4.0),
        Vector3::new(0.0, 5.0, -3.0),
        Vector3::new(1.0, -2.0, 2.0),
    ];
    let (h, mut stepper) = (0.01, Stepper::new(&model).unwrap());
    for step in 1..=200 {
        let before = model.momentum(&state);
        let report = stepper.step(&mut state, h, &[]).unwrap();
        let off = (model.enclosed(&state)[0] / SHARE - 1.0).abs();
        assert!(off < 1e-11, "volume off by {off:e} in step {step}");
        let change = model.momentum(&state) - before - gravity() * (4.0 * h);
        assert!(change.norm() < 1e-9, "pushed by {change:?} in step {step}");
        assert_eq!(report.pressure.len(), 1);
    }
}

/// The largest distance of a vertex between the shipped solver, given all the iterations that it
/// can use, and the reference after one step of `h` \[s\], over the way that was made.
fn gap(compressibility: f32, wrong: f64, h: f32) -> f64 {
    let mut surface = icosphere(1, 0.5);
    let material = Material {
        stretch: Stiffness::Compliance(1e-3),
        bending: None,
        volume: Some(Volume {
            compressibility,
            pressure: 1.01,
        }),
        ..Material::default()
    };
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    for (v, i) in surface.topology().vertices().zip(0_u8..) {
        let wave = f32::from(i).sin();
        (solver.set_velocity(v, [wave, -0.5 * wave, 0.3 * wave])).unwrap();
    }
    let params = SolverParams {
        iterations: 1000,
        gravity: [0.0; 3],
        ..SolverParams::paper()
    };
    let mut model = Model::of(&solver, &surface, &params).unwrap();
    assert_eq!(model.volumes.pieces.len(), 1, "a ball is one piece");
    model.volumes.compressibility *= wrong;
    let start = State::of(&solver, &surface);
    let mut state = start.clone();
    solver.step(&mut surface, h, &params).unwrap();
    (Stepper::new(&model)
        .unwrap()
        .step(&mut state, h.into(), &[]))
    .unwrap();
    let found = State::of(&solver, &surface);
    let far = |other: &State| {
        let apart = other.x.iter().zip(&state.x).map(|(a, b)| (a - b).norm());
        apart.fold(0.0, f64::max)
    };
    far(&found) / far(&start)
}

#[test]
fn a_converged_step_is_that_of_the_reference() {
    for compressibility in [1e-4, 1e-5] {
        let [coarse, fine] = [60.0, 480.0].map(|rate| gap(compressibility, 1.0, 1.0 / rate));
        assert!(coarse < 0.05, "{coarse:e} of the way at {compressibility}");
        assert!(
            coarse > 4.0 * fine,
            "{coarse:e} and {fine:e} of the way at {compressibility}"
        );
        for wrong in [0.8, 1.25] {
            let off = gap(compressibility, wrong, 1.0 / 480.0);
            assert!(
                off > 4.0 * fine,
                "{off:e} with {wrong} times the compressibility, {fine:e} with the right one"
            );
        }
    }
}
