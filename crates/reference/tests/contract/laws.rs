//! The reference against closed forms: continuous motions, and exact recurrences of its steps.

use crate::common::{G, gravity, run};
use incise_reference::{Constraints, Model, State, Stepper};
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Vertices in a row with an edge from each to the next; all of 1 kg but the `held`.
fn row(vertices: usize, rest: f64, compliance: f64, held: &[usize]) -> Model {
    let mut mass = vec![1.0; vertices];
    held.iter().for_each(|&v| mass[v] = 0.0);
    Model {
        mass,
        stretch: Constraints {
            vertices: (1..vertices).map(|v| [v - 1, v]).collect(),
            rest: vec![rest; vertices - 1],
            compliance,
        },
        ..Model::default()
    }
}

#[test]
fn a_spring_follows_the_recurrence_of_backward_euler() {
    for (compliance, mass, h) in [(1e-3, 2.0, 0.01), (1e-6, 0.5, 0.01), (10.0, 1.0, 0.1)] {
        let mut model = row(2, 1.0, compliance, &[0]);
        model.mass[1] = mass;
        let mut state = State::at(vec![Vector3::zeros(), Vector3::x() * 1.25]);
        let stiff = 1.0 + h * h / (compliance * mass);
        let mut stepper = Stepper::new(&model).unwrap();
        let (mut before, mut now) = (0.25, 0.25);
        for step in 0..300 {
            stepper.step(&mut state, h, &[]).unwrap();
            (before, now) = (now, (2.0 * now - before) / stiff);
            let off = (state.x[1].x - 1.0 - now).abs();
            assert!(
                off < 1e-12,
                "off by {off:e} m in step {step} at {compliance} m/N"
            );
        }
        // The recurrence solved: it turns by atan(h w) a step and decays by the cosine of that.
        let turn = (stiff - 1.0).sqrt().atan();
        let expected = 0.25 * stiff.powf(-150.0) * (300.0 * turn).cos();
        assert!((now - expected).abs() < 1e-12, "{now} m, not {expected} m");
    }
}

#[test]
fn free_fall_is_that_of_its_steps_anywhere() {
    for place in [1.0, 10.0, 1000.0] {
        for per_second in [1200.0, 6000.0] {
            let mut model = row(3, 1.0, 1e-3, &[]);
            model.gravity = gravity();
            let start = Vector3::from_element(place);
            let (h, n, v0) = (1.0 / per_second, 600_i32, 0.3);
            let x: Vec<_> = (0..3)
                .map(|i| start + Vector3::x() * f64::from(i))
                .collect();
            let mut state = State::at(x);
            state.v.fill(Vector3::y() * v0);
            let report = run(&model, &mut state, h, 600);
            let n = f64::from(n);
            let expected = n * h * v0 - G * h * h * n * (n + 1.0) / 2.0;
            let off = (state.x[1].y - place - expected).abs() / expected.abs();
            assert!(off < 1e-6, "{off:e} at {place} m and {per_second} Hz");
            let pull = report
                .stretch
                .iter()
                .fold(0.0, |far: f64, l| far.max(l.abs()));
            assert!(pull < 1e-9 * place, "{pull:e} N in what falls freely");
        }
    }
}

/// When a pendulum of 1 m, let go at 1 rad, first hangs down \[s\].
fn quarter(h: f64) -> f64 {
    let mut model = row(2, 1.0, 0.0, &[0]);
    model.gravity = gravity();
    let angle = 1.0_f64;
    let mut state = State::at(vec![
        Vector3::zeros(),
        Vector3::new(angle.sin(), -angle.cos(), 0.0),
    ]);
    let mut stepper = Stepper::new(&model).unwrap();
    let mut time = 0.0;
    loop {
        let before = state.x[1].x;
        stepper.step(&mut state, h, &[]).unwrap();
        let off = (state.x[1].norm() - 1.0).abs();
        assert!(off < 1e-12, "a rigid rod is off by {off:e} m");
        if state.x[1].x <= 0.0 {
            return time + h * before / (before - state.x[1].x);
        }
        time += h;
    }
}

#[test]
fn a_pendulum_has_its_period_in_the_first_order() {
    let (mut a, mut b) = (1.0_f64, 0.5_f64.cos());
    for _ in 0..6 {
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
    }
    let expected = PI / 2.0 / G.sqrt() / a;
    let times = [400.0, 800.0, 1600.0].map(|n| quarter(expected / n));
    let errors = times.map(|t| t - expected);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 1.0).abs() < 0.1, "order {order}");
    }
    let limit = 2.0 * times[2] - times[1];
    assert!(
        (limit / expected - 1.0).abs() < 1e-5,
        "{limit} s, not {expected} s"
    );
}

