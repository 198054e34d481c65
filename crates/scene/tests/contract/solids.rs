//! Solids that are cut in flight: pieces keep their shape, motion and momenta.

use incise_cut::{CutParams, Sweep};
use incise_mesh::{Surface, Vec3, VertexId, cuboid, icosphere, torus};
use incise_pbd_gpu::{Collider, Material};
use incise_scene::{BodyId, Scene, SceneParams};
use incise_test_support::pieces::pieces;
use incise_test_support::random::Random;
use incise_test_support::surfaces::at_rest;
use nalgebra::Rotation3;

const PLANES: [[f64; 3]; 3] = [[1.0, 0.2, 0.1], [0.1, 1.0, 0.3], [-0.2, 0.3, 1.0]];

/// Cuts a body along a plane through the center of its box, and returns how far a vertex jumped
/// [mean edges] and how much the momenta changed, relative to themselves.
fn cut(scene: &mut Scene, id: BodyId, normal: [f64; 3]) -> [f64; 2] {
    let momenta = |scene: &Scene| {
        let body = scene.body(id).unwrap();
        let solver = body.solver();
        let linear = Vec3::from(solver.momentum());
        (
            linear,
            Vec3::from(solver.angular_momentum(body.surface(), [0.0; 3])),
        )
    };
    scene.cut().unwrap();
    let bounds = scene.body(id).unwrap().surface().bounds();
    let [low, high] = [bounds.min, bounds.max].map(|p| Vec3::from(p.map(f64::from)));
    let distance = Vec3::from(normal).dot(&((low + high) / 2.0));
    let sweep = Sweep::from_plane(normal, distance, &bounds).unwrap();
    let before = momenta(scene);
    let mut placed = Vec::new();
    let outcome = scene.cut_with(id, &sweep, |cutter, surface| {
        let outcome = cutter.cut(surface, &sweep, &CutParams::default());
        placed = surface.positions().to_vec();
        outcome
    });
    assert!(!outcome.unwrap().unwrap().is_miss(), "the plane cuts");
    let after = momenta(scene);
    let surface = scene.body(id).unwrap().surface();
    let jump = |v: VertexId| {
        let [x, y, z, _] = placed[v.index()].map(f64::from);
        (surface.position(v) - Vec3::new(x, y, z)).norm()
    };
    let jump = surface.topology().vertices().map(jump).fold(0.0, f64::max);
    let changes = [
        (after.0 - before.0).norm() / before.0.norm(),
        (after.1 - before.1).norm() / before.1.norm().max(before.0.norm()),
    ];
    let edge = surface.mean_edge_length();
    scene.advance().unwrap();
    [jump / edge, changes[0].max(changes[1])]
}

/// Returns the largest distance of a piece from its rest shape, by its diagonal.
fn deviation(surface: &Surface) -> f64 {
    let pieces = pieces(surface).into_iter();
    pieces.map(|piece| piece.deviation).fold(0.0, f64::max)
}

#[test]
fn pieces_of_falling_solids_keep_their_shape_and_motion() {
    for (body, young_modulus) in [(0, 1e5), (0, 1e6), (1, 1e5), (1, 1e7)] {
        let surface = match body {
            0 => icosphere(3, 0.4),
            _ => torus(0.35, 0.15, 32, 16),
        };
        let volume = surface.volume();
        let mut scene = Scene::new(SceneParams::default());
        let material = Material::solid(young_modulus, 0.45, 1000.0);
        let id = scene.add_body(surface, &material).unwrap();
        for frame in 0..40 {
            if let Some(&normal) = PLANES.get(frame / 4).filter(|_| frame % 4 == 3) {
                let [jump, change] = cut(&mut scene, id, normal);
                assert!(jump < 0.02, "{jump} edges");
                assert!(change < 1e-4, "momenta change by {change}");
            } else {
                scene.step().unwrap();
            }
        }
        let body = scene.body(id).unwrap();
        assert!(body.pieces().len() >= 8, "{} pieces", body.pieces().len());
        let deviation = deviation(body.surface());
        assert!(deviation < 1e-3, "pieces are off by {deviation}");
        let whole = body.surface().volume();
        assert!((whole / volume - 1.0).abs() < 1e-3, "{whole} m^3");
        let speed = 9.81 * 40.0 / 60.0;
        let mean = Vec3::from(body.solver().momentum()) / body.solver().total_mass();
        assert!((mean.y + speed).abs() < 1e-3, "{mean:?}");
    }
}

/// Regression: full cells replaced by equal ones had no inverse masses, and cells of one piece took
/// their nodes from another one that it touched at rest.
#[test]
fn a_coarse_body_is_cut_on_the_ground() {
    for seed in 0..6 {
        let mut random = Random::new(seed);
        let turn = Rotation3::new(Vec3::from_fn(|_, _| 3.0 * random.signed()));
        let surface = at_rest(cuboid([0.35; 3], [1; 3]), |p| turn * p + Vec3::y());
        let volume = surface.volume();
        let mut scene = Scene::new(SceneParams::default());
        scene.colliders.push(Collider::ground(0.0));
        let material = Material::solid(random.log(1e6, 3e6), 0.45, 1000.0);
        let id = scene.add_body(surface, &material).unwrap();
        for frame in 0..120 {
            if let Some(&normal) = PLANES.get(frame / 20).filter(|_| frame % 20 == 19) {
                cut(&mut scene, id, normal);
            } else {
                scene.step().unwrap();
            }
        }
        let body = scene.body(id).unwrap();
        let whole = body.surface().volume();
        assert!(
            (whole / volume - 1.0).abs() < 0.05,
            "{whole} of {volume} m^3"
        );
        let deviation = deviation(body.surface());
        assert!(deviation < 0.05, "pieces are off by {deviation}");
    }
}

