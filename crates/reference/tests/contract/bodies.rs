//! Invariants of the reference for any body: equations, momentum, order, symmetry and rest.

use crate::common::{G, gravity, run};
use incise_reference::{Constraints, Model, Plane, State, StepReport, Stepper, edge, hinge};
use nalgebra::Vector3;

/// A bent strip of four triangles, free to move.
fn strip() -> (Model, State) {
    let x: Vec<Vector3<f64>> = (0..6)
        .map(|i| {
            let along = f64::from(i / 2);
            let side = f64::from(i % 2);
            Vector3::new(along * 0.9, 0.3 * (along - 1.0).abs(), side + 0.1 * along)
        })
        .collect();
    let hinges = vec![[1, 2, 0, 3], [2, 3, 1, 4], [3, 4, 2, 5]];
    let mut edges = Vec::new();
    for i in 0..6 {
        edges.extend((i + 1..6.min(i + 3)).map(|j| [i, j]));
    }
    let rest = edges
        .iter()
        .map(|&[a, b]: &[usize; 2]| 0.9 * (x[b] - x[a]).norm());
    let model = Model {
        mass: (0..6).map(|i| 0.5 + 0.1 * f64::from(i)).collect(),
        stretch: Constraints {
            rest: rest.collect(),
            vertices: edges,
            compliance: 2e-3,
        },
        bending: Constraints {
            rest: vec![0.0; hinges.len()],
            vertices: hinges,
            compliance: 0.05,
        },
        ..Model::default()
    };
    let mut state = State::at(x);
    for (x, v) in state.x.iter().zip(&mut state.v) {
        *v = Vector3::new(0.7, 0.2, -0.1) + Vector3::new(0.5, 1.0, 2.0).cross(x);
    }
    (model, state)
}

fn angular(model: &Model, state: &State) -> Vector3<f64> {
    let each = model.mass.iter().zip(state.x.iter().zip(&state.v));
    each.map(|(m, (x, v))| x.cross(v) * *m).sum()
}

/// The forces of the constraints by their multipliers.
fn forces(model: &Model, state: &State, report: &StepReport) -> Vec<Vector3<f64>> {
    let mut out = vec![Vector3::zeros(); state.x.len()];
    for (vertices, lambda) in model.stretch.vertices.iter().zip(&report.stretch) {
        let of = edge(&vertices.map(|v| state.x[v])).unwrap();
        for (v, gradient) in vertices.iter().zip(of.gradient) {
            out[*v] += gradient * *lambda;
        }
    }
    for (vertices, lambda) in model.bending.vertices.iter().zip(&report.bending) {
        let of = hinge(&vertices.map(|v| state.x[v])).unwrap();
        for (v, gradient) in vertices.iter().zip(of.gradient) {
            out[*v] += gradient * *lambda;
        }
    }
    out
}

#[test]
fn a_step_fulfills_both_equations_and_the_laws_of_momentum() {
    for compliance in [0.0, 2e-3] {
        let (mut model, mut state) = strip();
        model.bending.compliance *= compliance / 2e-3;
        let h = 0.01;
        // Positions of 2 m are off by 4e-16 m, and what is rigid is held by 1e4 m / h^2 of
        // softness.
        let exact = if compliance > 0.0 { 1e-10 } else { 1e-6 };
        let mut stepper = Stepper::new(&model).unwrap();
        let start = model.momentum(&state);
        for _ in 0..100 {
            let before = state.clone();
            let report = stepper.step(&mut state, h, &[]).unwrap();
            assert!(report.decrement < 1e-9, "decrement {:e}", report.decrement);
            let forces = forces(&model, &state, &report);
            let mut loss = Vector3::zeros();
            for (v, force) in forces.iter().enumerate() {
                let needed = (state.v[v] - before.v[v]) * (model.mass[v] / h);
                let off = (force - needed).norm();
                assert!(off < exact, "{off:e} N are missing at vertex {v}");
                loss -= state.v[v].cross(force) * (h * h);
            }
            for (vertices, (rest, lambda)) in
                (model.stretch.vertices.iter()).zip(model.stretch.rest.iter().zip(&report.stretch))
            {
                let length = edge(&vertices.map(|v| state.x[v])).unwrap().value;
                let lack = length - rest + model.stretch.compliance * lambda;
                assert!(lack.abs() < 1e-12, "an edge lacks {lack:e} m");
            }
            for (vertices, (rest, lambda)) in
                (model.bending.vertices.iter()).zip(model.bending.rest.iter().zip(&report.bending))
            {
                let angle = hinge(&vertices.map(|v| state.x[v])).unwrap().value;
                let lack = angle - rest + model.bending.compliance * lambda;
                assert!(lack.abs() < 1e-11, "a hinge lacks {lack:e} rad");
            }
            let turned = angular(&model, &state) - angular(&model, &before);
            let off = (turned - loss).norm();
            assert!(
                off < 1e-10,
                "the change of angular momentum is off by {off:e}"
            );
        }
        let off = (model.momentum(&state) - start).norm();
        assert!(off < 1e-12, "momentum is off by {off:e}");
    }
}

