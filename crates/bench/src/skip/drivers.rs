//! Whether a scene on the processor loads graphics drivers.

use super::row::Finding;
use super::{Effort, Measurement, at_rest, params};
use incise_mesh::{Model, build_model};
use incise_pbd_gpu::{Material, SolverParams};
use incise_scene::{BackendChoice, BackendRequest, Scene};
use std::error::Error;

/// Parts of the names of libraries that open devices.
const DRIVERS: [&str; 4] = ["libvulkan", "libEGL", "libGLX", "libcuda"];

/// The libraries of this process that open devices, where the system tells; as many as there are on all systems
/// that do not.
fn loaded() -> usize {
    let maps = std::fs::read_to_string("/proc/self/maps").unwrap_or_default();
    let is_driver = |line: &&str| DRIVERS.iter().any(|name| line.contains(name));
    maps.lines().filter(is_driver).count()
}

pub(super) fn measurement(effort: Effort) -> Measurement<'static> {
    Measurement::new(&["device"], "two scenes", move || {
        Ok([finding(effort.pairs)?])
    })
}

/// Steps scenes that the processor serves.
fn finding(frames: u32) -> Result<Finding, Box<dyn Error>> {
    let before = loaded();
    let mut plain = at_rest(Model::Sphere80, SolverParams::default(), None)?;
    let request = BackendRequest {
        choice: BackendChoice::Cpu,
        ..BackendRequest::default()
    };
    let mut asked = Scene::with_backend(params(SolverParams::default(), None), &request)?;
    asked.add_body(build_model(Model::Sphere80), &Material::default())?;
    for _ in 0..frames {
        plain.step()?;
        asked.step()?;
    }
    let devices = [&plain, &asked].map(|scene| scene.backend_report().device);
    let devices = devices.iter().flatten().count();
    Ok(Finding {
        skip: "device",
        claim: "devices opened and graphics libraries loaded for a scene on the processor",
        at: format!("{frames} frames of two scenes"),
        bound: 0.0,
        measured: (devices + loaded().saturating_sub(before)) as f64,
    })
}
