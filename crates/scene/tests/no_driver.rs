//! A scene on the processor opens no device. By itself in its process, so that nobody else opens one.
#![cfg(target_os = "linux")]

use incise_mesh::{Model, build_model};
use incise_pbd_gpu::Material;
use incise_scene::{BackendChoice, BackendRequest, Scene, SceneError, SceneParams};

/// Libraries of this process by which devices are opened.
fn drivers() -> Vec<String> {
    let maps = std::fs::read_to_string("/proc/self/maps").unwrap();
    let names = ["libvulkan", "libEGL", "libGLX", "libcuda"];
    let is_driver = |line: &&str| names.iter().any(|name| line.contains(name));
    maps.lines().filter(is_driver).map(str::to_owned).collect()
}

#[test]
fn no_driver_is_loaded_for_the_processor() -> Result<(), SceneError> {
    let request = BackendRequest {
        choice: BackendChoice::Cpu,
        ..BackendRequest::default()
    };
    let params = SceneParams::default();
    for mut scene in [Scene::new(params), Scene::with_backend(params, &request)?] {
        let id = scene.add_body(build_model(Model::Sphere80), &Material::default())?;
        let blade = scene.add_blade([[-2.0, 0.1, -2.0], [-2.0, 0.1, 2.0]]);
        for _ in 0..40 {
            scene.step()?;
        }
        scene.move_blade(blade, [[2.0, 0.1, -2.0], [2.0, 0.1, 2.0]]);
        scene.step()?;
        scene.read(id)?;
        assert_eq!(scene.backend_report().device, None);
    }
    assert_eq!(drivers(), Vec::<String>::new());
    Ok(())
}
