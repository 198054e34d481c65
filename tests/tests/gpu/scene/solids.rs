//! Solids in GPU scenes match those in CPU scenes to the last bit of a saved state.

use super::common::request;
use incise_mesh::{Surface, VertexId, cuboid, icosphere};
use incise_pbd_gpu::{Collider, Context, Material, Solid};
use incise_scene::{BackendChoice, BodyId, ContactParams, Scene, SceneParams};
use incise_test_support::surfaces::at_rest;
use nalgebra::Vector3;
use serde_json::Value;

const FRAMES: u16 = 36;

/// Frames before a scene is saved: no body moves by a caller after them.
const SAVED: u16 = 21;

/// Cut, dragged, edited and touching solids, which move between GPU and CPU.
pub(crate) fn to_the_bit(context: Context) {
    let on_gpu = scene_on(&context);
    let gpu = play(on_gpu, true);
    let cpu = play(Scene::new(params()), false);
    assert_eq!(gpu.cuts, cpu.cuts, "of all frames");
    assert_eq!(gpu.contacts, cpu.contacts, "of all frames");
    assert!(gpu.contacts > 0, "bodies touch");
    let all = 3 * u32::from(FRAMES);
    assert!((40..all).contains(&gpu.steps), "{} of {all}", gpu.steps);
    for (gpu, cpu) in gpu.states.iter().zip(&cpu.states) {
        assert!(gpu == cpu, "the states differ");
    }
    // What was saved on the GPU goes on with the same bits on the CPU.
    let mut loaded = Scene::load(&gpu.saved).unwrap();
    for _ in SAVED..FRAMES {
        loaded.step().unwrap();
    }
    let ids: Vec<BodyId> = loaded.bodies().collect();
    for (id, state) in ids.into_iter().zip(&gpu.states) {
        assert!(state_of(&mut loaded, id) == *state, "after a load");
    }
}

/// Returns everything that is saved of a body, without the statistics of its last step on the CPU.
fn state_of(scene: &mut Scene, id: BodyId) -> [Value; 2] {
    scene.read_back(id).unwrap();
    let body = scene.body(id).unwrap();
    let mut solver = serde_json::to_value(body.solver()).unwrap();
    solver["step"]["stats"].take();
    [solver, serde_json::to_value(body.surface()).unwrap()]
}

fn params() -> SceneParams {
    SceneParams {
        contacts: Some(ContactParams::default()),
        sleep: None,
        ..SceneParams::default()
    }
}

fn scene_on(context: &Context) -> Scene {
    Scene::with_context(params(), &request(BackendChoice::Gpu), context.clone()).unwrap()
}

/// The results of a scene.
struct Played {
    /// Steps of single bodies by the GPU.
    steps: u32,
    cuts: u32,
    contacts: usize,
    /// The scene after [`SAVED`] frames.
    saved: Vec<u8>,
    /// The bodies at the end.
    states: [[Value; 2]; 3],
}

/// Returns a body at rest at a place, with cells of 0.2 m.
fn add(scene: &mut Scene, surface: Surface, young_modulus: f32, at: [f64; 3]) -> BodyId {
    let surface = at_rest(surface, |p| p + Vector3::from(at));
    let material = Material::solid(young_modulus, 0.4, 1000.0);
    let material = Material {
        solid: material.solid.map(|solid| Solid {
            cell_size: Some(0.2),
            ..solid
        }),
        ..material
    };
    scene.add_body(surface, &material).unwrap()
}

/// A ball is cut in flight, a box hangs on a pin that moves, and another ball falls onto it. All
/// fall to the ground.
fn play(mut scene: Scene, is_on_gpu: bool) -> Played {
    scene.colliders.push(Collider::ground(-0.55));
    let ball = add(&mut scene, icosphere(2, 0.4), 1e5, [0.0; 3]);
    let held = add(&mut scene, cuboid([0.3; 3], [2; 3]), 3e5, [2.0, 0.0, 0.0]);
    let falling = add(&mut scene, icosphere(2, 0.3), 1e6, [2.0, 0.7, 0.0]);
    let blade = scene.add_blade([[-1.0, 0.0, -1.0], [-1.0, 0.0, 1.0]]);
    let pinned = VertexId(3);
    let mut played = Played {
        steps: 0,
        cuts: 0,
        contacts: 0,
        saved: Vec::new(),
        states: Default::default(),
    };
    for frame in 0..FRAMES {
        match frame {
            2 => {
                let (solver, surface) = scene.edit(held).unwrap().solver_mut();
                solver.pin(surface, pinned).unwrap();
            }
            3..20 => {
                let to = [1.7, 0.3 + 0.01 * f32::from(frame), 0.3];
                scene.set_pin_target(held, pinned, to).unwrap();
            }
            20 => {
                let (solver, surface) = scene.edit(held).unwrap().solver_mut();
                solver.unpin(surface, pinned).unwrap();
            }
            _ => {}
        }
        match frame {
            5 => {
                let ends = [[1.0, -0.1, -1.0], [1.0, -0.1, 1.0]];
                scene.move_blade(blade, ends).unwrap();
            }
            8 => {
                let (solver, surface) = scene.edit(falling).unwrap().solver_mut();
                solver.set_velocity(VertexId(1), [0.0, 3.0, 0.5]).unwrap();
                surface.positions_mut()[7][1] += 0.01;
            }
            _ => {}
        }
        let stats = *scene.step().unwrap();
        played.steps += stats.gpu_bodies;
        played.cuts += stats.cuts;
        played.contacts += stats.contacts;
        assert!(is_on_gpu || stats.gpu_bodies == 0, "a scene on the CPU");
        if frame + 1 == SAVED {
            played.saved = scene.save().unwrap();
        }
    }
    assert!(scene.body(ball).unwrap().pieces().len() > 1, "it is cut");
    played.states = [ball, held, falling].map(|id| state_of(&mut scene, id));
    played
}
