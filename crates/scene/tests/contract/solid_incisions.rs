//! Incisions in solids under tension: they open behind the blade and come to rest.

use incise_mesh::{Surface, VertexId, cuboid};
use incise_pbd_gpu::Material;
use incise_scene::{BodyId, Scene, SceneParams};
use std::collections::BTreeMap;

/// Frames in which the block is stretched, and frames until it is at rest.
const STRETCHING: [u16; 2] = [60, 120];
/// Frames in which the blade moves.
const CUTTING: u16 = 20;

/// Returns a block of 1 x 0.2 x 0.2 m, held at its ends and stretched by 5 %.
fn stretched(cell_size: f32) -> (Scene, BodyId) {
    let mut params = SceneParams::default();
    params.solver.gravity = [0.0; 3];
    let mut scene = Scene::new(params);
    let mut material = Material::solid(1e6, 0.45, 1000.0);
    material.solid.as_mut().unwrap().cell_size = Some(cell_size);
    let surface = cuboid([0.5, 0.1, 0.1], [30, 6, 6]);
    let is_end = |v: &VertexId| surface.rest_position(*v).x.abs() > 0.499;
    let ends: Vec<VertexId> = surface.topology().vertices().filter(is_end).collect();
    let rest = surface.rest_positions().to_vec();
    let id = scene.add_body(surface, &material).unwrap();
    let (solver, surface) = scene.edit(id).unwrap().solver_mut();
    for &v in &ends {
        solver.pin(surface, v).unwrap();
    }
    for frame in 0..STRETCHING[0] + STRETCHING[1] {
        let part = f32::from((frame + 1).min(STRETCHING[0])) / f32::from(STRETCHING[0]);
        for &v in &ends {
            let [x, y, z] = rest[v.index()];
            let target = [x * (1.0 + 0.05 * part), y, z];
            scene.set_pin_target(id, v, target).unwrap();
        }
        scene.step().unwrap();
    }
    (scene, id)
}

/// Returns the largest distance of two vertices with the same rest position \[m\].
fn opening(surface: &Surface) -> f64 {
    let mut copies = BTreeMap::<[u32; 3], VertexId>::new();
    let mut largest: f64 = 0.0;
    for v in surface.topology().vertices() {
        let rest = surface.rest_positions()[v.index()].map(f32::to_bits);
        let other = *copies.entry(rest).or_insert(v);
        largest = largest.max((surface.position(v) - surface.position(other)).norm());
    }
    largest
}

/// Cuts to a depth of 0.12 m, and returns the opening \[m\].
fn cut(cell_size: f32) -> f64 {
    let (mut scene, id) = stretched(cell_size);
    let pose = |frame: u16| {
        let y = 0.12 - 0.14 * f32::from(frame) / f32::from(CUTTING);
        [[0.013, y, -0.3], [0.013, y, 0.3]]
    };
    let blade = scene.add_blade(pose(0));
    let mut last = 0.0;
    for frame in 0..=CUTTING {
        scene.move_blade(blade, pose(frame)).unwrap();
        let stats = *scene.step().unwrap();
        assert_eq!(stats.failed_cuts, 0, "{:?}", scene.failed_cuts());
        let body = scene.body(id).unwrap();
        let incision = scene.incision(blade, id).unwrap();
        assert!(
            body.surface().topology().triangle_count() == 1584 || incision.unwrap().is_inside(),
            "the tip is lost in frame {frame}"
        );
        let speed = |v: &[f32; 4]| v.iter().map(|c| c * c).sum::<f32>().sqrt();
        let fastest = body.solver().velocities().iter().map(speed);
        let fastest = fastest.fold(0.0, f32::max);
        assert!(fastest < 1.0, "{fastest} m/s");
        last = opening(body.surface());
    }
    assert!(last > 0.02, "{last} m at the last step");
    let sleeps = (0..300).any(|_| {
        scene.step().unwrap();
        scene.is_asleep(id).unwrap()
    });
    assert!(sleeps, "awake after 5 s with cells of {cell_size} m");
    let body = scene.body(id).unwrap();
    body.surface().validate().unwrap();
    assert_eq!(body.pieces().len(), 1, "half through");
    opening(body.surface())
}

#[test]
fn a_slit_under_tension_opens_alike_in_lattices_of_four_to_eight_cells() {
    let openings = [4.0, 6.0, 8.0].map(|across| cut(0.2 / across));
    for pair in openings.windows(2) {
        assert!((pair[1] / pair[0] - 1.0).abs() < 0.2, "{openings:?} m");
    }
}
