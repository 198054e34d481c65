//! Frames with resting, missing and cutting blades: statistics, cuts and failed cuts.

use incise_cut::CutError;
use incise_mesh::Aabb;
use incise_models::{Model, build_model};
use incise_pbd_gpu::Material;
use incise_scene::{BladeId, BladeMode, BodyId, Scene, SceneError, SceneParams};

const LEFT: [[f32; 3]; 2] = [[-2.0, 0.1, -2.0], [-2.0, 0.1, 2.0]];
const RIGHT: [[f32; 3]; 2] = [[2.0, 0.1, -2.0], [2.0, 0.1, 2.0]];

/// Returns a scene without gravity, a sphere of radius 0.5 m and a blade to its left.
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
fn a_resting_blade_makes_no_query() {
    let (mut scene, _, blade) = scene();
    let stats = *scene.step().unwrap();
    assert_eq!((stats.sweeps, stats.resting_blades), (0, 1));
    assert_eq!(
        (stats.narrow_phase_queries, stats.bvh_refits_skipped),
        (0, 1)
    );
    // A motion along the edge sweeps no area either.
    let [start, end] = LEFT;
    scene
        .move_blade(blade, [[start[0], 0.1, -1.0], [end[0], 0.1, 3.0]])
        .unwrap();
    assert_eq!(scene.step().unwrap().sweeps, 0);
}

#[test]
fn a_sweep_outside_the_bounding_box_tests_no_triangle() {
    let (mut scene, _, blade) = scene();
    scene.step().unwrap();
    scene
        .move_blade(blade, LEFT.map(|[x, y, z]| [x, y + 1.0, z]))
        .unwrap();
    let stats = *scene.step().unwrap();
    assert_eq!((stats.sweeps, stats.broad_phase_rejections), (1, 1));
    assert_eq!(
        (
            stats.narrow_phase_queries,
            stats.bvh_refits,
            stats.candidate_triangles
        ),
        (0, 0, 0)
    );
    scene.params.skip_far_sweeps = false;
    scene.move_blade(blade, LEFT).unwrap();
    let stats = *scene.step().unwrap();
    assert_eq!(
        (stats.narrow_phase_queries, stats.bvh_refits, stats.cuts),
        (1, 0, 0)
    );
}

/// A body flies toward a blade that moves up and down.
///
/// Its bounding box is recomputed only when the last one no longer excludes an overlap.
#[test]
fn bounding_boxes_are_computed_only_when_the_last_one_is_not_sufficient() {
    let (mut scene, id, _) = scene();
    let blade = scene.add_blade([[3.0, -0.2, -2.0], [3.0, -0.2, 2.0]]);
    // The body that flies past it stays whole.
    scene.set_blade_mode(blade, BladeMode::FullSlices).unwrap();
    let (solver, surface) = scene.edit(id).unwrap().solver_mut();
    for v in surface.topology().vertices() {
        // It also spins, so that its box grows faster.
        let [x, y, ..] = surface.positions()[v.index()];
        solver.set_velocity(v, [2.0 - y, x, 0.0]).unwrap();
    }
    let (mut measured, mut met) = (0, 0);
    for frame in 0..90 {
        let y = if frame % 2 == 0 { 0.2 } else { -0.2 };
        let edge = [[3.0, y, -2.0], [3.0, y, 2.0]];
        let sweep = Aabb::around(edge.into_iter().chain(edge.map(|[x, _, z]| [x, -y, z])));
        let meets = scene.body(id).unwrap().surface().bounds().overlaps(&sweep);
        scene.move_blade(blade, edge).unwrap();
        let stats = *scene.step().unwrap();
        assert_eq!(
            stats.narrow_phase_queries,
            u32::from(meets),
            "frame {frame}"
        );
        measured += stats.aabbs_computed;
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
fn a_slice_makes_two_pieces_that_can_be_stepped() -> Result<(), SceneError> {
    let (mut scene, body, blade) = scene();
    let mass = scene.body(body).unwrap().solver().total_mass();
    scene.move_blade(blade, RIGHT).unwrap();
    assert_eq!(scene.step()?.cuts, 1);
    assert_eq!(scene.body(body).unwrap().pieces(), [0, 1]);
    for _ in 0..30 {
        assert_eq!(scene.step()?.cuts, 0, "the blade has stopped");
    }
    let body = scene.body(body).unwrap();
    body.solver().validate(body.surface()).unwrap();
    assert!(body.surface().topology().is_closed());
    assert!((body.solver().total_mass() / mass - 1.0).abs() < 1e-5);
    assert!(body.solver().stretch_error(body.surface()) < 1e-3);
    Ok(())
}

#[test]
fn a_sweep_of_full_slices_that_ends_inside_is_refused_and_changes_nothing() {
    let (mut scene, body, blade) = scene();
    scene.set_blade_mode(blade, BladeMode::FullSlices).unwrap();
    let before = scene.body(body).unwrap().surface().clone();
    scene
        .move_blade(blade, [[0.0, 0.1, -2.0], [0.0, 0.1, 2.0]])
        .unwrap();
    let stats = *scene.cut().unwrap();
    assert_eq!((stats.cuts, stats.failed_cuts), (0, 1));
    let refusal = scene.failed_cuts()[0];
    assert_eq!(refusal.body, body);
    assert!(matches!(refusal.error, CutError::PartialCut { .. }));
    assert_eq!(scene.body(body).unwrap().surface(), &before);
    scene.advance().unwrap();
    scene.step().unwrap();
    assert!(scene.failed_cuts().is_empty(), "the next frame begins anew");
}

#[test]
fn a_pose_that_is_not_finite_is_refused() {
    let (mut scene, _, blade) = scene();
    let pose = [[f32::NAN; 3], [0.0; 3]];
    let error = scene.move_blade(blade, pose).unwrap_err();
    assert!(
        matches!(error, SceneError::BladeNotFinite { .. }),
        "{error}"
    );
    assert_eq!(scene.step().unwrap().sweeps, 0, "the blade has not moved");
    scene.add_blade(pose);
    assert_eq!(scene.step().unwrap().failed_cuts, 1);
    let error = scene.failed_cuts()[0].error;
    assert!(matches!(error, CutError::SweepNotFinite { .. }), "{error}");
}

#[test]
fn a_blade_for_one_piece_passes_through_the_others() {
    let (mut scene, body, blade) = scene();
    scene.move_blade(blade, RIGHT).unwrap();
    scene.step().unwrap();
    // A vertical sweep through both halves that applies to one of them.
    scene
        .teleport_blade(blade, [[-2.0, -2.0, 0.05], [-2.0, 2.0, 0.05]])
        .unwrap();
    scene.set_blade_piece(blade, Some(1)).unwrap();
    scene
        .move_blade(blade, [[2.0, -2.0, 0.05], [2.0, 2.0, 0.05]])
        .unwrap();
    assert_eq!(scene.step().unwrap().cuts, 1);
    let (_, outcome) = scene.cuts()[0].cut.as_ref().unwrap();
    assert_eq!(outcome.delta.pieces_added, [(2, 1)]);
    assert_eq!(scene.body(body).unwrap().pieces(), [0, 1, 2]);
}
