//! Bodies that start crushed, folded or pushed through, and meshes of slivers, fans and open seams.

use super::runner::{Body, Case, Runner, ball};
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, VertexId};
use incise_models::scenes::FRAME;
use incise_models::{double_cone, place, pose, sheet};
use incise_pbd_gpu::{Material, Solver, Stiffness};
use incise_test_support::energy::{Limits, MAX_STRAIN, hinge_angle, wrapped};
use incise_test_support::materials::{elastic_shell, shells};
use incise_test_support::params::{TEN_ITERATIONS, WEIGHTLESS};
use incise_test_support::random::Random;
use std::f64::consts::PI;

pub(super) const CASES: [Case; 8] = [
    ("crushed_shells_gain_no_energy", crushed_gain_nothing),
    ("crushed_shells_regain_their_lengths", crushed_recover),
    ("a_vertex_pushed_through_a_ball_comes_back", pushed_through),
    ("folded_hinges_unfold", folded),
    ("slivers_gain_no_energy", slivers),
    ("vertices_of_any_valence_gain_no_energy", fans),
    ("constraints_without_a_color_gain_no_energy", uncolored),
    ("open_seams_and_free_vertices_gain_no_energy", seams),
];

/// Center of the balls.
const CENTER: Vec3 = Vec3::new(0.0, 0.6, 0.0);
/// Ways to crush a ball.
const CRUSHED: [&str; 5] = ["point", "line", "plane", "random", "inside out"];
/// Limits of bodies that are dropped.
const THROWN: Limits = Limits::above(0.0).within(15.0);

fn crushed(shape: &str, subdivisions: u32) -> Surface {
    let mut surface = ball(subdivisions, CENTER.y);
    let mut random = Random::new(5);
    for i in 0..surface.positions().len() {
        let p = surface.position(VertexId::from_index(i));
        let offset = Vec3::from_fn(|_, _| random.signed()) * 0.5;
        let to = match shape {
            "point" => CENTER,
            "line" => Vec3::new(p.x, CENTER.y, 0.0),
            "plane" => Vec3::new(p.x, CENTER.y, p.z),
            "random" => CENTER + offset,
            _ => CENTER * 2.0 - p,
        };
        let [x, y, z] = to_f32(to);
        surface.positions_mut()[i] = [x, y, z, surface.positions()[i][3]];
    }
    surface
}

fn crushed_gain_nothing(runner: &mut Runner<'_>) {
    let frames = runner.pick(60, 600);
    for shape in CRUSHED {
        for stretch in [1e-3, 1e-5, 1e-7] {
            let material = elastic_shell(stretch, 1e3 * stretch);
            let mut body = Body::on_ground(crushed(shape, 2), &material);
            let context = format!("{shape}, {stretch:e} m/N");
            let limits = Limits::above(0.0);
            runner.watch(&mut body, FRAME, &TEN_ITERATIONS, frames, limits, &context);
        }
    }
}

fn assert_recovered(body: &Body, context: &str) {
    let strain = body.strain();
    assert!(strain <= MAX_STRAIN, "{context}: mean strain {strain}");
}

fn crushed_recover(runner: &mut Runner<'_>) {
    let subdivisions = runner.pick(1, 2);
    // No force points out of a point or a line, and only that of bending out of a plane.
    for shape in &CRUSHED[2..] {
        for bending in [None, Some(0.2), Some(1.0)] {
            if *shape == "plane" && bending.is_none() {
                continue;
            }
            let material = Material {
                bending: bending.map(Stiffness::Pbd),
                ..Material::default()
            };
            let mut body = Body::on_ground(crushed(shape, subdivisions), &material);
            runner.step(&mut body, FRAME, &TEN_ITERATIONS, 600);
            assert_recovered(&body, &format!("{shape}, bending {bending:?}"));
        }
    }
}

fn pushed_through(runner: &mut Runner<'_>) {
    for vertex in (0..42).step_by(runner.pick(21, 3)) {
        let mut surface = ball(1, CENTER.y);
        let old = surface.position(VertexId(vertex));
        let through = CENTER * 2.0 - old;
        pose(&mut surface, |p| if p == old { through } else { p });
        let context = format!("vertex {vertex}");
        // The energy of constraints without compliance is not defined.
        let mut rigid = Body::on_ground(surface.clone(), &Material::default());
        runner.step(&mut rigid, FRAME, &TEN_ITERATIONS, 600);
        assert_recovered(&rigid, &context);
        let mut elastic = Body::on_ground(surface, &elastic_shell(1e-6, 1e-3));
        let limits = Limits::above(0.0);
        runner.watch(&mut elastic, FRAME, &TEN_ITERATIONS, 600, limits, &context);
        assert_recovered(&elastic, &context);
    }
}

