//! Bodies that keep their volumes: turned inside out, and opened.

use super::motions::squeeze;
use super::runner::{Body, Case, Runner, ball};
use incise_mesh::{Surface, TriangleId, Vec3};
use incise_models::place;
use incise_models::scenes::FRAME;
use incise_pbd_gpu::{Material, Volume};
use incise_test_support::materials::shells;
use incise_test_support::params::{TEN_ITERATIONS, WEIGHTLESS};

pub(super) const CASES: [Case; 2] = [
    ("a_volume_turned_inside_out_throws_nothing", inside_out),
    ("an_opened_piece_has_no_volume", opened),
];

fn with_volume(material: Material, pressure: f32) -> Material {
    Material {
        volume: Some(Volume {
            pressure,
            ..Volume::default()
        }),
        ..material
    }
}

fn inside_out(runner: &mut Runner<'_>) {
    for (name, material) in shells() {
        let mut body = Body::new(ball(2, 1.0), &with_volume(material, 1.0));
        squeeze(runner, &mut body);
        body.put_on_ground();
        let interval = runner.pick(10, 1);
        for _ in 0..600 / interval {
            runner.step(&mut body, FRAME, &TEN_ITERATIONS, interval);
            let surface = &body.surface;
            let middle = surface.bounds().center();
            for v in surface.topology().vertices() {
                let distance = (surface.position(v) - middle).norm();
                assert!(
                    distance <= 3.0 * 0.5,
                    "{name}: {distance} m from the middle"
                );
            }
        }
    }
}

/// One ball, or two side by side as pieces of one surface.
fn balls(count: u32) -> Surface {
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for i in 0..count {
        let mut surface = ball(2, 0.8);
        place(&mut surface, |p| {
            p + Vec3::new(3.0 * f64::from(i), 0.0, 0.0)
        });
        let offset = points.len() as u32;
        let topology = surface.topology();
        let corners = topology.triangles().map(|t| topology.triangle(t));
        faces.extend(corners.map(|corners| corners.map(|v| v.0 + offset)));
        points.extend_from_slice(surface.rest_positions());
    }
    Surface::from_triangles(&points, &faces).expect("balls apart")
}

/// Takes a triangle from the last of the balls under pressure; returns its positions a second
/// later. Unless `is_asked`, volume is turned off before.
fn open(runner: &mut Runner<'_>, material: &Material, count: u32, is_asked: bool) -> Vec<[f32; 4]> {
    let mut body = Body::new(balls(count), material);
    runner.step(&mut body, FRAME, &WEIGHTLESS, 60);
    if !is_asked {
        (body.solver.set_volume(&body.surface, None)).expect("a volume");
    }
    let first = body.surface.positions().len() / count as usize * (count as usize - 1);
    let last = body.surface.topology().triangle_count() as u32 - 1;
    let mut edit = body.surface.edit();
    edit.remove_triangle(TriangleId(last));
    let (delta, _) = edit.finish();
    (body.solver.apply_delta(&mut body.surface, &delta)).expect("it fits");
    runner.step(&mut body, FRAME, &WEIGHTLESS, 1);
    let closed = if is_asked { count - 1 } else { 0 };
    let kept = body.solver.volumes().pieces();
    assert!(
        kept.iter().map(|piece| piece.piece()).eq(0..closed),
        "{} volumes of {closed} closed pieces",
        kept.len()
    );
    if !runner.is_gpu {
        let projections = u64::from(closed * WEIGHTLESS.iterations);
        assert_eq!(
            body.solver.stats().volume_projections,
            projections,
            "open pieces have none"
        );
    }
    runner.step(&mut body, FRAME, &WEIGHTLESS, 60);
    body.surface.positions()[first..].to_vec()
}

fn opened(runner: &mut Runner<'_>) {
    for (name, material) in shells() {
        let material = with_volume(material, 5.0);
        for count in [1, 2] {
            let [with, without] =
                [true, false].map(|is_asked| open(runner, &material, count, is_asked));
            assert!(with == without, "{name}: an open piece is still inflated");
        }
    }
}
