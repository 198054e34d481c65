//! Single substeps with a closed form, as tests for any backend.
//!
//! They cover one projection, and the change of angular momentum and energy in a converged substep
//! of springs.
#![allow(
    clippy::cast_possible_truncation,
    reason = "positions as they are stored"
)]

use super::closed_forms::{Advance, Case, body, edges, hold, sheet, spun, still};
use incise_mesh::{Surface, Vec3, VertexId};
use incise_pbd_gpu::{Solver, SolverParams};

/// All tests of this module with their names.
pub const CASES: [(&str, Case); 3] = [
    ("one_projection_equals_the_formula", projection),
    ("the_change_of_angular_momentum_in_a_step", angular_momentum),
    ("the_energy_of_springs_in_tension_never_grows", energy),
];

/// Returns the length error of an edge of rest length 1 after a step, and the motion of its start.
fn projected(advance: Advance<'_>, held: bool, iterations: u32, diagonal_scale: f32) -> [f64; 2] {
    // The third vertex is so far away that its edges have no effect along x.
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.0, 1000.0]];
    let (mut surface, mut solver) = body(&points, &[[0, 1, 2]], &edges(ALPHA, 0.0));
    for (v, mass) in [(0, MASSES[0]), (1, MASSES[1])] {
        solver
            .set_mass(&mut surface, VertexId(v), mass)
            .expect("a vertex");
    }
    hold(&mut surface, &mut solver, [2]);
    if held {
        hold(&mut surface, &mut solver, [0]);
    }
    surface.positions_mut()[1][0] = 1.0 + OFF;
    let params = SolverParams {
        diagonal_scale,
        ..still(iterations)
    };
    advance(&mut surface, &mut solver, H, &params, 1);
    let [a, b] = [0, 1].map(|v| surface.position(VertexId(v)).x);
    [b - a - 1.0, a]
}

/// Compliance [m/N], time step \[s\], masses \[kg\] and how far the edge is drawn out \[m\].
const ALPHA: f32 = 1e-3;
const H: f32 = 0.01;
const MASSES: [f32; 2] = [2.0, 0.5];
const OFF: f32 = 0.1;

fn projection(advance: Advance<'_>) {
    // Four units in the last place of positions of a meter.
    let bound = 4.0 * f64::from(f32::EPSILON);
    let alpha = f64::from(ALPHA) / f64::from(H).powi(2);
    let off = f64::from(1.0 + OFF) - 1.0;
    for held in [true, false] {
        let [first, second] = MASSES.map(|m| 1.0 / f64::from(m));
        let first = if held { 0.0 } else { first };
        let weight = first + second;
        for diagonal_scale in [1.0, 0.5] {
            let part = weight / (alpha + f64::from(diagonal_scale) * weight).max(weight);
            // An iteration projects twice. The multiplier is the sum of both steps over the weight.
            let once = off * part;
            let twice = once + part * ((off - once) - alpha * once / weight);
            let (left, moved) = (off - twice, twice * first / weight);
            let found = projected(advance, held, 1, diagonal_scale);
            for (found, expected) in found.into_iter().zip([left, moved]) {
                let apart = (found - expected).abs();
                assert!(
                    apart <= bound,
                    "{found}, not {expected}, at diagonal scale {diagonal_scale}"
                );
            }
        }
        let [one, two] = [1, 2].map(|iterations| projected(advance, held, iterations, 1.0));
        for (one, two) in one.into_iter().zip(two) {
            assert!((one - two).abs() <= bound, "{one} became {two}");
        }
        // With a smaller diagonal scale many iterations have the same limit.
        let many = projected(advance, held, 60, 0.5);
        for (one, many) in one.into_iter().zip(many) {
            assert!((one - many).abs() <= bound, "{one}, and at last {many}");
        }
    }
}