/// Tip of the second triangle of a hinge.
fn wing(angle: f64) -> [f32; 3] {
    to_f32(Vec3::new(0.5, -0.9 * angle.cos(), -0.9 * angle.sin()))
}

/// Two triangles with that angle at their edge at rest \[rad\].
fn hinge(rest: f64) -> Surface {
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.5, 0.9, 0.0], wing(rest)];
    Surface::from_triangles(&points, &[[0, 1, 2], [1, 0, 3]]).expect("two triangles")
}

fn folded(runner: &mut Runner<'_>) {
    let vertices = [0, 1, 2, 3].map(VertexId);
    for rest in [0.0, 90.0, 179.9, -179.9_f64].map(f64::to_radians) {
        for start in [0.0, 0.5, PI - 1e-7, PI + 1e-7, PI, -0.5] {
            for stiffness in [Stiffness::Pbd(1.0), Stiffness::Compliance(0.0)] {
                let material = Material {
                    bending: Some(stiffness),
                    ..Material::default()
                };
                let mut surface = hinge(rest);
                let wanted = hinge_angle(&surface, vertices);
                let [x, y, z] = wing(start);
                surface.positions_mut()[3] = [x, y, z, surface.positions()[3][3]];
                let mut body = Body::new(surface, &material);
                runner.step(&mut body, FRAME, &WEIGHTLESS, 120);
                let error = wrapped(hinge_angle(&body.surface, vertices) - wanted).abs();
                assert!(
                    error <= 0.02,
                    "{error} rad off {rest}, from {start}, {stiffness:?}"
                );
            }
        }
    }
}

/// Drops a surface as every shell.
fn drop_all(runner: &mut Runner<'_>, surface: &Surface, limits: Limits, name: &str) {
    let frames = runner.pick(60, 300);
    for (kind, material) in shells() {
        let mut body = Body::on_ground(surface.clone(), &material);
        let context = format!("{name}, {kind}");
        runner.watch(&mut body, FRAME, &TEN_ITERATIONS, frames, limits, &context);
    }
}

fn slivers(runner: &mut Runner<'_>) {
    for exponent in (0..=7).step_by(runner.pick(7, 1)) {
        let mut surface = sheet([8, 1], [1.0, 0.125 * 10.0_f32.powi(-exponent)]);
        place(&mut surface, |p| p + Vec3::new(0.0, 0.3, 0.0));
        drop_all(
            runner,
            &surface,
            THROWN,
            &format!("1e{exponent} times as long as wide"),
        );
    }
}

fn fans(runner: &mut Runner<'_>) {
    for &valence in runner.pick(&[3, 100][..], &[3, 4, 10, 50, 64, 65, 100, 200, 500]) {
        let limits = THROWN.recovering();
        drop_all(
            runner,
            &double_cone(valence),
            limits,
            &format!("valence {valence}"),
        );
    }
}

fn uncolored(runner: &mut Runner<'_>) {
    let mut surface = double_cone(1000);
    let solver = Solver::new(&mut surface, &shells()[0].1).expect("a double cone");
    let bending = solver.bending().expect("the shell bends");
    assert!(
        !solver.stretch().overflow().is_empty() && !bending.overflow().is_empty(),
        "every constraint has a color"
    );
    drop_all(runner, &surface, THROWN.recovering(), "valence 1000");
}

fn seams(runner: &mut Runner<'_>) {
    let whole = ball(1, 0.6);
    let topology = whole.topology();
    let faces: Vec<[u32; 3]> = (topology.triangles())
        .map(|t| topology.triangle(t).map(|v| v.0))
        .collect();
    let mut points = whole.rest_positions().to_vec();
    points.push([7.0; 3]);
    let free = Surface::from_triangles(&points, &faces).expect("a ball");
    drop_all(runner, &free, THROWN.recovering(), "a free vertex");
    // Every triangle has corners of its own.
    let corners: Vec<[f32; 3]> = faces
        .iter()
        .flatten()
        .map(|&v| points[v as usize])
        .collect();
    let own: Vec<[u32; 3]> = (0..80).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let soup = Surface::from_triangles(&corners, &own).expect("triangles apart");
    drop_all(runner, &soup, THROWN.recovering(), "seams apart");
    let line = [
        [0.0, 0.5, 0.0],
        [1.0, 0.5, 0.0],
        [0.5, 0.5, 0.0],
        [0.5, 1.0, 0.0],
    ];
    let flat = Surface::from_triangles(&line, &[[0, 1, 2], [1, 0, 3]]).expect("two triangles");
    drop_all(runner, &flat, THROWN.recovering(), "no area");
}
