//! Pieces of a cut that lie on each other keep their volumes.

#[path = "common/firm.rs"]
mod firm;

use firm::firm;
use incise_mesh::{Model, build_model};
use incise_pbd_gpu::SolverParams;
use incise_scene::{ContactParams, Scene, SceneParams};

/// Contacts came after volumes alone: what they took from a piece was an old error in the next substep, of which little
/// comes back. Within a second the smaller part of a banana, which the larger had fallen onto, was turned inside out.
#[test]
fn pieces_that_fall_onto_each_other_keep_their_volumes() {
    let mut scene = Scene::new(SceneParams {
        solver: SolverParams {
            ground: Some(-0.6),
            ..SolverParams::default()
        },
        contacts: Some(ContactParams::default()),
        ..SceneParams::default()
    });
    let id = scene
        .add_body(build_model(Model::Banana), &firm(0.5, 0.0))
        .unwrap();
    let blade = scene.add_blade([[-2.0, 0.0, -2.0], [-2.0, 0.0, 2.0]]);
    scene.step().unwrap();
    scene.move_blade(blade, [[2.0, 0.0, -2.0], [2.0, 0.0, 2.0]]);
    assert_eq!(scene.step().unwrap().cuts, 1, "the blade cuts");
    let whole = scene.body(id).surface().piece_volumes();
    let mut touching = 0;
    for frame in 1..=120 {
        touching += scene.step().unwrap().contacts;
        let volumes = scene.body(id).surface().piece_volumes();
        // The impact presses small tips flat for a moment.
        let least = if frame == 120 { 0.99 } else { 0.5 };
        for (now, whole) in volumes.iter().zip(&whole) {
            let kept = now / whole;
            assert!(kept > least && kept < 1.01, "{kept} in frame {frame}");
        }
    }
    assert!(touching > 1000, "they touch: {touching}");
}