#[test]
fn an_undo_in_place_restores_a_solid() {
    let mut scene = Scene::new(SceneParams::default());
    let material = Material::solid(1e5, 0.45, 1000.0);
    let id = scene.add_body(icosphere(3, 0.4), &material).unwrap();
    scene.step().unwrap();
    let before = scene.body(id).unwrap().surface().clone();
    let bounds = before.bounds();
    let sweep = Sweep::from_plane([1.0, 0.2, 0.1], 0.02, &bounds).unwrap();
    let mut outcome = scene
        .cut_with(id, &sweep, |cutter, surface| {
            cutter.cut(surface, &sweep, &CutParams::default())
        })
        .unwrap()
        .unwrap();
    assert_eq!(scene.body(id).unwrap().pieces().len(), 2);
    let undo = outcome.undo.take().unwrap();
    scene.undo(id, undo).unwrap();
    let body = scene.body(id).unwrap();
    assert_eq!(body.pieces().len(), 1);
    let lattice = body.solver().lattice().unwrap();
    assert_eq!(
        (0..)
            .take(lattice.cells.len())
            .filter(|&c| lattice.is_copy(c))
            .count(),
        {
            let params = incise_pbd_gpu::Solver::new(&mut before.clone(), &material).unwrap();
            params.lattice().unwrap().cells.len()
        }
    );
    let edge = before.mean_edge_length();
    for v in before.topology().vertices() {
        let off = (body.surface().position(v) - before.position(v)).norm();
        assert!(off < 1e-3 * edge, "{v}: {off} m");
    }
    for _ in 0..30 {
        scene.step().unwrap();
    }
    let deviation = deviation(scene.body(id).unwrap().surface());
    assert!(deviation < 1e-4, "{deviation}");
}

#[test]
fn a_resting_solid_sleeps_by_the_length_of_its_edges() {
    let mut scene = Scene::new(SceneParams::default());
    scene.colliders.push(Collider::ground(-0.41));
    let surface = cuboid([0.4; 3], [12; 3]);
    let edge = surface.mean_edge_length();
    let material = Material::solid(1e6, 0.45, 1000.0);
    let id = scene.add_body(surface, &material).unwrap();
    let length = scene.body(id).unwrap().solver().mean_rest_length();
    assert!((length / edge - 1.0).abs() < 1e-6, "{length} m");
    let sleeps = (0..300).any(|_| {
        scene.step().unwrap();
        scene.is_asleep(id).unwrap()
    });
    assert!(sleeps, "a block at rest is awake after 5 s");
}

#[test]
fn cubes_fall_asleep_however_they_lie_in_their_lattices() {
    for seed in 0..6 {
        let mut random = Random::new(seed);
        let turn = Rotation3::new(Vec3::from_fn(|_, _| 3.0 * random.signed()));
        let surface = at_rest(cuboid([0.3; 3], [8; 3]), |p| turn * p + Vec3::y());
        let mut scene = Scene::new(SceneParams::default());
        scene.colliders.push(Collider::ground(0.0));
        let mut material = Material::solid(1e6, 0.45, 1000.0);
        material.solid.as_mut().unwrap().cells_across = 8;
        let id = scene.add_body(surface, &material).unwrap();
        let sleeps = (0..500).any(|_| {
            scene.step().unwrap();
            scene.is_asleep(id).unwrap()
        });
        assert!(sleeps, "cube {seed} is awake after 8 s");
    }
}

/// Returns a scene of a solid that was cut in flight.
#[cfg(feature = "serde")]
pub(crate) fn cut_solid() -> Scene {
    let mut scene = Scene::new(SceneParams::default());
    let material = Material::solid(1e5, 0.45, 1000.0);
    let id = scene
        .add_body(torus(0.35, 0.15, 32, 16), &material)
        .unwrap();
    for _ in 0..4 {
        scene.step().unwrap();
    }
    cut(&mut scene, id, PLANES[0]);
    scene
}

#[cfg(feature = "serde")]
#[test]
fn a_loaded_solid_goes_on_with_the_same_bits() {
    let mut scene = cut_solid();
    let id = scene.bodies().next().unwrap();
    let saved = scene.save().unwrap();
    let mut loaded = Scene::load(&saved).unwrap();
    let again = loaded.bodies().next().unwrap();
    for scene in [(&mut scene, id), (&mut loaded, again)] {
        let (scene, id) = scene;
        cut(scene, id, PLANES[1]);
        for _ in 0..10 {
            scene.step().unwrap();
        }
    }
    let bits = |scene: &Scene, id: BodyId| -> Vec<[u32; 4]> {
        let positions = scene.body(id).unwrap().surface().positions().iter();
        positions.map(|x| x.map(f32::to_bits)).collect()
    };
    assert!(bits(&scene, id) == bits(&loaded, again), "bits differ");
}
