//! Solver results with a closed form, as tests for any backend.
//!
//! The closed forms hold for the exact solution of a substep. Each test therefore uses enough
//! iterations to converge, up to the precision of 32-bit storage.
#![allow(
    clippy::cast_possible_truncation,
    reason = "small whole numbers, and positions as they are stored"
)]

mod invariance;

use incise_mesh::{Surface, Vec3, VertexId};
use incise_pbd_gpu::{Material, Solver, SolverParams, Stiffness};
pub use invariance::spun;
use std::f64::consts::{FRAC_PI_2, TAU};

const G: f64 = 9.81;

/// Steps a body: arguments are frame duration \[s\], parameters and number of frames.
pub type Advance<'a> = &'a mut dyn FnMut(&mut Surface, &mut Solver, f32, &SolverParams, u32);

/// A test that steps bodies with the given function and panics if it fails.
pub type Case = fn(Advance<'_>);

/// All tests of this module with their names.
pub const CASES: [(&str, Case); 10] = [
    ("free_fall", free_fall),
    ("a_spring_in_backward_euler", spring),
    ("the_period_of_a_pendulum", pendulum),
    ("the_damping_of_a_spinning_triangle", spin),
    ("the_tensions_of_a_hanging_chain", chain),
    ("the_discrete_catenary", catenary),
    ("angular_momentum_drifts_in_first_order", invariance::drift),
    ("rotation_and_translation_invariance", invariance::turned),
    (
        "the_rest_state_does_not_depend_on_step_and_iterations",
        invariance::rest,
    ),
    (
        "the_rest_state_does_not_depend_on_numbering",
        invariance::order,
    ),
];

/// Returns parameters of implicit Euler, without gravity and with one substep per frame.
#[must_use]
pub fn still(iterations: u32) -> SolverParams {
    SolverParams {
        iterations,
        substep: None,
        lift: 0.0,
        conserve: false,
        gravity: [0.0; 3],
        ..SolverParams::default()
    }
}

fn falling(iterations: u32) -> SolverParams {
    SolverParams {
        gravity: [0.0, -G as f32, 0.0],
        ..still(iterations)
    }
}

/// Returns a material with stretch constraints only.
#[must_use]
pub fn edges(compliance: f32, damping: f32) -> Material {
    Material {
        stretch: Stiffness::Compliance(compliance),
        bending: None,
        damping,
        ..Material::default()
    }
}

/// Creates a surface and its solver.
///
/// # Panics
/// If the surface is invalid.
#[must_use]
pub fn body(points: &[[f32; 3]], faces: &[[u32; 3]], material: &Material) -> (Surface, Solver) {
    let mut surface = Surface::from_triangles(points, faces).expect("a surface");
    let solver = Solver::new(&mut surface, material).expect("a valid surface");
    (surface, solver)
}

/// Pins vertices.
///
/// # Panics
/// If a vertex does not exist.
pub fn hold(surface: &mut Surface, solver: &mut Solver, vertices: impl IntoIterator<Item = u32>) {
    for v in vertices.into_iter().map(VertexId) {
        solver.pin(surface, v).expect("a vertex");
    }
}

fn weigh(surface: &mut Surface, solver: &mut Solver, mass: f32) {
    for v in surface.topology().vertices().collect::<Vec<_>>() {
        solver.set_mass(surface, v, mass).expect("a vertex");
    }
}

/// Returns vertices and faces of a square sheet of side 1 m with `n` by `n` cells, top row first.
#[must_use]
pub fn sheet(n: u32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for row in 0..=n {
        for column in 0..=n {
            points.push([column as f32 / n as f32, -(row as f32) / n as f32, 0.0]);
        }
    }
    for row in 0..n {
        for column in 0..n {
            let a = row * (n + 1) + column;
            let (b, c, d) = (a + 1, a + n + 1, a + n + 2);
            faces.extend([[a, c, b], [b, c, d]]);
        }
    }
    (points, faces)
}

/// Width of a chain relative to the length of its links; the error is its square.
const WIDTH: f32 = 1e-5;

/// Returns a narrow chain along x with links of `length` \[m\] and two vertices per joint.
fn line(links: u32, length: f32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let points =
        (0..=links).flat_map(|i| [0.0, WIDTH * length].map(|z| [i as f32 * length, 0.0, z]));
    let faces = (0..links).flat_map(|i| {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| 2 * i + k);
        [[a, c, b], [b, c, d]]
    });
    (points.collect(), faces.collect())
}

