//! GPU scenes match CPU scenes bit for bit and transfer only the data that a frame needs.

use super::common::{Bits, above_ground, add, bits, on, params};
use incise_mesh::VertexId;
use incise_models::{Model, build_model};
use incise_pbd_gpu::{Context, InteriorSprings, Material, Volume};
use incise_scene::{BladeId, BodyId, ContactParams, Scene, SceneParams};
use incise_test_support::gpu::Needs;

/// Bodies of one, a few and many workgroups.
const MODELS: [Model; 3] = [Model::Sphere80, Model::Sphere768, Model::Bunny];
const FRAMES: u32 = 60;

/// Blades cause readbacks of the bodies that they cut, and of boxes.
pub(crate) fn transfers(context: Context) {
    at_rest(context.clone());
    far_away(context.clone());
    one_body(context.clone());
    moved_by_an_edit(context);
}

/// Contacts of pieces, blade faces and bodies match the CPU on a strict adapter.
pub(crate) fn contacts(context: Context) {
    touching(context.clone());
    colliding(context);
}

/// Returns the states of bodies that are pinned, dragged, edited, pushed, cut and removed.
fn play(mut scene: Scene, shapes: &[(usize, Model)]) -> Vec<Bits> {
    let ids: Vec<BodyId> = (shapes.iter())
        .map(|&(place, shape)| add(&mut scene, shape, 2.0 * place as f32))
        .collect();
    let blade = scene.add_blade([[-2.0, 0.06, -2.0], [-2.0, 0.1, 2.0]]);
    let pinned = VertexId(3);
    let mut out = Vec::new();
    for frame in 0..FRAMES {
        for (&id, &(place, _)) in ids.iter().zip(shapes) {
            if place == 0 && frame >= 45 {
                continue;
            }
            match frame {
                5 if place != 1 => {
                    let (solver, surface) = scene.edit(id).unwrap().solver_mut();
                    solver.pin(surface, pinned).unwrap();
                }
                6..20 if place != 1 => {
                    let to = [2.0 * place as f32, 0.02 * frame as f32, 0.3];
                    scene.set_pin_target(id, pinned, to).unwrap();
                }
                20 if place != 1 => {
                    let (solver, surface) = scene.edit(id).unwrap().solver_mut();
                    solver.unpin(surface, pinned).unwrap();
                }
                30 => {
                    let (solver, _) = scene.edit(id).unwrap().solver_mut();
                    solver.set_velocity(VertexId(1), [0.0, 3.0, 0.5]).unwrap();
                }
                50 => {
                    // Positions that are set directly are not in the solver's change log.
                    let (_, surface) = scene.edit(id).unwrap().solver_mut();
                    surface.positions_mut()[7][1] += 0.01;
                }
                _ => {}
            }
        }
        if frame == 10 {
            scene
                .move_blade(blade, [[8.0, 0.06, -2.0], [8.0, 0.1, 2.0]])
                .unwrap();
        }
        if frame == 45
            && let Some(i) = shapes.iter().position(|&(place, _)| place == 0)
        {
            let body = scene.remove_body(ids[i]).unwrap();
            out.push(body.surface().positions().iter().map(in_bits).collect());
        }
        let stats = scene.step().unwrap();
        if frame == 10 {
            assert_eq!(stats.cuts as usize, shapes.len(), "all are cut");
        }
    }
    for (&id, &(place, _)) in ids.iter().zip(shapes) {
        if place != 0 {
            assert!(scene.body(id).unwrap().pieces().len() > 1);
            out.push(bits(&mut scene, id));
        }
    }
    out
}

fn in_bits(p: &[f32; 4]) -> [u32; 6] {
    [p[0], p[1], p[2], 0.0, 0.0, 0.0].map(f32::to_bits)
}

fn all() -> Vec<(usize, Model)> {
    MODELS.into_iter().enumerate().collect()
}

/// Several bodies that are edited in every way match the CPU on a strict adapter.
pub(crate) fn same_bits(context: Context) {
    let on_device = play(on(context, params()), &all());
    let on_cpu = play(above_ground(Scene::new(params())), &all());
    for (i, (device, cpu)) in on_device.iter().zip(&on_cpu).enumerate() {
        let differ = device.iter().zip(cpu).position(|(a, b)| a != b);
        assert_eq!(device.len(), cpu.len());
        assert_eq!(differ, None, "body {i} differs at this vertex");
    }
}

