//! An undo joins pieces that have moved apart, and adds no energy.

use crate::contacts::above;
use incise_mesh::{Surface, Undo};
use incise_models::{Model, build_model};
use incise_pbd_gpu::Material;
use incise_scene::{BodyId, Scene};

/// Gravitational acceleration [m/s^2].
const G: f64 = 9.81;

/// Returns a scene in which a falling body has just been cut, and the undo of the cut.
fn cut_in_flight(surface: Surface) -> (Scene, BodyId, Undo) {
    let bounds = surface.bounds();
    let mut scene = above(bounds.min[1] - 0.2);
    let id = scene.add_body(surface, &Material::soft_body()).unwrap();
    let middle = (bounds.min[1] + bounds.max[1]) / 2.0;
    let edge = |x: f32, tilt: f32| [[x, middle + tilt, -2.0], [x, middle + tilt, 2.0]];
    let blade = scene.add_blade(edge(-2.0, -0.1));
    scene.step().unwrap();
    scene.move_blade(blade, edge(2.0, 0.1)).unwrap();
    scene.step().unwrap();
    let mut outcomes = scene.cuts().iter().filter_map(|sweep| sweep.cut.as_ref());
    let undo = outcomes.find_map(|(_, outcome)| outcome.undo.clone());
    let undo = undo.expect("the blade cuts");
    (scene, id, undo)
}

/// Returns kinetic, potential and elastic energy \[J\].
fn energy(scene: &Scene, id: BodyId) -> f64 {
    let solver = scene.body(id).unwrap().solver();
    let nodes = solver.nodes().iter().filter(|x| x[3] > 0.0);
    let moment: f64 = nodes.map(|x| f64::from(x[1]) / f64::from(x[3])).sum();
    solver.kinetic_energy() + solver.elastic_energy() + G * moment
}

/// Regression: parts that had moved apart snapped together with 170 J.
#[test]
#[ignore = "long"]
fn an_undo_in_motion_adds_no_energy() {
    for model in [Model::Sphere768, Model::Bunny, Model::Octopus] {
        let bounds = build_model(model).bounds();
        let extents = (0..3).map(|k| f64::from(bounds.max[k] - bounds.min[k]));
        let size = extents.fold(0.0, f64::max);
        for frames in [1, 10, 30, 60] {
            let (mut scene, id, undo) = cut_in_flight(build_model(model));
            let surface = scene.body(id).unwrap().surface();
            let whole = surface.rest_volume_of(surface.topology().triangles());
            for _ in 0..frames {
                scene.step().unwrap();
            }
            let apart = energy(&scene, id);
            scene.undo(id, undo).unwrap();
            assert_eq!(scene.body(id).unwrap().surface().piece_count(), 1);
            let joined = energy(&scene, id);
            let mut gain = f64::NEG_INFINITY;
            for _ in 0..120 {
                scene.step().unwrap();
                gain = gain.max(energy(&scene, id) - joined);
            }
            let body = scene.body(id).unwrap();
            body.solver().validate(body.surface()).unwrap();
            let kept = body.surface().volume() / whole;
            let name = model.name();
            assert!((kept - 1.0).abs() < 0.05, "{name}: {kept} of the volume");
            let weight = body.solver().total_mass() * G;
            assert!(gain < 0.01 * weight, "{name}, {frames} frames: {gain} J");
            // The ground lifts the center of a body whose parts lay on it.
            let lift = (joined - apart) / weight;
            assert!(
                lift < size / 2.0,
                "{name}, {frames} frames: lifted by {lift} m"
            );
        }
    }
}
