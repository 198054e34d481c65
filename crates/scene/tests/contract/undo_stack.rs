//! The undo stack: cuts of several bodies, its limit, and blades inside of what is undone.

use incise_mesh::Surface;
use incise_models::{Model, build_model};
use incise_pbd_gpu::{Material, SolverParams};
use incise_scene::{BladeId, BodyId, Scene, SceneError, SceneParams, UndoStack};

/// Returns a weightless scene of two spheres on top of each other and a blade beside them.
fn scene() -> (Scene, [BodyId; 2], BladeId) {
    let mut scene = Scene::new(SceneParams {
        solver: SolverParams {
            gravity: [0.0; 3],
            ..SolverParams::default()
        },
        ..SceneParams::default()
    });
    let bodies = [0.0, 2.0].map(|y| {
        let mut surface = build_model(Model::Sphere768);
        for p in surface.positions_mut() {
            p[1] += y;
        }
        scene.add_body(surface, &Material::soft_body()).unwrap()
    });
    let blade = scene.add_blade(edge(-2.0, 0.1));
    (scene, bodies, blade)
}

fn edge(x: f32, y: f32) -> [[f32; 3]; 2] {
    [[x, y, -2.0], [x, y, 2.0]]
}

fn slice(scene: &mut Scene, stack: &mut UndoStack, blade: BladeId, y: f32) {
    scene.teleport_blade(blade, edge(-2.0, y)).unwrap();
    scene.move_blade(blade, edge(2.0, y)).unwrap();
    let cuts = stack.step(scene).unwrap().cuts;
    assert_eq!(cuts, 1, "the blade cuts one sphere at {y} m");
}

fn surface(scene: &Scene, body: BodyId) -> &Surface {
    scene.body(body).unwrap().surface()
}

fn pieces(scene: &Scene, bodies: [BodyId; 2]) -> [usize; 2] {
    bodies.map(|body| surface(scene, body).piece_count())
}

#[test]
fn the_last_cut_of_each_body_is_undone() {
    let (mut scene, bodies, blade) = scene();
    let mut stack = UndoStack::new(256);
    let triangles = surface(&scene, bodies[0]).topology().triangle_count();
    for y in [0.1, 2.1, -0.1] {
        slice(&mut scene, &mut stack, blade, y);
    }
    assert!(stack.bodies().eq([bodies[0], bodies[1], bodies[0]]));
    assert_eq!(pieces(&scene, bodies), [3, 2]);
    stack.undo(&mut scene, bodies[1]).unwrap();
    assert_eq!(pieces(&scene, bodies), [3, 1]);
    let nothing = stack.undo(&mut scene, bodies[1]);
    assert_eq!(nothing, Err(SceneError::NothingToUndo { body: bodies[1] }));
    for left in [2, 1] {
        stack.undo(&mut scene, bodies[0]).unwrap();
        assert_eq!(pieces(&scene, bodies), [left, 1]);
    }
    let now = surface(&scene, bodies[0]).topology().triangle_count();
    assert_eq!(now, triangles);
}

#[test]
fn only_the_last_cuts_are_kept() {
    let (mut scene, bodies, blade) = scene();
    let mut stack = UndoStack::new(2);
    for y in [0.1, 2.1, -0.1] {
        slice(&mut scene, &mut stack, blade, y);
    }
    assert!(stack.bodies().eq([bodies[1], bodies[0]]));
    stack.set_limit(1);
    assert!(stack.bodies().eq([bodies[0]]));
    stack.forget(bodies[0]);
    assert_eq!(stack.bodies().len(), 0);
}

/// The tip of an incision is gone after its cut was undone; the blade must not go on from it.
#[test]
fn a_blade_inside_goes_on_after_its_cut_was_undone() {
    let (mut scene, bodies, blade) = scene();
    let mut stack = UndoStack::new(256);
    for x in [-0.2, 0.1] {
        scene.move_blade(blade, edge(x, 0.1)).unwrap();
        assert_eq!(stack.step(&mut scene).unwrap().cuts, 1);
    }
    assert!(scene.incision(blade, bodies[0]).unwrap().is_some());
    stack.undo(&mut scene, bodies[0]).unwrap();
    stack.undo(&mut scene, bodies[0]).unwrap();
    assert!(scene.incision(blade, bodies[0]).unwrap().is_none());
    scene.move_blade(blade, edge(0.2, 0.1)).unwrap();
    stack.step(&mut scene).unwrap();
    slice(&mut scene, &mut stack, blade, -0.1);
    assert_eq!(pieces(&scene, bodies)[0], 2);
}