/// Returns the state of a ball that falls on a blade face and is cut by another blade.
///
/// Its pieces come to rest on each other and on the ground.
fn play_touching(mut scene: Scene) -> Bits {
    scene.params.contacts = Some(ContactParams {
        self_collision: true,
        ..ContactParams::default()
    });
    let material = Material {
        volume: Some(Volume::default()),
        interior_springs: Some(InteriorSprings::default()),
        ..Material::default()
    };
    let ball = build_model(Model::Sphere768);
    let id = scene.add_body(ball, &material).unwrap();
    let low = scene.add_blade([[-2.0, -0.9, -2.0], [-2.0, -0.9, 2.0]]);
    scene.set_blade_face(low, Some([4.0, 0.0, 0.0])).unwrap();
    let high = scene.add_blade([[-2.0, 0.1, -2.0], [-2.0, 0.2, 2.0]]);
    scene.set_blade_face(high, Some([-1.0, 0.0, 0.1])).unwrap();
    let mut most = 0;
    for frame in 0..60 {
        match frame {
            10 => scene
                .move_blade(high, [[2.0, -0.1, -2.0], [2.0, 0.0, 2.0]])
                .unwrap(),
            // The blade retreats along its back from under the pieces.
            30 => scene
                .move_blade(low, [[2.5, -0.9, -2.0], [2.5, -0.9, 2.0]])
                .unwrap(),
            _ => {}
        }
        most = most.max(scene.step().unwrap().contacts);
    }
    assert!(most > 50, "{most} contacts");
    assert_eq!(scene.body(id).unwrap().pieces().len(), 2);
    bits(&mut scene, id)
}

fn touching(context: Context) {
    let on_device = play_touching(on(context, params()));
    let on_cpu = play_touching(above_ground(Scene::new(params())));
    let differ = on_device.iter().zip(&on_cpu).position(|(a, b)| a != b);
    assert_eq!((on_device.len(), differ), (on_cpu.len(), None));
}

/// Returns the states of two bodies that collide, and in how many frames the GPU stepped
/// both of them.
fn play_colliding(mut scene: Scene) -> (Vec<Bits>, u32) {
    scene.params.contacts = Some(ContactParams::default());
    scene.params.solver.gravity = [0.0; 3];
    let ids = [(Model::Sphere768, 0.0), (Model::Sphere80, 2.5)];
    let ids = ids.map(|(shape, x)| add(&mut scene, shape, x));
    for (id, speed) in ids.into_iter().zip([4.0, -4.0]) {
        let (solver, surface) = scene.edit(id).unwrap().solver_mut();
        for v in surface.topology().vertices() {
            solver.set_velocity(v, [speed, 0.0, 0.0]).unwrap();
        }
    }
    let (mut contacts, mut on_gpu) = (0, 0);
    for _ in 0..FRAMES {
        let stats = *scene.step().unwrap();
        contacts += stats.contacts;
        on_gpu += u32::from(stats.gpu_bodies == 2);
    }
    assert!(contacts > 10, "{contacts} contacts");
    (ids.map(|id| bits(&mut scene, id)).to_vec(), on_gpu)
}

/// The GPU steps bodies until they touch, then the CPU does.
fn colliding(context: Context) {
    let (on_device, on_gpu) = play_colliding(on(context, params()));
    let (on_cpu, _) = play_colliding(above_ground(Scene::new(params())));
    assert!((5..FRAMES / 2).contains(&on_gpu), "{on_gpu} frames");
    assert!(on_device == on_cpu, "the bits differ");
}

/// A body has the same bits alone and on another device.
pub(crate) fn alone(context: Context) {
    let together = play(on(context, params()), &all());
    for (shape, together) in all().into_iter().zip(together) {
        let context = Context::open(&Needs::AnyDevice.request()).unwrap();
        let alone = play(on(context, params()), &[shape]);
        assert!(alone == [together], "{:?}", shape.1);
    }
}

