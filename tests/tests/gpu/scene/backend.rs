//! Choice of the backend per body, and the fallback to the CPU when the GPU is lost.

use super::common::{Bits, above_ground, add, bits, cpu_copy_bits, model, on, params, request};
use incise_mesh::{Bvh, Vec3, VertexId};
use incise_models::Model;
use incise_pbd_gpu::{Context, GpuError, Integrator, Material, Schedule};
use incise_scene::{BackendChoice, BackendRequest, ContactParams, Scene, SceneError, SceneParams};
use incise_test_support::gpu::Needs;

/// Device loss in a cut ends in a fallback to the CPU, and in an error where the GPU was asked for.
pub(crate) fn device_loss(context: Context) {
    lost_in_a_cut(context);
    lost(Context::open(&Needs::AnyDevice.request()).unwrap());
}

/// The backend of a scene and of each body is the requested one; invalid frames keep it.
pub(crate) fn choice(context: Context) {
    no_software();
    large_only(context.clone());
    wrong(context.clone());
    nested(context);
}

/// Returns the bits of a CPU body at the start and after every frame.
fn on_cpu(frames: usize) -> Vec<Bits> {
    let mut scene = above_ground(Scene::new(params()));
    let id = add(&mut scene, Model::Sphere80, 0.0);
    let mut out = vec![cpu_copy_bits(&scene, id)];
    for _ in 0..frames {
        scene.step().unwrap();
        out.push(cpu_copy_bits(&scene, id));
    }
    out
}

fn lose(scene: &Scene) {
    scene.gpu().unwrap().context().destroy();
}

/// A scene goes on from its checkpoint after a device loss, on a strict adapter.
pub(crate) fn lost_after_a_checkpoint(context: Context) {
    let params = SceneParams {
        checkpoint: 10,
        ..params()
    };
    let mut scene =
        above_ground(Scene::with_context(params, &request(BackendChoice::Auto), context).unwrap());
    // Its kernels compile faster than that of whole bodies.
    scene.force_schedule(Some(Schedule::Patches));
    let id = add(&mut scene, Model::Sphere80, 0.0);
    for _ in 0..20 {
        assert!(!scene.step().unwrap().fell_back);
    }
    // The checkpoint has arrived; the next frame applies it.
    scene.wait_for_gpu().unwrap();
    for _ in 0..4 {
        scene.step().unwrap();
    }
    let report = scene.backend_report();
    assert_eq!(
        (report.gpu_bodies, report.fallback_reason),
        (vec![id], None)
    );
    let reference = on_cpu(22);
    assert!(cpu_copy_bits(&scene, id) == reference[20], "the checkpoint");
    lose(&scene);
    let mut told = 0;
    for frame in [21, 22] {
        let stats = *scene.step().unwrap();
        told += u32::from(stats.fell_back);
        assert_eq!(stats.gpu_bodies, 0);
        assert!(bits(&mut scene, id) == reference[frame], "on from there");
    }
    assert_eq!(told, 1);
    let report = scene.backend_report();
    assert_eq!((report.adapter, report.gpu_bodies), (None, Vec::new()));
    let why = report.fallback_reason.unwrap().to_string();
    assert!(why.contains("lost"), "{why}");
}

fn lost_in_a_cut(context: Context) {
    let mut scene = above_ground(
        Scene::with_context(params(), &request(BackendChoice::Auto), context).unwrap(),
    );
    let ids = [0.0, 2.0].map(|x| add(&mut scene, Model::Sphere768, x));
    let blade = scene.add_blade([[-2.0, 0.06, -2.0], [-2.0, 0.1, 2.0]]);
    scene.step().unwrap();
    scene.step().unwrap();
    lose(&scene);
    scene
        .move_blade(blade, [[4.0, 0.06, -2.0], [4.0, 0.1, 2.0]])
        .unwrap();
    let stats = *scene.step().unwrap();
    assert_eq!((stats.cuts, stats.fell_back), (2, true));
    assert!(!scene.step().unwrap().fell_back);
    for id in ids {
        let body = scene.body(id).unwrap();
        assert_eq!(body.pieces().len(), 2);
        body.solver().validate(body.surface()).unwrap();
    }
}