fn free_fall(advance: Advance<'_>) {
    // Not at a power of two, below which positions round more finely.
    for (place, bound) in [(1.25, 1e-5), (10.0, 1e-4)] {
        let points =
            [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.5, 0.0]].map(|p| p.map(|c| c + place));
        let (mut surface, mut solver) = body(&points, &[[0, 1, 2]], &edges(1e-6, 0.0));
        let (frames, substeps) = (6, 100);
        let params = SolverParams {
            conserve: true,
            ..falling(1).with_substeps(1.0 / 60.0, substeps)
        };
        advance(&mut surface, &mut solver, 1.0 / 60.0, &params, frames);
        let n = f64::from(frames * substeps);
        let h = f64::from(1.0_f32 / 60.0) / f64::from(substeps);
        let way = G * h * h * n * (n + 1.0) / 2.0;
        // The center of three equal masses; rounding turns the triangle a little.
        let fallen = (0..3).zip(points).map(|(v, start)| {
            let end = surface.position(VertexId(v)).y;
            (f64::from(start[1]) - end) / 3.0
        });
        let off = (fallen.sum::<f64>() / way - 1.0).abs();
        assert!(off < bound, "{off} off at {place} m");
    }
}

fn spring(advance: Advance<'_>) {
    let (compliance, mass, h) = (1e-3_f32, 0.5_f32, 0.01_f32);
    // Two springs side by side to a vertex a meter away.
    let points = [[0.0, 0.0, 0.0], [0.0, 0.0, WIDTH], [1.0, 0.0, WIDTH / 2.0]];
    let (mut surface, mut solver) = body(&points, &[[0, 1, 2]], &edges(compliance, 0.0));
    hold(&mut surface, &mut solver, [0, 1]);
    let end = VertexId(2);
    solver.set_mass(&mut surface, end, mass).expect("a vertex");
    surface.positions_mut()[2][0] = 1.1;
    let stiff = 1.0 + f64::from(h).powi(2) * 2.0 / f64::from(compliance * mass);
    let (mut before, mut expected) = (f64::from(1.1_f32) - 1.0, f64::from(1.1_f32) - 1.0);
    for step in 0..100 {
        advance(&mut surface, &mut solver, h, &still(20), 1);
        (before, expected) = (expected, (2.0 * expected - before) / stiff);
        let found = surface.position(end).x - 1.0;
        assert!(
            (found - expected).abs() < 1e-5,
            "{found}, not {expected}, in step {step}"
        );
    }
}

/// When a pendulum of a meter that was let go level passes its lowest point \[s\].
fn quarter(advance: Advance<'_>, h: f64) -> f64 {
    let points = [[0.0, 0.0, -0.5], [0.0, 0.0, 0.5], [1.0, 0.0, 0.0]];
    let (mut surface, mut solver) = body(&points, &[[0, 1, 2]], &edges(0.0, 0.0));
    hold(&mut surface, &mut solver, [0, 1]);
    let mut last = 1.0;
    let time = (0..10_000).find_map(|step| {
        advance(&mut surface, &mut solver, h as f32, &falling(20), 1);
        let x = surface.position(VertexId(2)).x;
        let before = std::mem::replace(&mut last, x);
        (x <= 0.0).then(|| h * (f64::from(step) + before / (before - x)))
    });
    time.expect("the pendulum falls within 10,000 steps")
}

fn pendulum(advance: Advance<'_>) {
    // The arithmetic-geometric mean of 1 and the cosine of half of a right angle.
    let (mut a, mut b) = (1.0_f64, std::f64::consts::FRAC_1_SQRT_2);
    for _ in 0..6 {
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
    }
    let exact = FRAC_PI_2 / (G.sqrt() * a);
    let off = [1.0 / 240.0, 1.0 / 480.0].map(|h| quarter(advance, h) - exact);
    let order = (off[0] / off[1]).log2();
    assert!(
        (order - 1.0).abs() < 0.1,
        "order {order}, {off:?} s off of {exact}"
    );
}

