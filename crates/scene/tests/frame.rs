//! What a frame does, and what it leaves out.

use incise_cut::CutError;
use incise_mesh::{Aabb, Model, build_model};
use incise_pbd_gpu::Material;
use incise_scene::{BladeId, BodyId, Scene, SceneError, SceneParams};

const LEFT: [[f32; 3]; 2] = [[-2.0, 0.1, -2.0], [-2.0, 0.1, 2.0]];
const RIGHT: [[f32; 3]; 2] = [[2.0, 0.1, -2.0], [2.0, 0.1, 2.0]];

/// A sphere of radius 0.5 in weightless space, and a blade to its left.
fn scene() -> (Scene, BodyId, BladeId) {
    let mut scene = Scene::new(SceneParams::default());
    scene.params.solver.gravity = [0.0; 3];
    let body = scene
        .add_body(build_model(Model::Sphere768), &Material::default())
        .unwrap();
    let blade = scene.add_blade(LEFT);
    (scene, body, blade)
}

#[test]
fn a_blade_at_rest_asks_nothing() {
    let (mut scene, _, blade) = scene();
    let stats = *scene.step().unwrap();
    assert_eq!((stats.sweeps, stats.sweeps_skipped), (0, 1));
    assert_eq!((stats.detections, stats.refits_skipped), (0, 1));
    // Along itself it sweeps nothing either.
    let [start, end] = LEFT;
    scene.move_blade(blade, [[start[0], 0.1, -1.0], [end[0], 0.1, 3.0]]);
    assert_eq!(scene.step().unwrap().sweeps, 0);
}

#[test]
fn a_sweep_that_misses_the_box_asks_no_triangle() {
    let (mut scene, _, blade) = scene();
    scene.step().unwrap();
    scene.move_blade(blade, LEFT.map(|[x, y, z]| [x, y + 1.0, z]));
    let stats = *scene.step().unwrap();
    assert_eq!((stats.sweeps, stats.detections_skipped), (1, 1));
    assert_eq!(
        (stats.detections, stats.refits, stats.candidates),
        (0, 0, 0)
    );
    scene.params.skip_far_sweeps = false;
    scene.move_blade(blade, LEFT);
    let stats = *scene.step().unwrap();
    assert_eq!((stats.detections, stats.refits, stats.cuts), (1, 1, 0));
}

/// A body flies to where a blade moves up and down. Its box is found by looking at its vertices when it
/// may have come close, not in every frame, and no sweep that its box meets is passed over.
#[test]
fn a_box_is_measured_when_what_is_known_of_it_is_not_enough() {
    let (mut scene, id, _) = scene();
    let blade = scene.add_blade([[3.0, -0.2, -2.0], [3.0, -0.2, 2.0]]);
    let (solver, surface) = scene.edit(id).unwrap().solver_mut();
    for v in surface.topology().vertices() {
        // It spins, too: then less is known of where it is.
        let [x, y, ..] = surface.positions[v.index()];
        solver.set_velocity(v, [2.0 - y, x, 0.0]).unwrap();
    }
    let (mut measured, mut met) = (0, 0);
    for frame in 0..90 {
        let y = if frame % 2 == 0 { 0.2 } else { -0.2 };
        let edge = [[3.0, y, -2.0], [3.0, y, 2.0]];
        let sweep = Aabb::around(edge.into_iter().chain(edge.map(|[x, _, z]| [x, -y, z])));
        let meets = scene.body(id).surface().bounds().overlaps(&sweep);
        scene.move_blade(blade, edge);
        let stats = *scene.step().unwrap();
        assert_eq!(stats.detections, u32::from(meets), "frame {frame}");
        measured += stats.boxes;
        met += u32::from(meets);
    }
    assert!(met > 0, "it came to the blade");
    let flight = measured.saturating_sub(met);
    assert!(
        (1..=12).contains(&flight),
        "measured {flight} times on its way"
    );
}

#[test]
fn a_slice_makes_two_pieces_that_go_on() -> Result<(), SceneError> {
    let (mut scene, body, blade) = scene();
    let mass = scene.body(body).solver().total_mass();
    scene.move_blade(blade, RIGHT);
    assert_eq!(scene.step()?.cuts, 1);
    assert_eq!(scene.body(body).pieces(), [0, 1]);
    for _ in 0..30 {
        assert_eq!(scene.step()?.cuts, 0, "the blade has stopped");
    }
    let body = scene.body(body);
    body.solver().validate(body.surface()).unwrap();
    assert!(body.surface().topology().is_closed());
    assert!((body.solver().total_mass() / mass - 1.0).abs() < 1e-5);
    assert!(body.solver().stretch_error(body.surface()) < 1e-3);
    Ok(())
}

#[test]
fn a_sweep_that_ends_inside_is_refused_and_changes_nothing() {
    let (mut scene, body, blade) = scene();
    let before = scene.body(body).surface().clone();
    scene.move_blade(blade, [[0.0, 0.1, -2.0], [0.0, 0.1, 2.0]]);
    let stats = *scene.cut().unwrap();
    assert_eq!((stats.cuts, stats.refused), (0, 1));
    let refusal = scene.refusals()[0];
    assert_eq!(refusal.body, body);
    assert!(matches!(refusal.error, CutError::PartialCut { .. }));
    assert_eq!(scene.body(body).surface(), &before);
    scene.advance().unwrap();
    scene.step().unwrap();
    assert!(scene.refusals().is_empty(), "the next frame begins anew");
}

#[test]
fn a_pose_that_is_not_finite_is_refused() {
    let (mut scene, _, blade) = scene();
    scene.move_blade(blade, [[f32::NAN; 3], [0.0; 3]]);
    assert_eq!(scene.step().unwrap().refused, 1);
    let error = scene.refusals()[0].error;
    assert!(matches!(error, CutError::SweepNotFinite { .. }), "{error}");
}

#[test]
fn a_blade_for_one_piece_passes_through_the_others() {
    let (mut scene, body, blade) = scene();
    scene.move_blade(blade, RIGHT);
    scene.step().unwrap();
    // Upright, through both halves, but only for one.
    scene.jump_blade(blade, [[-2.0, -2.0, 0.05], [-2.0, 2.0, 0.05]]);
    scene.set_blade_piece(blade, Some(1));
    scene.move_blade(blade, [[2.0, -2.0, 0.05], [2.0, 2.0, 0.05]]);
    assert_eq!(scene.step().unwrap().cuts, 1);
    assert_eq!(scene.outcomes()[0].1.delta.pieces_added, [(2, 1)]);
    assert_eq!(scene.body(body).pieces(), [0, 1, 2]);
}
