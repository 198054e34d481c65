//! Scenes on a device and their bits, for every test program that needs one.
#![allow(dead_code, reason = "every test file uses a part of it")]

#[path = "../../../pbd-gpu/tests/common/gpu.rs"]
pub(crate) mod gpu;

use incise_mesh::{Model, Surface, build_model};
use incise_pbd_gpu::{Context, Material, SolverParams};
use incise_scene::{BackendChoice, BackendRequest, BodyId, Scene, SceneParams};

pub(crate) fn params() -> SceneParams {
    SceneParams {
        solver: SolverParams {
            iterations: 4,
            ground: Some(-1.2),
            ..SolverParams::paper()
        },
        ..SceneParams::default()
    }
}

/// A request for the device at hand, whatever it is.
pub(crate) fn request(choice: BackendChoice) -> BackendRequest {
    BackendRequest {
        choice,
        device_from: Some(0),
        ..BackendRequest::default()
    }
}

pub(crate) fn on(context: Context, params: SceneParams) -> Scene {
    Scene::with_context(params, &request(BackendChoice::Gpu), context).unwrap()
}

/// A model, as far along the x axis.
pub(crate) fn model(model: Model, x: f32) -> Surface {
    let mut surface = build_model(model);
    for p in &mut surface.positions {
        p[0] += x;
    }
    for p in &mut surface.rest {
        p[0] += x;
    }
    surface
}

pub(crate) fn add(scene: &mut Scene, shape: Model, x: f32) -> BodyId {
    scene
        .add_body(model(shape, x), &Material::default())
        .unwrap()
}

/// Positions and velocities.
pub(crate) type Bits = Vec<[u32; 6]>;

pub(crate) fn bits(scene: &mut Scene, id: BodyId) -> Bits {
    scene.read(id).unwrap();
    assert!(scene.is_fresh(id));
    host_bits(scene, id)
}

/// Of the host's copy.
pub(crate) fn host_bits(scene: &Scene, id: BodyId) -> Bits {
    let body = scene.body(id);
    let positions = body.surface().positions.iter();
    positions
        .zip(body.solver().velocities())
        .map(|(p, v)| [p[0], p[1], p[2], v[0], v[1], v[2]].map(f32::to_bits))
        .collect()
}
