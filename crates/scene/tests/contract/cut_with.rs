//! Cuts of a scene's body by a method of the caller.

use incise_cut::{CutError, CutParams, Sweep};
use incise_mesh::icosphere;
use incise_pbd_gpu::Material;
use incise_scene::{BladeMode, BodyId, Scene, SceneParams};

/// Returns the edge of a blade at x.
fn edge(x: f32) -> [[f32; 3]; 2] {
    [[x, 0.1, -2.0], [x, 0.1, 2.0]]
}

fn scene() -> (Scene, BodyId) {
    let mut scene = Scene::new(SceneParams::default());
    let body = scene.add_body(icosphere(3, 0.5), &Material::soft_body());
    (scene, body.unwrap())
}

#[test]
fn a_cut_by_the_caller_has_the_bits_of_a_blade_s() {
    let (mut with_blade, body) = scene();
    let blade = with_blade.add_blade(edge(-2.0));
    with_blade
        .set_blade_mode(blade, BladeMode::FullSlices)
        .unwrap();
    with_blade.move_blade(blade, edge(2.0)).unwrap();
    with_blade.cut().unwrap();
    let (mut by_caller, own) = scene();
    by_caller.cut().unwrap();
    let sweep = Sweep::new(edge(-2.0), edge(2.0)).unwrap();
    let params = CutParams::default();
    let outcome = by_caller.cut_with(own, &sweep, |cutter, surface| {
        cutter.cut(surface, &sweep, &params)
    });
    assert!(!outcome.unwrap().unwrap().is_miss());
    let (stats, expected) = (*by_caller.stats(), *with_blade.stats());
    assert_eq!(stats.cuts, 1);
    assert_eq!(stats.hit_triangles, expected.hit_triangles);
    assert!(by_caller.cuts().is_empty(), "no blade made the cut");
    for _ in 0..20 {
        with_blade.advance().unwrap();
        by_caller.advance().unwrap();
    }
    let [expected, found] = [(&with_blade, body), (&by_caller, own)]
        .map(|(scene, id)| scene.body(id).unwrap().surface().clone());
    assert_eq!(found.piece_count(), 2);
    assert!(found == expected, "the bodies move alike");
}

#[test]
fn an_error_of_the_caller_is_counted_and_changes_nothing() {
    let (mut scene, body) = scene();
    scene.cut().unwrap();
    let before = scene.body(body).unwrap().surface().clone();
    let sweep = Sweep::new(edge(-2.0), edge(0.0)).unwrap();
    let params = CutParams::default();
    let refused = scene.cut_with(body, &sweep, |cutter, surface| {
        cutter.cut(surface, &sweep, &params)
    });
    let error = refused.unwrap().unwrap_err();
    assert!(matches!(error, CutError::PartialCut { .. }), "{error:?}");
    assert_eq!((scene.stats().cuts, scene.stats().failed_cuts), (0, 1));
    assert_eq!(scene.body(body).unwrap().surface(), &before);
    scene.advance().unwrap();
}
