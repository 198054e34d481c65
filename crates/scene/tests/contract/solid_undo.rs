//! Undo of cuts of solids: bits come back at rest, and pieces that have moved apart join softly.

use incise_cut::{CutParams, Sweep};
use incise_mesh::{Undo, Vec3, icosphere};
use incise_models::{Model, build_model};
use incise_pbd_gpu::{Collider, Material};
use incise_scene::{BodyId, Scene, SceneParams};

/// Cuts a body along a plane through a point of its box, and returns the undo.
fn cut(scene: &mut Scene, id: BodyId, normal: [f64; 3], part: f64) -> Undo {
    let bounds = scene.body(id).unwrap().surface().bounds();
    let [low, high] = [bounds.min, bounds.max].map(|p| Vec3::from(p.map(f64::from)));
    let distance = Vec3::from(normal).dot(&low.lerp(&high, part));
    let sweep = Sweep::from_plane(normal, distance, &bounds).unwrap();
    let outcome = scene.cut_with(id, &sweep, |cutter, surface| {
        cutter.cut(surface, &sweep, &CutParams::default())
    });
    outcome.unwrap().unwrap().undo.expect("the plane cuts")
}

/// Returns the bits of nodes, and of positions, masses and velocities of used vertices.
fn bits(scene: &Scene, id: BodyId) -> Vec<u32> {
    let body = scene.body(id).unwrap();
    let (surface, solver) = (body.surface(), body.solver());
    let lattice = solver.lattice().unwrap();
    let nodes = (0..)
        .zip(solver.nodes())
        .filter(|&(node, _)| lattice.is_node(node));
    let mut all: Vec<u32> = nodes.flat_map(|(_, x)| x.map(f32::to_bits)).collect();
    for v in surface.topology().vertices() {
        all.extend(surface.positions()[v.index()].map(f32::to_bits));
        all.extend(solver.velocity(v).map(f32::to_bits));
        all.push(solver.masses()[v.index()].to_bits());
    }
    all
}

#[test]
fn undone_cuts_leave_the_bits_before_them() {
    for (model, material) in [
        (Model::Sphere768, Material::soft_body()),
        (Model::Bunny, Material::rubber()),
    ] {
        let mut scene = Scene::new(SceneParams::default());
        scene.colliders.push(Collider::ground(-1.0));
        let id = scene.add_body(build_model(model), &material).unwrap();
        for _ in 0..20 {
            scene.step().unwrap();
        }
        let first = cut(&mut scene, id, [1.0, 0.2, 0.1], 0.45);
        let once = bits(&scene, id);
        let second = cut(&mut scene, id, [0.1, 1.0, -0.3], 0.55);
        let twice = bits(&scene, id);
        assert!(twice != once);
        scene.undo(id, second).unwrap();
        assert!(bits(&scene, id) == once, "{}", model.name());
        let second = cut(&mut scene, id, [0.1, 1.0, -0.3], 0.55);
        assert!(bits(&scene, id) == twice, "{}: again", model.name());
        scene.undo(id, second).unwrap();
        scene.undo(id, first).unwrap();
        let body = scene.body(id).unwrap();
        assert_eq!(body.pieces().len(), 1);
        body.solver().validate(body.surface()).unwrap();
    }
}

/// Regression: nodes of pieces that were a meter apart became one at their middle, and the cells
/// between them tore them back.
#[test]
fn pieces_that_fell_apart_join_without_a_jerk() {
    for seed in 0..6 {
        let mut scene = Scene::new(SceneParams::default());
        scene.colliders.push(Collider::ground(-0.8));
        let material = Material::solid(2e5, 0.45, 1000.0);
        let id = scene.add_body(icosphere(3, 0.4), &material).unwrap();
        let tilt = 0.3 * f64::from(seed);
        let undo = cut(&mut scene, id, [1.0, tilt - 0.7, 0.2], 0.5);
        for _ in 0..30 + 20 * seed {
            scene.step().unwrap();
        }
        let fastest = |scene: &Scene| {
            let velocities = scene.body(id).unwrap().solver().velocities().iter();
            let squares = velocities.map(|v| v[..3].iter().map(|c| c * c).sum::<f32>());
            squares.fold(0.0, f32::max).sqrt()
        };
        let before = fastest(&scene);
        scene.undo(id, undo).unwrap();
        let body = scene.body(id).unwrap();
        assert_eq!(body.pieces().len(), 1);
        let size = body.surface().bounds().diagonal();
        assert!(size < 1.7, "it is as large as the ball: {size}");
        let mut after = 0.0_f32;
        for _ in 0..60 {
            scene.step().unwrap();
            after = after.max(fastest(&scene));
        }
        // A fall by the height of the ball may follow.
        assert!(
            after < before + 4.5,
            "seed {seed}: {before} then {after} m/s"
        );
        let volume = scene.body(id).unwrap().surface().volume();
        let rest = 4.0 / 3.0 * std::f64::consts::PI * 0.4_f64.powi(3);
        assert!((volume / rest - 1.0).abs() < 0.05, "{volume}");
    }
}
