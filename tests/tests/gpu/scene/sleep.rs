//! GPU bodies sleep in the same frames as CPU bodies; sleeping ones cost no GPU time.

use super::common::{Bits, above_ground, bits, model, on};
use incise_mesh::VertexId;
use incise_models::Model;
use incise_pbd_gpu::{Context, Material, SolverParams, Stiffness};
use incise_scene::{BladeId, BodyId, Scene, SceneParams, SleepParams};

/// Models of one workgroup and of many.
const MODELS: [Model; 2] = [Model::Sphere80, Model::Bunny];

const SLEEP: SleepParams = SleepParams {
    speed: 6e-2,
    seconds: 10.0 / 60.0,
};

/// Sleeping bodies cost no GPU time, a cut wakes its body, and the fallback wakes all.
pub(crate) fn costs(context: Context) {
    costs_nothing(context.clone());
    cut(context.clone());
    leaves(context);
}

fn params() -> SceneParams {
    SceneParams {
        solver: SolverParams {
            iterations: 4,
            gravity: [0.0; 3],
            ..SolverParams::paper()
        },
        checkpoint: 0,
        sleep: Some(SLEEP),
        ..SceneParams::default()
    }
}

fn set_up(scene: &mut Scene) -> ([BodyId; 2], BladeId) {
    let jelly = Material {
        stretch: Stiffness::Compliance(1e-4),
        damping: 8.0,
        ..Material::default()
    };
    let mut x = -2.0;
    let ids = MODELS.map(|shape| {
        x += 2.0;
        let id = scene.add_body(model(shape, x), &jelly).unwrap();
        // A free body would drift without end after a push.
        let (solver, surface) = scene.edit(id).unwrap().solver_mut();
        for v in [0, 5, 20].map(VertexId) {
            solver.pin(surface, v).unwrap();
        }
        id
    });
    let blade = scene.add_blade([[-1.0, 50.0, -2.0], [-1.0, 50.0, 2.0]]);
    (ids, blade)
}

/// Returns the sleeping bodies after every frame, and states, while bodies are pushed, cut and
/// pinned.
fn play(mut scene: Scene) -> (Vec<[bool; 2]>, Vec<Bits>) {
    let (ids, blade) = set_up(&mut scene);
    let (mut asleep, mut states) = (Vec::new(), Vec::new());
    for frame in 0..260 {
        match frame {
            0 | 90 => {
                let (solver, _) = scene.edit(ids[frame / 90]).unwrap().solver_mut();
                solver.set_velocity(VertexId(2), [0.0, 1.0, 0.2]).unwrap();
            }
            150 => {
                scene
                    .teleport_blade(blade, [[-1.0, 0.05, -2.0], [-1.0, 0.05, 2.0]])
                    .unwrap();
                scene
                    .move_blade(blade, [[1.0, 0.06, -2.0], [1.0, 0.06, 2.0]])
                    .unwrap();
            }
            200 => {
                let (solver, surface) = scene.edit(ids[0]).unwrap().solver_mut();
                solver.pin(surface, VertexId(9)).unwrap();
            }
            _ => {}
        }
        let stats = scene.step().unwrap();
        assert_eq!(stats.cuts, u32::from(frame == 150));
        asleep.push(ids.map(|id| scene.is_asleep(id).unwrap()));
        if frame % 65 == 64 {
            states.extend(ids.map(|id| bits(&mut scene, id)));
        }
    }
    (asleep, states)
}

/// GPU bodies sleep and wake in the same frames as CPU bodies, on a strict adapter.
pub(crate) fn same_frames(context: Context) {
    let (on_device, device_states) = play(on(context, params()));
    let (on_cpu, cpu_states) = play(above_ground(Scene::new(params())));
    let differ = on_device.iter().zip(&on_cpu).position(|(a, b)| a != b);
    assert_eq!(differ, None, "the frame");
    assert!(device_states == cpu_states);
    for body in 0..2 {
        let sleeps = on_cpu.windows(2).filter(|w| !w[0][body] && w[1][body]);
        let wakes = on_cpu.windows(2).filter(|w| w[0][body] && !w[1][body]);
        let counts = (sleeps.count(), wakes.count());
        assert!(counts.0 >= 1 && counts.1 >= 1, "body {body}: {counts:?}");
    }
}

