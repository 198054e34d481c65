//! Claims about sleep and volume on a GPU.

use super::claims::{put_to_sleep, scene_params};
use super::{Claim, Effort, Frame};
use incise_models::{Model, build_model};
use incise_pbd_gpu::{AdapterRequest, GpuBackend, GpuError, Material, SolverParams, Volume};
use incise_scene::{BackendChoice, BackendRequest, Scene, SleepParams};
use std::error::Error;

/// The name of a GPU that opens.
#[derive(Debug)]
pub(super) struct Device {
    name: Option<String>,
    description: String,
}

impl Device {
    /// Opens the GPU of that name, or the best one; software if there is no other.
    ///
    /// # Errors
    /// The error of opening it.
    pub(super) fn open(adapter: Option<&str>) -> Result<Self, GpuError> {
        let name = adapter.map(str::to_owned);
        let gpu = GpuBackend::new(&AdapterRequest::any(name.clone()))?;
        let adapter = gpu.adapter();
        let description = format!("{} ({})", adapter.name, adapter.driver);
        Ok(Self { name, description })
    }

    /// Returns the adapter's name and driver.
    pub(super) fn describe(&self) -> String {
        self.description.clone()
    }

    /// Returns all claims on the GPU.
    pub(super) fn claims(&self, effort: Effort) -> Vec<Claim> {
        let name = || self.name.clone();
        let mut claims = vec![asleep(name())];
        claims.extend(effort.models.iter().map(|&model| volume(name(), model)));
        claims
    }
}

/// Returns a scene of one body at rest on the GPU.
fn scene(
    adapter: Option<&String>,
    model: Model,
    volume: Option<Volume>,
    sleep: Option<SleepParams>,
) -> Result<Scene, Box<dyn Error>> {
    let request = BackendRequest {
        choice: BackendChoice::Gpu,
        adapter: adapter.cloned(),
        allow_software: true,
        ..BackendRequest::default()
    };
    let params = scene_params(SolverParams::default(), sleep);
    let mut scene = Scene::with_backend(params, &request)?;
    let material = Material {
        volume,
        ..Material::default()
    };
    scene.add_body(build_model(model), &material)?;
    Ok(scene)
}

/// Returns the frame of a scene; it ends when the GPU is done.
fn frame(mut scene: Scene) -> Frame {
    Box::new(move || {
        scene.step()?;
        Ok(scene.wait_for_gpu()?)
    })
}

fn asleep(adapter: Option<String>) -> Claim {
    Claim::new(
        "sleep",
        "time of a frame until the GPU is done, relative to the same body awake",
        Model::Bunny,
        0.01,
        move || {
            let of = |sleep| scene(adapter.as_ref(), Model::Bunny, None, sleep);
            let mut asleep = of(Some(SleepParams::default()))?;
            put_to_sleep(&mut asleep, 1)?;
            Ok([frame(asleep), frame(of(None)?)])
        },
    )
}

fn volume(adapter: Option<String>, model: Model) -> Claim {
    Claim::new(
        "volume",
        "time of a frame with volume until the GPU is done, relative to none",
        model,
        2.0,
        move || {
            let of = |volume| scene(adapter.as_ref(), model, volume, None);
            Ok([of(Some(Volume::default()))?, of(None)?].map(frame))
        },
    )
}
