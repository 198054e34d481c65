//! Unavailable backends, with and without the feature `gpu` and with and without a GPU.

use incise_models::{Model, build_model};
use incise_pbd_gpu::Material;
use incise_scene::{BackendChoice, BackendRequest, Scene, SceneError, SceneParams};

fn request(choice: BackendChoice) -> BackendRequest {
    BackendRequest {
        choice,
        adapter: Some("no such device".to_owned()),
        ..BackendRequest::default()
    }
}

#[test]
fn a_missing_gpu_is_a_typed_error() {
    let error = Scene::with_backend(SceneParams::default(), &request(BackendChoice::Gpu));
    let error = error.expect_err("there is none");
    #[cfg(feature = "gpu")]
    assert!(
        matches!(
            error,
            SceneError::Gpu(incise_pbd_gpu::GpuError::NoAdapter { .. })
        ),
        "{error}"
    );
    #[cfg(not(feature = "gpu"))]
    assert_eq!(error, SceneError::NoGpuBackend);
    assert!(error.to_string().len() > 20, "it says what to do: {error}");
}

#[test]
fn auto_without_a_gpu_falls_back_and_reports_it_once() -> Result<(), SceneError> {
    let params = SceneParams::default();
    let mut auto = Scene::with_backend(params, &request(BackendChoice::Auto))?;
    let mut cpu = Scene::new(params);
    let [a, b] = [&mut auto, &mut cpu]
        .map(|scene| scene.add_body(build_model(Model::Sphere80), &Material::default()));
    let (a, b) = (a?, b?);
    let told = auto.step()?.fell_back;
    assert!(told, "the first frame tells");
    for _ in 0..9 {
        assert!(!auto.step()?.fell_back, "once");
    }
    for _ in 0..10 {
        assert!(!cpu.step()?.fell_back, "nothing was asked for");
    }
    assert_eq!(
        auto.body(a).unwrap().surface(),
        cpu.body(b).unwrap().surface()
    );
    let report = auto.backend_report();
    assert_eq!((report.adapter, report.gpu_bodies), (None, Vec::new()));
    let why = report.fallback_reason.expect("a reason").to_string();
    #[cfg(feature = "gpu")]
    assert!(why.contains("no such device"), "{why}");
    #[cfg(not(feature = "gpu"))]
    assert!(why.contains("feature gpu"), "{why}");
    Ok(())
}