#[test]
fn a_spinning_dumbbell_slows_as_its_recursion_says() {
    let model = row(2, 1.0, 0.0, &[]);
    let (h, spin) = (0.01_f64, 20.0_f64);
    let mut state = State::at(vec![Vector3::x() * -0.5, Vector3::x() * 0.5]);
    state.v = vec![Vector3::y() * (-0.5 * spin), Vector3::y() * (0.5 * spin)];
    let mut stepper = Stepper::new(&model).unwrap();
    let (mut turned, mut turn) = (0.0_f64, (h * spin).atan());
    for step in 0..100 {
        stepper.step(&mut state, h, &[]).unwrap();
        turned += turn;
        turn = (turn.sin() / (2.0 - turn.cos())).atan();
        let way = state.x[1] - state.x[0];
        let expected = Vector3::new(turned.cos(), turned.sin(), 0.0);
        let off = (way - expected).norm();
        assert!(off < 1e-12, "off by {off:e} m in step {step}");
    }
    let (rate, time) = (turn / h, 100.0 * h);
    let expected = (spin.powi(-2) + 2.0 * h * time).powf(-0.5);
    assert!(
        (rate / expected - 1.0).abs() < 0.02,
        "{rate} rad/s, not {expected}"
    );
}

#[test]
fn a_hanging_chain_has_its_tensions() {
    for compliance in [0.0, 1e-8, 1e-3] {
        let mut model = row(11, 0.1, compliance, &[0]);
        model.gravity = gravity();
        model.damping = 1.0;
        for (i, mass) in model.mass.iter_mut().enumerate().skip(1) {
            *mass = 0.1 * i as f64;
        }
        let way = Vector3::new(0.6, -0.8, 0.0) * 0.1;
        let mut state = State::at((0..11).map(|i| way * f64::from(i)).collect());
        let report = run(&model, &mut state, 0.5, 120);
        for link in 0..10 {
            let below: f64 = model.mass[link + 1..].iter().sum();
            let tension = G * below;
            let found = -report.stretch[link];
            assert!(
                (found / tension - 1.0).abs() < 1e-9,
                "{found} N, not {tension} N"
            );
            let longer = (state.x[link + 1] - state.x[link]).norm() - 0.1;
            let off = (longer - compliance * tension).abs();
            assert!(off < 1e-12, "an extension is off by {off:e} m");
        }
    }
}

#[test]
fn a_chain_between_two_nails_is_the_discrete_catenary() {
    let n = 16;
    let mut model = row(n + 1, 0.1, 0.0, &[0, n]);
    model.gravity = gravity();
    // Half as far apart as the chain is long, which starts as a zigzag.
    let place = |i: usize| {
        let down = if i.is_multiple_of(2) { 0.0 } else { -0.087 };
        Vector3::new(0.05 * i as f64, down, 0.0)
    };
    let mut state = State::at((0..=n).map(place).collect());
    let report = run(&model, &mut state, 0.5, 200);
    let way = |i: usize| state.x[i + 1] - state.x[i];
    let pull = -report.stretch[0] * way(0).x / way(0).norm();
    for i in 0..n {
        let middle = (n as f64 - 1.0) / 2.0;
        let expected = (i as f64 - middle) * G / pull;
        let slope = way(i).y / way(i).x;
        assert!(
            (slope - expected).abs() < 1e-9,
            "link {i}: {slope}, not {expected}"
        );
    }
    // And far finer it would be the catenary: L = 2 c sinh(a / c), c the pull over weight per
    // length.
    let c = pull / (G * 10.0);
    let length = 2.0 * c * (0.4 / c).sinh();
    assert!((length - 1.6).abs() < 0.01, "{length} m");
}

#[test]
fn energy_of_springs_in_tension_never_grows() {
    let mut model = row(3, 0.5, 1e-3, &[0, 2]);
    model.mass[1] = 1.0;
    let x = [0.0, 1.1, 2.0].map(|x| Vector3::new(x, 0.0, 0.0));
    let mut state = State::at(x.to_vec());
    state.v[1] = Vector3::new(0.0, 2.0, 1.0);
    let energy = |state: &State| {
        let stretched = model
            .stretch
            .vertices
            .iter()
            .map(|&[a, b]| ((state.x[b] - state.x[a]).norm() - 0.5).powi(2) / (2.0 * 1e-3));
        stretched.sum::<f64>() + state.v[1].norm_squared() / 2.0
    };
    let start = energy(&state);
    let mut last = start;
    let mut stepper = Stepper::new(&model).unwrap();
    for step in 0..1000 {
        stepper.step(&mut state, 0.01, &[]).unwrap();
        let now = energy(&state);
        assert!(
            now <= last + 1e-12 * start,
            "{now} J after {last} J in step {step}"
        );
        last = now;
    }
}

#[test]
fn what_is_held_goes_where_it_is_told() {
    let mut model = row(2, 1.0, 1e-2, &[0]);
    model.mass[1] = 2.0;
    let mut state = State::at(vec![Vector3::zeros(), Vector3::x()]);
    let mut stepper = Stepper::new(&model).unwrap();
    let (h, to) = (0.1, Vector3::x() * -0.5);
    stepper.step(&mut state, h, &[(0, to)]).unwrap();
    assert_eq!(state.x[0], to, "it is there");
    // m x / h^2 = pull = (length - 1) / compliance, about where it was.
    let ratio = h * h / (1e-2 * 2.0);
    let expected = 1.0 - 0.5 * ratio / (1.0 + ratio);
    assert!(
        (state.x[1].x - expected).abs() < 1e-12,
        "{} m",
        state.x[1].x
    );
    let refused = stepper.step(&mut state, h, &[(1, to)]);
    assert!(refused.is_err(), "what has mass cannot be put anywhere");
}
