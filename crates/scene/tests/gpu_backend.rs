//! Which bodies of a scene go to a device, and what becomes of them when it is lost.
#![expect(
    clippy::missing_assert_message,
    reason = "these are tests, which the lint knows by an attribute only"
)]

mod common;

use common::gpu::{Needs, run, trial};
use common::{Bits, add, bits, host_bits, on, params, request};
use incise_mesh::{Model, VertexId};
use incise_pbd_gpu::{Context, GpuError, Integrator};
use incise_scene::{BackendChoice, BackendRequest, Scene, SceneError, SceneParams};
use std::process::ExitCode;

fn main() -> ExitCode {
    let any = Needs::AnyDevice;
    run(vec![
        trial("auto_goes_on_without_the_device", Needs::Strict, lost_auto),
        trial("auto_cuts_though_the_device_is_lost", any, lost_in_a_cut),
        trial(
            "without_auto_a_lost_device_is_an_error",
            Needs::Strict,
            lost,
        ),
        trial("auto_takes_no_software", Needs::Strict, |_| no_software()),
        trial("auto_takes_large_bodies_only", any, large_only),
        trial(
            "a_frame_that_is_wrong_is_no_fault_of_the_device",
            any,
            wrong,
        ),
    ])
}

/// One body's bits after every frame on the processor, those at the start first.
fn on_cpu(frames: usize) -> Vec<Bits> {
    let mut scene = Scene::new(params());
    let id = add(&mut scene, Model::Sphere80, 0.0);
    let mut out = vec![host_bits(&scene, id)];
    for _ in 0..frames {
        scene.step().unwrap();
        out.push(host_bits(&scene, id));
    }
    out
}

fn lose(scene: &Scene) {
    scene.gpu().unwrap().context().destroy();
}

fn lost_auto(context: Context) {
    let params = SceneParams {
        checkpoint: 10,
        ..params()
    };
    let mut scene = Scene::with_context(params, &request(BackendChoice::Auto), context).unwrap();
    let id = add(&mut scene, Model::Sphere80, 0.0);
    for _ in 0..20 {
        assert!(!scene.step().unwrap().fell_back);
    }
    // The checkpoint has arrived, and the next frame takes it over.
    scene.wait().unwrap();
    for _ in 0..4 {
        scene.step().unwrap();
    }
    let report = scene.backend_report();
    assert_eq!((report.on_device, report.fallback), (vec![id], None));
    let reference = on_cpu(22);
    assert!(host_bits(&scene, id) == reference[20], "the checkpoint");
    lose(&scene);
    let mut told = 0;
    for frame in [21, 22] {
        let stats = *scene.step().unwrap();
        told += u32::from(stats.fell_back);
        assert_eq!(stats.bodies_on_device, 0);
        assert!(bits(&mut scene, id) == reference[frame], "on from there");
    }
    assert_eq!(told, 1);
    let report = scene.backend_report();
    assert_eq!((report.device, report.on_device), (None, Vec::new()));
    let why = report.fallback.unwrap();
    assert!(why.contains("lost"), "{why}");
}

fn lost_in_a_cut(context: Context) {
    let mut scene = Scene::with_context(params(), &request(BackendChoice::Auto), context).unwrap();
    let ids = [0.0, 2.0].map(|x| add(&mut scene, Model::Sphere768, x));
    let blade = scene.add_blade([[-2.0, 0.06, -2.0], [-2.0, 0.1, 2.0]]);
    scene.step().unwrap();
    scene.step().unwrap();
    lose(&scene);
    scene.move_blade(blade, [[4.0, 0.06, -2.0], [4.0, 0.1, 2.0]]);
    let stats = *scene.step().unwrap();
    assert_eq!((stats.cuts, stats.fell_back), (2, true));
    assert!(!scene.step().unwrap().fell_back);
    for id in ids {
        let body = scene.body(id);
        assert_eq!(body.pieces().len(), 2);
        body.solver().validate(body.surface()).unwrap();
    }
}

fn lost(context: Context) {
    let mut scene = on(context, params());
    let id = add(&mut scene, Model::Sphere80, 0.0);
    for _ in 0..5 {
        scene.step().unwrap();
    }
    let reference = on_cpu(6);
    assert!(bits(&mut scene, id) == reference[5]);
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
    assert!(host_bits(&scene, id) == reference[5], "as it was last read");
    scene.fall_back();
    assert!(scene.step().unwrap().fell_back);
    assert!(bits(&mut scene, id) == reference[6], "on from there");
}

fn no_software() {
    let request = BackendRequest {
        choice: BackendChoice::Auto,
        adapter: Some("SwiftShader".to_owned()),
        allow_software: true,
        ..BackendRequest::default()
    };
    let mut scene = Scene::with_backend(params(), &request).unwrap();
    let id = add(&mut scene, Model::Sphere80, 0.0);
    assert!(scene.step().unwrap().fell_back);
    assert!(host_bits(&scene, id) == on_cpu(1)[1]);
    let why = scene.backend_report().fallback.unwrap();
    assert!(
        why.contains("SwiftShader") && why.contains("processor"),
        "{why}"
    );
    let gpu = BackendRequest {
        choice: BackendChoice::Gpu,
        ..request
    };
    let scene = Scene::with_backend(params(), &gpu).unwrap();
    let device = scene.backend_report().device.unwrap();
    assert!(device.contains("SwiftShader"), "it was named: {device}");
}

fn large_only(context: Context) {
    let request = BackendRequest {
        device_from: Some(1000),
        ..request(BackendChoice::Auto)
    };
    let mut scene = Scene::with_context(params(), &request, context).unwrap();
    let small = add(&mut scene, Model::Sphere80, 0.0);
    let large = add(&mut scene, Model::Sphere768, 2.0);
    let report = scene.backend_report();
    assert_eq!(
        (report.on_device, report.device_from),
        (vec![large], Some(1000))
    );
    for _ in 0..3 {
        assert_eq!(scene.step().unwrap().bodies_on_device, 1);
    }
    assert!(scene.is_fresh(small) && !scene.is_fresh(large));
    assert!(host_bits(&scene, small) == on_cpu(3)[3]);
}

fn wrong(context: Context) {
    let mut scene = Scene::with_context(params(), &request(BackendChoice::Auto), context).unwrap();
    let id = add(&mut scene, Model::Sphere80, 0.0);
    scene.step().unwrap();
    scene.params.dt = 0.0;
    let error = scene.step().unwrap_err();
    assert!(matches!(error, SceneError::Frame(_)), "{error}");
    scene.params = params();
    scene.params.solver.integrator = Integrator::Bdf2;
    let error = scene.step().unwrap_err();
    assert!(matches!(error, SceneError::Frame(_)), "{error}");
    scene.params = params();
    assert_eq!(scene.step().unwrap().bodies_on_device, 1);
    // A kick that no number can follow is found when the body is looked at.
    let (solver, _) = scene.edit(id).unwrap().solver_mut();
    solver.set_velocity(VertexId(2), [f32::MAX; 3]).unwrap();
    scene.params.dt = 1e6;
    scene.step().unwrap();
    let before = host_bits(&scene, id);
    let error = scene.read(id).unwrap_err();
    assert!(
        matches!(error, SceneError::Step { body, .. } if body == id),
        "{error}"
    );
    assert!(host_bits(&scene, id) == before, "the host's copy is sound");
}