fn spin(advance: Advance<'_>) {
    let corner = |k: u32| {
        let turn = TAU * f64::from(k) / 3.0;
        [turn.cos() as f32, turn.sin() as f32, 0.0]
    };
    let points = [0, 1, 2].map(corner);
    let (mut surface, mut solver) = body(&points, &[[0, 1, 2]], &edges(0.0, 0.0));
    let (h, speed, steps) = (0.01, 5.0, 100);
    for (v, [x, y, _]) in (0..3).zip(points) {
        let velocity = [-speed * y, speed * x, 0.0];
        solver
            .set_velocity(VertexId(v), velocity)
            .expect("a vertex");
    }
    advance(&mut surface, &mut solver, h, &still(100), steps);
    let mut phi = (f64::from(h * speed)).atan();
    let mut turn = phi;
    for _ in 1..steps {
        phi = (phi.sin() / (2.0 - phi.cos())).atan();
        turn += phi;
    }
    let p = surface.position(VertexId(0));
    let off = (p.y.atan2(p.x) - turn).rem_euclid(TAU);
    let off = off.min(TAU - off);
    let conserved = f64::from(h * speed) * f64::from(steps);
    assert!(
        (conserved - turn) > 0.5,
        "it slows by {} of {conserved} rad",
        conserved - turn
    );
    assert!(off < 1e-3 * turn, "{off} of {turn} rad");
}

/// A ladder with a diagonal a bay is a truss that equilibrium determines: its stringers carry all
/// of the weight below, its rungs and diagonals nothing.
fn chain(advance: Advance<'_>) {
    // So stiff that its shear does not shift the weight aside.
    let (links, length, mass, compliance) = (10, 0.1_f32, 0.05_f32, 1e-5_f32);
    let (mut points, faces) = line(links, length);
    for (i, p) in points.iter_mut().enumerate() {
        *p = [if i % 2 == 0 { 0.0 } else { length }, -p[0], 0.0];
    }
    let (mut surface, mut solver) = body(&points, &faces, &edges(compliance, 20.0));
    weigh(&mut surface, &mut solver, mass);
    hold(&mut surface, &mut solver, [0, 1]);
    advance(
        &mut surface,
        &mut solver,
        1.0 / 60.0,
        &falling(20).with_substeps(1.0 / 60.0, 16),
        240,
    );
    for upper in 0..2 * links {
        let [p, q] = [upper, upper + 2].map(|v| surface.position(VertexId(v)));
        let found = (p - q).norm() - f64::from(length);
        let tension = G * f64::from(mass) * f64::from(links - upper / 2);
        let extension = tension * f64::from(compliance);
        let off = (found - extension).abs();
        // Lengths are differences of positions of up to a meter, which are stored so finely.
        let stored = f64::from(f32::EPSILON);
        assert!(
            off < 1e-2 * extension + stored,
            "{found}, not {extension} m, below vertex {upper}"
        );
    }
}

fn catenary(advance: Advance<'_>) {
    let (links, length) = (12, 0.1_f32);
    let (mut points, faces) = line(links, length);
    // It starts as two straight halves, its ends at four fifths of its length.
    let (x, y) = (0.8_f32, 0.6_f32);
    let half = links as f32 * length / 2.0;
    let rest = points.clone();
    for p in &mut points {
        let down = if p[0] < half { p[0] } else { 2.0 * half - p[0] };
        *p = [x * p[0], -y * down, p[2]];
    }
    let (mut surface, mut solver) = body(&rest, &faces, &edges(0.0, 20.0));
    for (position, p) in surface.positions_mut().iter_mut().zip(&points) {
        position[..3].copy_from_slice(p);
    }
    weigh(&mut surface, &mut solver, 0.1);
    hold(&mut surface, &mut solver, [0, 1, 2 * links, 2 * links + 1]);
    advance(
        &mut surface,
        &mut solver,
        1.0 / 60.0,
        &falling(40).with_substeps(1.0 / 60.0, 16),
        240,
    );
    let joint =
        |i: u32| (surface.position(VertexId(2 * i)) + surface.position(VertexId(2 * i + 1))) / 2.0;
    // The slopes of equal links with equal weights between them grow by the same from one to the
    // next.
    let slopes =
        |rise: f64| (0..links).map(move |i| rise * (f64::from(i) - f64::from(links - 1) / 2.0));
    let span = |rise: f64| {
        let across = slopes(rise).map(|slope| f64::from(length) / (1.0 + slope * slope).sqrt());
        across.sum::<f64>()
    };
    let (mut low, mut high) = (0.0, 10.0);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if span(middle) > f64::from(x * length) * f64::from(links) {
            low = middle;
        } else {
            high = middle;
        }
    }
    let mut expected = joint(0);
    for (i, slope) in (0..links).zip(slopes(low)) {
        let across = f64::from(length) / (1.0 + slope * slope).sqrt();
        expected += Vec3::new(across, slope * across, 0.0);
        let off = (joint(i + 1) - expected).norm();
        assert!(
            off < 1e-4 * f64::from(length) * f64::from(links),
            "joint {} is {off} m off",
            i + 1
        );
    }
}
