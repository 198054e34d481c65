//! GPU scenes and their bits, for all tests with a GPU.

use incise_mesh::Surface;
use incise_models::{Model, build_model};
use incise_pbd_gpu::{Collider, Context, Material, SolverParams};
use incise_scene::{BackendChoice, BackendRequest, BodyId, Scene, SceneParams};

pub(crate) fn params() -> SceneParams {
    SceneParams {
        solver: SolverParams {
            iterations: 4,
            ..SolverParams::paper()
        },
        ..SceneParams::default()
    }
}

/// Requests the first GPU, of any kind, for bodies of any size.
pub(crate) fn request(choice: BackendChoice) -> BackendRequest {
    BackendRequest {
        choice,
        min_gpu_constraints: Some(0),
        ..BackendRequest::default()
    }
}

/// Adds a horizontal plane at -1.2 m to a scene.
pub(crate) fn above_ground(mut scene: Scene) -> Scene {
    scene.colliders.push(Collider::ground(-1.2));
    scene
}

pub(crate) fn on(context: Context, params: SceneParams) -> Scene {
    let scene = Scene::with_context(params, &request(BackendChoice::Gpu), context);
    above_ground(scene.unwrap())
}

/// Returns a model moved along the x axis.
pub(crate) fn model(model: Model, x: f32) -> Surface {
    let mut surface = build_model(model);
    for p in surface.positions_mut() {
        p[0] += x;
    }
    for p in surface.rest_positions_mut() {
        p[0] += x;
    }
    surface
}

pub(crate) fn add(scene: &mut Scene, shape: Model, x: f32) -> BodyId {
    scene
        .add_body(model(shape, x), &Material::default())
        .unwrap()
}

/// The bits of positions and velocities, shape [vertex slots].
pub(crate) type Bits = Vec<[u32; 6]>;

pub(crate) fn bits(scene: &mut Scene, id: BodyId) -> Bits {
    scene.read_back(id).unwrap();
    assert!(scene.residency(id).unwrap().is_cpu_current());
    cpu_copy_bits(scene, id)
}

/// Returns the bits of the CPU copy.
pub(crate) fn cpu_copy_bits(scene: &Scene, id: BodyId) -> Bits {
    let body = scene.body(id).unwrap();
    let positions = body.surface().positions().iter();
    positions
        .zip(body.solver().velocities())
        .map(|(p, v)| [p[0], p[1], p[2], v[0], v[1], v[2]].map(f32::to_bits))
        .collect()
}