#[test]
fn angular_momentum_drifts_by_half_with_half_the_step() {
    let drift = |steps: usize| {
        let (model, mut state) = strip();
        let before = angular(&model, &state);
        run(&model, &mut state, 0.2 / steps as f64, steps);
        (angular(&model, &state) - before).norm()
    };
    let [some, half, fourth] = [800, 1600, 3200].map(drift);
    for ratio in [some / half, half / fourth] {
        assert!((ratio - 2.0).abs() < 0.2, "ratio {ratio}");
    }
}

#[test]
fn half_the_step_is_half_the_error() {
    let end = |steps: usize| {
        let (mut model, mut state) = strip();
        model.mass[0] = 0.0;
        model.gravity = gravity();
        model.damping = 0.3;
        run(&model, &mut state, 0.2 / steps as f64, steps);
        state.x
    };
    let ends = [800, 1600, 3200, 6400].map(end);
    let apart = |a: &[Vector3<f64>], b: &[Vector3<f64>]| -> f64 {
        a.iter()
            .zip(b)
            .map(|(a, b)| (a - b).norm_squared())
            .sum::<f64>()
            .sqrt()
    };
    let errors: Vec<f64> = ends
        .windows(2)
        .map(|pair| apart(&pair[0], &pair[1]))
        .collect();
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 1.0).abs() < 0.1, "order {order}");
    }
}

#[test]
fn names_order_and_mirrors_change_nothing() {
    let (model, state) = strip();
    let mut plain = state.clone();
    run(&model, &mut plain, 0.01, 50);
    let name = |v: usize| (5 * v + 2) % 6;
    let flip = |p: Vector3<f64>| Vector3::new(p.x, p.y, -p.z);
    let mut other = model.clone();
    let mut mirrored = state.clone();
    for v in 0..6 {
        other.mass[name(v)] = model.mass[v];
        mirrored.x[name(v)] = flip(state.x[v]);
        mirrored.v[name(v)] = flip(state.v[v]);
    }
    other.stretch.vertices = model.stretch.vertices.iter().map(|v| v.map(name)).collect();
    other.stretch.vertices.reverse();
    other.stretch.rest.reverse();
    // A mirror turns angles over; the other order of the ends turns them back.
    let turned = |&[a, b, c, d]: &[usize; 4]| [b, a, c, d].map(name);
    other.bending.vertices = model.bending.vertices.iter().map(turned).collect();
    run(&other, &mut mirrored, 0.01, 50);
    for v in 0..6 {
        let off = (flip(mirrored.x[name(v)]) - plain.x[v]).norm();
        assert!(off < 1e-10, "vertex {v} is off by {off:e} m");
    }
}

#[test]
fn rest_does_not_depend_on_the_time_step() {
    let hang = |h: f64, steps: usize| {
        let (mut model, mut state) = strip();
        model.mass[0] = 0.0;
        model.mass[1] = 0.0;
        model.gravity = gravity();
        state.v.fill(Vector3::zeros());
        run(&model, &mut state, h, steps);
        (model, state)
    };
    let (model, rest) = hang(0.5, 300);
    let (_, other) = hang(0.1, 1000);
    for (a, b) in rest.x.iter().zip(&other.x) {
        let off = (a - b).norm();
        assert!(off < 1e-8, "off by {off:e} m between time steps");
    }
    for h in [1.0 / 60.0, 1.0 / 600.0, 1.0 / 6000.0] {
        let mut state = State::at(rest.x.clone());
        run(&model, &mut state, h, 20);
        for (a, b) in rest.x.iter().zip(&state.x) {
            let off = (a - b).norm();
            assert!(off < 1e-8, "it left its rest by {off:e} m at {h} s");
        }
    }
}

#[test]
fn a_plane_carries_the_weight_and_nothing_sinks() {
    let (mut model, mut state) = strip();
    model.gravity = gravity();
    model.plane = Some(Plane {
        normal: Vector3::y(),
        offset: -0.5,
    });
    state.v.fill(Vector3::zeros());
    let mut stepper = Stepper::new(&model).unwrap();
    let mut report = StepReport::default();
    for step in 0..400 {
        report = stepper.step(&mut state, 0.1, &[]).unwrap();
        for (v, x) in state.x.iter().enumerate() {
            let push = report.plane[v];
            assert!(x.y > -0.5 - 1e-10, "sunk to {} m in step {step}", x.y);
            assert!(push >= 0.0, "the plane pulls with {push} N");
            assert!(push * (x.y + 0.5) < 1e-8, "{push} N at {} m", x.y);
        }
    }
    let weight = G * model.mass.iter().sum::<f64>();
    let carried: f64 = report.plane.iter().sum();
    assert!(
        (carried / weight - 1.0).abs() < 1e-6,
        "{carried} N of {weight} N"
    );
}
