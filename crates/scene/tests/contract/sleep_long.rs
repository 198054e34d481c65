//! Balls on the ground, whole and cut, stay asleep, and stay in place when woken repeatedly.

use incise_cut::Sweep;
use incise_mesh::{Surface, Vec3, icosphere};
use incise_pbd_gpu::{Collider, Material, Stiffness};
use incise_scene::{BladeId, BodyId, Scene, SceneParams, SleepParams};
use incise_test_support::params::TEN_ITERATIONS;

/// Longest time until a body sleeps \[frames\].
const MAX_FRAMES: u32 = 3600;

fn shells() -> [Material; 3] {
    let shell = |stretch, bending| Material {
        stretch,
        bending: Some(bending),
        ..Material::default()
    };
    let rigid = Stiffness::Compliance(0.0);
    [
        shell(Stiffness::Pbd(1.0), Stiffness::Pbd(1.0)),
        shell(rigid, rigid),
        shell(Stiffness::Compliance(1e-5), Stiffness::Compliance(1e-2)),
    ]
}

/// Returns a scene with a ball on the ground and a distant blade.
fn lie(material: &Material) -> (Scene, BodyId, BladeId) {
    let mut scene = Scene::new(SceneParams {
        dt: 1.0 / 60.0,
        solver: TEN_ITERATIONS,
        ..SceneParams::default()
    });
    scene.colliders.push(Collider::ground(0.0));
    let mut ball = icosphere(0, 0.5);
    ball.rest_positions_mut()
        .iter_mut()
        .for_each(|p| p[1] += 0.5);
    ball.positions_mut().iter_mut().for_each(|p| p[1] += 0.5);
    let body = scene.add_body(ball, material).unwrap();
    let blade = scene.add_blade([[-1.0, 90.0, 0.0], [1.0, 90.0, 0.0]]);
    (scene, body, blade)
}

fn positions(scene: &mut Scene, body: BodyId) -> Vec<[f32; 4]> {
    scene.read_back(body).unwrap();
    scene.body(body).unwrap().surface().positions().to_vec()
}

fn cut(scene: &mut Scene, body: BodyId, blade: BladeId, normal: Vec3) {
    let surface: &Surface = scene.body(body).unwrap().surface();
    let (bounds, middle) = (surface.bounds(), surface.bounds().center());
    let sweep = Sweep::from_plane(normal.into(), normal.dot(&middle), &bounds).unwrap();
    let [before, after] = sweep.ends();
    scene.teleport_blade(blade, before).unwrap();
    scene.move_blade(blade, after).unwrap();
    scene.step().unwrap();
}

#[test]
fn a_ball_stays_asleep_whole_and_in_pieces() {
    for material in shells() {
        for cuts in [0, 2] {
            let (mut scene, body, blade) = lie(&material);
            let normals = [Vec3::new(0.3, 1.0, 0.2), Vec3::new(1.0, 0.1, -0.4)];
            for normal in normals.into_iter().take(cuts) {
                cut(&mut scene, body, blade, normal);
            }
            let (mut awake, mut asleep) = (0, None);
            for frame in 1..=2 * MAX_FRAMES {
                scene.step().unwrap();
                if !scene.is_asleep(body).unwrap() {
                    (awake, asleep) = (frame, None);
                } else if asleep.is_none() {
                    asleep = Some(positions(&mut scene, body));
                }
            }
            assert!(awake <= MAX_FRAMES, "awake in frame {awake}, {cuts} cuts");
            let moved = asleep != Some(positions(&mut scene, body));
            assert!(!moved, "it moved in its sleep, {cuts} cuts");
        }
    }
}

#[test]
fn a_ball_that_is_woken_a_thousand_times_stays_in_place() {
    for material in shells() {
        let (mut scene, body, _) = lie(&material);
        scene.params.solver.iterations = 1;
        // Sleep suppresses slow motion, so the body comes to rest without it first.
        scene.params.sleep = None;
        for _ in 0..MAX_FRAMES {
            scene.step().unwrap();
        }
        scene.params.sleep = Some(SleepParams {
            seconds: 0.0,
            ..SleepParams::default()
        });
        let settle = |scene: &mut Scene| {
            let asleep = (0..MAX_FRAMES).any(|_| {
                scene.step().unwrap();
                scene.is_asleep(body).unwrap()
            });
            assert!(asleep, "no sleep within {MAX_FRAMES} frames");
        };
        settle(&mut scene);
        let start = positions(&mut scene, body);
        for _ in 0..1000 {
            scene.wake(body).unwrap();
            settle(&mut scene);
        }
        for (a, b) in start.iter().zip(positions(&mut scene, body)) {
            let moved = (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f32::max);
            assert!(moved <= 1e-4, "{moved} m");
        }
    }
}