/// Returns a scene with two sleeping GPU bodies.
fn asleep(context: Context) -> (Scene, [BodyId; 2], BladeId) {
    let mut scene = on(context, params());
    let (ids, blade) = set_up(&mut scene);
    for frame in 0..300 {
        scene.step().unwrap();
        if ids.iter().all(|&id| scene.is_asleep(id).unwrap()) {
            assert!(frame >= 12, "a body is observed for at least 12 frames");
            return (scene, ids, blade);
        }
    }
    panic!(
        "bodies at rest stay awake: {:?}",
        ids.map(|id| scene.is_asleep(id).unwrap())
    );
}

fn costs_nothing(context: Context) {
    let (mut scene, ids, blade) = asleep(context);
    scene.step().unwrap();
    for _ in 0..50 {
        let stats = *scene.step().unwrap();
        assert_eq!((stats.sleeping_bodies, stats.gpu_bodies), (2, 0));
        assert_eq!((stats.dispatches, stats.kernels_compiled), (0, 0));
        assert_eq!((stats.bytes_uploaded, stats.bytes_read), (0, 0));
    }
    // A distant blade reads their bounding boxes back once.
    let mut read = 0;
    for frame in 0..20 {
        let x = if frame % 2 == 0 { 1.0 } else { -1.0 };
        scene
            .move_blade(blade, [[x, 50.0, -2.0], [x, 50.0, 2.0]])
            .unwrap();
        let stats = *scene.step().unwrap();
        assert_eq!((stats.sleeping_bodies, stats.narrow_phase_queries), (2, 0));
        assert_eq!(stats.dispatches, 0);
    }
    scene.wake(ids[0]).unwrap();
    for frame in 0..5 {
        let stats = *scene.step().unwrap();
        assert_eq!((stats.sleeping_bodies, stats.gpu_bodies), (1, 1));
        assert_eq!(stats.whole_bodies + stats.patch_bodies, 1);
        assert_eq!(stats.woken, u32::from(frame == 0));
        assert!(stats.dispatches > 0);
        read += stats.bytes_read;
    }
    assert_eq!(read, 2 * 44, "one motion report per body");
}

fn cut(context: Context) {
    let (mut scene, ids, blade) = asleep(context);
    scene
        .teleport_blade(blade, [[-1.0, 0.05, -2.0], [-1.0, 0.05, 2.0]])
        .unwrap();
    scene
        .move_blade(blade, [[1.0, 0.06, -2.0], [1.0, 0.06, 2.0]])
        .unwrap();
    let stats = *scene.step().unwrap();
    assert_eq!((stats.cuts, stats.woken, stats.sleeping_bodies), (1, 1, 1));
    assert_eq!((stats.readbacks, stats.broad_phase_rejections), (1, 1));
    assert!(!scene.is_asleep(ids[0]).unwrap() && scene.is_asleep(ids[1]).unwrap());
    assert_eq!(scene.body(ids[0]).unwrap().pieces().len(), 2);
}

fn leaves(context: Context) {
    let (mut scene, ids, _) = asleep(context);
    let before = ids.map(|id| bits(&mut scene, id));
    scene.fall_back();
    let after = ids.map(|id| bits(&mut scene, id));
    assert!(before == after, "nothing is lost");
    assert_eq!(scene.step().unwrap().woken, 2);
    for _ in 0..30 {
        scene.step().unwrap();
    }
    assert_eq!(ids.map(|id| scene.is_asleep(id).unwrap()), [true; 2]);
}