/// Returns a scene with two GPU bodies and a distant blade that has moved once.
fn quiet(context: Context) -> (Scene, [BodyId; 2], BladeId) {
    let mut scene = on(
        context,
        SceneParams {
            checkpoint: 0,
            ..params()
        },
    );
    let bodies = [Model::Sphere80, Model::Sphere768];
    let bodies = [0.0, 2.0].map(|x| add(&mut scene, bodies[usize::from(x > 1.0)], x));
    let blade = scene.add_blade([[-2.0, 50.0, -2.0], [-2.0, 50.0, 2.0]]);
    (scene, bodies, blade)
}

fn at_rest(context: Context) {
    let (mut scene, bodies, _) = quiet(context);
    let mut uploaded = 0;
    for frame in 0..20 {
        let stats = *scene.step().unwrap();
        assert_eq!((stats.gpu_bodies, stats.readbacks), (2, 0));
        assert_eq!((stats.readbacks_skipped, stats.bytes_read), (2, 0));
        assert!(stats.dispatches > 0);
        assert_eq!(stats.whole_bodies + stats.patch_bodies, 2);
        // The first frame uploads the bodies, the second one the frame's parameters.
        assert!(frame < 2 || stats.bytes_uploaded <= uploaded);
        uploaded = stats.bytes_uploaded;
    }
    assert!(
        bodies
            .iter()
            .all(|&id| !scene.residency(id).unwrap().is_cpu_current()),
        "no readback was requested"
    );
    let state = scene.body(bodies[0]).unwrap().surface().positions().len() as u64 * 32;
    assert!(uploaded < state, "{uploaded} bytes a frame at rest");
}

fn far_away(context: Context) {
    let (mut scene, bodies, blade) = quiet(context);
    for frame in 0..20 {
        let x = if frame % 2 == 0 { 2.0 } else { -2.0 };
        scene
            .move_blade(blade, [[x, 50.0, -2.0], [x, 50.0, 2.0]])
            .unwrap();
        let stats = *scene.step().unwrap();
        assert_eq!((stats.sweeps, stats.broad_phase_rejections), (1, 2));
        assert_eq!((stats.readbacks, stats.readbacks_skipped), (0, 2));
        let smallest = scene.body(bodies[0]).unwrap().surface().positions().len() as u64 * 32;
        // In the first frame the CPU copies are current.
        assert_eq!(stats.bytes_read == 0, frame == 0);
        assert!(stats.bytes_read < smallest / 4, "{}", stats.bytes_read);
    }
}

fn one_body(context: Context) {
    let (mut scene, bodies, blade) = quiet(context);
    for _ in 0..3 {
        scene.step().unwrap();
    }
    // The sweep crosses the second body only.
    scene
        .teleport_blade(blade, [[1.2, 0.1, -2.0], [1.2, 0.1, 2.0]])
        .unwrap();
    scene
        .move_blade(blade, [[2.8, 0.1, -2.0], [2.8, 0.1, 2.0]])
        .unwrap();
    let stats = *scene.step().unwrap();
    assert_eq!((stats.cuts, stats.narrow_phase_queries), (1, 1));
    assert_eq!((stats.readbacks, stats.readbacks_skipped), (1, 1));
    let slots = scene.body(bodies[1]).unwrap().surface().positions().len() as u64;
    assert!(stats.bytes_read < (slots + 8) * 32, "one state, two boxes");
    assert!(stats.bytes_uploaded > 0);
    assert!(!scene.residency(bodies[0]).unwrap().is_cpu_current());
    assert_eq!(scene.body(bodies[1]).unwrap().pieces().len(), 2);
    // The next frame uploads its parameters only.
    assert!(scene.step().unwrap().bytes_uploaded < stats.bytes_uploaded / 4);
}

/// An edit moves a body into the way of a blade after its bounding box was read back.
fn moved_by_an_edit(context: Context) {
    let (mut scene, bodies, blade) = quiet(context);
    scene.step().unwrap();
    for (x, cuts) in [(4.0, 0), (-2.0, 1)] {
        scene
            .move_blade(blade, [[x, 50.0, -2.0], [x, 50.0, 2.0]])
            .unwrap();
        assert_eq!(scene.cut().unwrap().cuts, cuts);
        let (_, surface) = scene.edit(bodies[0]).unwrap().solver_mut();
        for p in surface.positions_mut() {
            p[1] += 49.9;
        }
    }
    assert_eq!(scene.body(bodies[0]).unwrap().pieces().len(), 2);
}
