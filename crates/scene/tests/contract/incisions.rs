//! Blades that stop inside bodies and go on in later frames.

use incise_cut::Incision;
use incise_mesh::Surface;
use incise_models::{Model, build_model};
use incise_pbd_gpu::Material;
use incise_scene::{BladeId, BladeMode, BodyId, Scene, SceneParams};

/// Returns a scene with a ball of radius 0.5 m and a progressive blade to its left.
fn scene(material: &Material, model: Model) -> (Scene, BodyId, BladeId) {
    let mut scene = Scene::new(SceneParams::default());
    scene.params.solver.gravity = [0.0; 3];
    let body = scene.add_body(build_model(model), material).unwrap();
    let blade = scene.add_blade(pose(-0.7));
    let mode = scene.blade(blade).unwrap().mode;
    assert_eq!(mode, BladeMode::Progressive, "the default");
    (scene, body, blade)
}

fn pose(x: f32) -> [[f32; 3]; 2] {
    [[x, 0.1, -2.0], [x, 0.12, 2.0]]
}

fn check(scene: &Scene, body: BodyId) {
    let body = scene.body(body).unwrap();
    let surface: &Surface = body.surface();
    surface.validate().unwrap();
    assert!(surface.topology().is_closed(), "the surface is open");
    body.solver().validate(surface).unwrap();
}

#[test]
fn a_blade_in_small_steps_parts_a_ball() {
    for material in [Material::default(), Material::soft_body()] {
        let (mut scene, body, blade) = scene(&material, Model::Sphere768);
        let before = scene.body(body).unwrap();
        let (mass, volume) = (before.solver().total_mass(), before.surface().volume());
        let mut cuts = 0;
        for frame in 0u16..70 {
            scene
                .move_blade(blade, pose(-0.7 + 0.02 * f32::from(frame)))
                .unwrap();
            let stats = *scene.step().unwrap();
            assert_eq!(
                stats.failed_cuts,
                0,
                "frame {frame}: {:?}",
                scene.failed_cuts()
            );
            cuts += stats.cuts;
            check(&scene, body);
            if frame == 30 {
                assert_eq!(scene.body(body).unwrap().pieces(), [0], "half way");
            }
        }
        assert!(cuts > 5, "{cuts} steps");
        let body = scene.body(body).unwrap();
        assert_eq!(body.pieces(), [0, 1]);
        assert!((body.solver().total_mass() / mass - 1.0).abs() < 1e-5);
        assert!((body.surface().volume() / volume - 1.0).abs() < 0.02);
    }
}

#[test]
fn a_blade_that_stands_inside_costs_nothing() {
    let (mut scene, body, blade) = scene(&Material::default(), Model::Sphere768);
    for x in [-0.7, -0.2, 0.0] {
        scene.move_blade(blade, pose(x)).unwrap();
        scene.step().unwrap();
    }
    let is_inside = |scene: &Scene| {
        let incision = scene.incision(blade, body).unwrap();
        incision.is_some_and(Incision::is_inside)
    };
    for _ in 0..20 {
        let stats = *scene.step().unwrap();
        assert_eq!((stats.cuts, stats.narrow_phase_queries), (0, 0));
        check(&scene, body);
        assert!(is_inside(&scene));
    }
    // Pulled out by a jump: the slit stays, and the next stroke is a new one.
    scene.teleport_blade(blade, pose(-0.9)).unwrap();
    assert!(!is_inside(&scene));
    scene.move_blade(blade, pose(-0.8)).unwrap();
    assert_eq!(scene.step().unwrap().cuts, 0);
    check(&scene, body);
}

#[test]
fn a_moving_body_is_cut_where_its_tip_is() {
    let (mut scene, body, blade) = scene(&Material::default(), Model::Sphere768);
    scene.params.solver.gravity = [0.0, -1.0, 0.0];
    for frame in 0u16..70 {
        let fall = 0.5 * (f32::from(frame) / 60.0).powi(2);
        let edge = pose(-0.7 + 0.02 * f32::from(frame));
        let edge = edge.map(|[x, y, z]| [x, y - fall, z]);
        scene.move_blade(blade, edge).unwrap();
        let stats = *scene.step().unwrap();
        assert_eq!(
            stats.failed_cuts,
            0,
            "frame {frame}: {:?}",
            scene.failed_cuts()
        );
        check(&scene, body);
    }
    assert_eq!(scene.body(body).unwrap().pieces(), [0, 1]);
}
