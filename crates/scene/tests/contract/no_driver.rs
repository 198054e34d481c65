//! A CPU scene loads no GPU driver.

use incise_models::{Model, build_model};
use incise_pbd_gpu::Material;
use incise_scene::{BackendChoice, BackendRequest, Scene, SceneError, SceneParams};
use incise_test_support::process::in_own_process;

/// Returns the GPU driver libraries that this process has mapped.
fn drivers() -> Vec<String> {
    let maps = std::fs::read_to_string("/proc/self/maps").unwrap();
    let names = ["libvulkan", "libEGL", "libGLX", "libcuda"];
    let is_driver = |line: &&str| names.iter().any(|name| line.contains(name));
    maps.lines().filter(is_driver).map(str::to_owned).collect()
}

#[test]
fn a_cpu_scene_loads_no_driver() {
    in_own_process("no_driver::a_cpu_scene_loads_no_driver", || {
        run_scenes_on_the_cpu().expect("valid scenes");
        assert_eq!(drivers(), Vec::<String>::new());
    });
}

fn run_scenes_on_the_cpu() -> Result<(), SceneError> {
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
        scene
            .move_blade(blade, [[2.0, 0.1, -2.0], [2.0, 0.1, 2.0]])
            .unwrap();
        scene.step()?;
        scene.read_back(id)?;
        assert_eq!(scene.backend_report().adapter, None, "no GPU is open");
    }
    Ok(())
}