/// Returns the force of springs of a compliance on every vertex \[N\].
fn spring_forces(surface: &Surface, solver: &Solver, compliance: f64) -> Vec<Vec3> {
    let mut forces = vec![Vec3::zeros(); surface.positions().len()];
    for (ends, rest) in springs(solver) {
        let [a, b] = ends.map(|v| surface.position(v));
        let along = b - a;
        let pull = along * ((along.norm() - rest) / compliance / along.norm());
        forces[ends[0].index()] += pull;
        forces[ends[1].index()] -= pull;
    }
    forces
}

/// All edges with their rest lengths \[m\].
fn springs(solver: &Solver) -> impl Iterator<Item = ([VertexId; 2], f64)> {
    let set = solver.stretch();
    let batches = set.batches().iter().chain([set.overflow()]);
    batches.flat_map(|batch| {
        let rests = batch.rest().iter().map(|&rest| f64::from(rest));
        batch.vertices().iter().copied().zip(rests)
    })
}

/// Angular momentum changes by `L' - L = -h^2 sum of v' x F'` in implicit Euler.
fn angular_momentum(advance: Advance<'_>) {
    let h = 0.01_f32;
    for stretch in [1.2, 0.8] {
        let (mut surface, mut solver, center) = spun(stretch);
        let about = center.into();
        for step in 0..10 {
            let before = solver.angular_momentum(&surface, about)[2];
            advance(&mut surface, &mut solver, h, &still(60), 1);
            let change = solver.angular_momentum(&surface, about)[2] - before;
            let forces = spring_forces(&surface, &solver, 1.0);
            let turned = surface.topology().vertices().map(|v| {
                let velocity = Vec3::from(solver.velocity(v).map(f64::from));
                velocity.cross(&forces[v.index()]).z
            });
            let expected = -f64::from(h).powi(2) * turned.sum::<f64>();
            // Directions turn a little while a substep is solved; the rest is storage.
            let bound = 1e-2 * expected.abs() + 1e-6 * before.abs();
            assert!(
                (change - expected).abs() < bound,
                "{change}, not {expected}, of {before} in step {step}, drawn to {stretch}"
            );
            assert!(
                step > 3 || expected.abs() > 1e-5 * before.abs(),
                "nothing to see: {expected} of {before}"
            );
        }
    }
}

/// A net that is drawn out over a frame and swings: its energy is convex, so that no converged
/// substep adds any.
fn energy(advance: Advance<'_>) {
    const N: u32 = 4;
    let compliance = 0.1_f32;
    let (points, faces) = sheet(N);
    let (mut surface, mut solver) = body(&points, &faces, &edges(compliance, 0.0));
    for p in surface.positions_mut() {
        (p[0], p[1]) = (1.5 * p[0], 1.5 * p[1]);
    }
    let is_rim = |v: u32| [v / (N + 1), v % (N + 1)].iter().any(|&k| k == 0 || k == N);
    let rim = (0..(N + 1) * (N + 1)).filter(|&v| is_rim(v));
    hold(&mut surface, &mut solver, rim.clone());
    for v in (0..(N + 1) * (N + 1)).filter(|&v| !is_rim(v)) {
        let wild = [0.3, 0.5, 0.7].map(|c: f64| (c * f64::from(v) * 10.0).sin() as f32);
        solver.set_velocity(VertexId(v), wild).expect("a vertex");
    }
    let of = |surface: &Surface, solver: &Solver| {
        let stored = springs(solver).map(|([a, b], rest)| {
            let length = (surface.position(b) - surface.position(a)).norm();
            assert!(length > rest, "{length} m is not in tension");
            (length - rest).powi(2) / (2.0 * f64::from(compliance))
        });
        solver.kinetic_energy() + stored.sum::<f64>()
    };
    let first = of(&surface, &solver);
    let mut last = first;
    for step in 0..100 {
        advance(&mut surface, &mut solver, 0.01, &still(100), 1);
        let now = of(&surface, &solver);
        assert!(
            now <= last + 1e-6 * first,
            "{now} J after {last} J of {first} J in step {step}"
        );
        last = now;
    }
    assert!(last < 0.999 * first, "{last} J of {first} J: it swings");
}