/// Regression: positions of bodies on the GPU were moved on the CPU only.
fn nested(context: Context) {
    let mut params = params();
    params.contacts = Some(ContactParams::default());
    params.solver.gravity = [0.0; 3];
    let mut scene = on(context, params);
    scene.colliders.clear();
    let scaled = |scale: f32| {
        let mut ball = model(Model::Sphere80, 0.0);
        for p in ball.positions_mut() {
            *p = [scale * p[0] + 0.01, scale * p[1], scale * p[2], p[3]];
        }
        for p in ball.rest_positions_mut() {
            *p = [scale * p[0] + 0.01, scale * p[1], scale * p[2]];
        }
        ball
    };
    for scale in [1.0, 0.2] {
        let material = Material::soft_body();
        scene.add_body(scaled(scale), &material).unwrap();
    }
    let ids: Vec<_> = scene.bodies().collect();
    for _ in 0..240 {
        scene.step().unwrap();
    }
    for &id in &ids {
        scene.read_back(id).unwrap();
    }
    let [large, small] = [0, 1].map(|i| scene.body(ids[i]).unwrap().surface());
    let bvh = Bvh::build(large);
    let deep = small.topology().vertices().filter(|&v| {
        let at = small.position(v);
        let hit = bvh.cast(large, at, Vec3::new(0.3, 0.9, 0.2), |_| true);
        let near = bvh.nearest(large, at, 0.02, |_| true);
        hit.is_some_and(|hit| hit.from_inside) && near.is_none()
    });
    assert_eq!(deep.count(), 0, "vertices more than 2 cm inside of it");
}

fn lost(context: Context) {
    let mut scene = on(context, params());
    let id = add(&mut scene, Model::Sphere80, 0.0);
    for _ in 0..5 {
        scene.step().unwrap();
    }
    let last_read = bits(&mut scene, id);
    scene.step().unwrap();
    lose(&scene);
    for _ in 0..2 {
        let error = scene.step().unwrap_err();
        let is_lost = matches!(error, SceneError::Gpu(GpuError::DeviceLost { .. }));
        assert!(is_lost, "{error}");
    }
    assert!(
        scene.edit(id).is_err(),
        "what is not up to date is not edited"
    );
    assert!(
        cpu_copy_bits(&scene, id) == last_read,
        "as it was last read"
    );
    scene.fall_back();
    assert!(scene.step().unwrap().fell_back);
    assert!(bits(&mut scene, id) != last_read, "it goes on");
}

fn no_software() {
    let request = BackendRequest {
        choice: BackendChoice::Auto,
        adapter: Some("SwiftShader".to_owned()),
        allow_software: true,
        ..BackendRequest::default()
    };
    let mut scene = above_ground(Scene::with_backend(params(), &request).unwrap());
    let id = add(&mut scene, Model::Sphere80, 0.0);
    assert!(scene.step().unwrap().fell_back);
    assert!(cpu_copy_bits(&scene, id) == on_cpu(1)[1]);
    let why = scene.backend_report().fallback_reason.unwrap().to_string();
    assert!(why.contains("SwiftShader") && why.contains("CPU"), "{why}");
    let gpu = BackendRequest {
        choice: BackendChoice::Gpu,
        ..request
    };
    let scene = Scene::with_backend(params(), &gpu).unwrap();
    let device = scene.backend_report().adapter.unwrap();
    assert!(device.contains("SwiftShader"), "it was named: {device}");
}

fn large_only(context: Context) {
    let request = BackendRequest {
        min_gpu_constraints: Some(1000),
        ..request(BackendChoice::Auto)
    };
    let mut scene = above_ground(Scene::with_context(params(), &request, context).unwrap());
    let small = add(&mut scene, Model::Sphere80, 0.0);
    let large = add(&mut scene, Model::Sphere768, 2.0);
    let report = scene.backend_report();
    assert_eq!(
        (report.gpu_bodies, report.min_gpu_constraints),
        (vec![large], Some(1000))
    );
    for _ in 0..3 {
        assert_eq!(scene.step().unwrap().gpu_bodies, 1);
    }
    assert!(
        scene.residency(small).unwrap().is_cpu_current()
            && !scene.residency(large).unwrap().is_cpu_current()
    );
    assert!(cpu_copy_bits(&scene, small) == on_cpu(3)[3]);
}

fn wrong(context: Context) {
    let mut scene = above_ground(
        Scene::with_context(params(), &request(BackendChoice::Auto), context).unwrap(),
    );
    let id = add(&mut scene, Model::Sphere80, 0.0);
    scene.step().unwrap();
    scene.params.dt = 0.0;
    let error = scene.step().unwrap_err();
    assert!(matches!(error, SceneError::Parameter(_)), "{error}");
    scene.params = params();
    scene.params.solver.integrator = Integrator::Bdf2;
    let error = scene.step().unwrap_err();
    assert!(matches!(error, SceneError::Frame(_)), "{error}");
    scene.params = params();
    assert_eq!(scene.step().unwrap().gpu_bodies, 1);
    // A velocity that overflows is detected at the next readback.
    let (solver, _) = scene.edit(id).unwrap().solver_mut();
    solver.set_velocity(VertexId(2), [f32::MAX; 3]).unwrap();
    scene.params.dt = 1e6;
    scene.step().unwrap();
    let before = cpu_copy_bits(&scene, id);
    let error = scene.read_back(id).unwrap_err();
    assert!(
        matches!(error, SceneError::Step { body, .. } if body == id),
        "{error}"
    );
    assert!(
        cpu_copy_bits(&scene, id) == before,
        "the CPU copy is unchanged"
    );
}
