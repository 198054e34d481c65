//! Solids in GPU scenes match those in CPU scenes to the last bit of a saved state.

use super::common::request;
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, VertexId, cuboid, icosphere, torus};
use incise_pbd_gpu::{Collider, Context, Material, Solid};
use incise_scene::{
    BackendChoice, BodyId, ContactParams, Scene, SceneParams, SleepParams, UndoStack,
};
use incise_test_support::random::Random;
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

/// Random scenes of solids: shapes, stiffnesses, supports, blades and undone cuts.
pub(crate) fn random(context: Context) {
    let ends: Vec<u16> = (0..SEEDS).map(|seed| play_random(&context, seed)).collect();
    let complete = ends.iter().filter(|&&end| end == RANDOM_FRAMES).count();
    assert!(
        2 * complete > ends.len(),
        "scenes ended after {ends:?} frames"
    );
}

/// Plays a random scene on both backends; returns the number of frames until it failed on both.
fn play_random(context: &Context, seed: u64) -> u16 {
    let mut scenes = [scene_on(context), Scene::new(params())];
    let [ids, _] = scenes.each_mut().map(|scene| set_up(scene, seed));
    let mut undo = [UndoStack::new(4), UndoStack::new(4)];
    let mut random = Random::new(!seed);
    for frame in 0..RANDOM_FRAMES {
        let command = Command::new(&mut random, ids.len());
        let mut failed = [false; 2];
        for ((scene, undo), failed) in scenes.iter_mut().zip(&mut undo).zip(&mut failed) {
            let ids: Vec<BodyId> = scene.bodies().collect();
            command.run(scene, &ids, undo);
            *failed = undo.step(scene).is_err();
        }
        if failed[1] {
            // A GPU reports numbers that are not finite with the next readback.
            let gpu = &mut scenes[0];
            let has_failed = failed[0] || ids.iter().any(|&id| gpu.read_back(id).is_err());
            assert!(has_failed, "the CPU fails in frame {frame} of seed {seed}");
            return frame;
        }
        if random.below(8) > 0 && frame + 1 < RANDOM_FRAMES {
            continue;
        }
        for i in 0..ids.len() {
            let [gpu, cpu] = scenes.each_mut().map(|scene| {
                let id = scene.bodies().nth(i).unwrap();
                (scene.is_asleep(id).unwrap(), state_of(scene, id))
            });
            let when = format!("body {i}, seed {seed}, frame {frame}");
            assert_eq!(gpu.0, cpu.0, "sleep of {when}");
            assert!(gpu.1 == cpu.1, "state of {when}");
        }
    }
    RANDOM_FRAMES
}

/// Scenes of the random test.
const SEEDS: u64 = 16;

/// Frames of a random scene.
const RANDOM_FRAMES: u16 = 90;

/// A random change of a scene before a frame.
#[derive(Debug, Clone, Copy)]
struct Command {
    kind: u8,
    body: usize,
    at: [f64; 3],
}

impl Command {
    fn new(random: &mut Random, bodies: usize) -> Self {
        Self {
            kind: u8::try_from(random.below(24)).unwrap_or(0),
            body: random.below(bodies),
            at: [random.signed(), random.signed(), random.signed()],
        }
    }

    fn run(&self, scene: &mut Scene, ids: &[BodyId], undo: &mut UndoStack) {
        let id = ids[self.body];
        let [x, y, z] = to_f32(self.at.into());
        let blade = scene.blades().next().unwrap();
        match self.kind {
            // Blades that cross the scene at once, or a part of it in every frame.
            0 => {
                let ends = [[2.0 + x, 0.3 * y, -3.0], [2.0 - z, 0.3 * z, 3.0]];
                scene.move_blade(blade, ends).unwrap();
            }
            1 => {
                let ends = [[-2.0 + x, 0.3 * y, -3.0], [-2.0 - z, 0.3 * z, 3.0]];
                scene.move_blade(blade, ends).unwrap();
            }
            2..8 => {
                let to = 0.3 * f32::from(self.kind) - 1.2;
                scene
                    .move_blade(blade, [[to, 0.1, -3.0], [to, 0.1, 3.0]])
                    .unwrap();
            }
            8 => {
                let (solver, surface) = scene.edit(id).unwrap().solver_mut();
                // The vertex may be gone.
                let _ = solver.pin(surface, VertexId(3));
            }
            9..12 => {
                let to = [0.3 * x, 0.3 * y, 0.3 * z];
                // The vertex may not be pinned.
                let _ = scene.set_pin_target(id, VertexId(3), to);
            }
            12 => {
                let (solver, surface) = scene.edit(id).unwrap().solver_mut();
                let _ = solver.unpin(surface, VertexId(3));
            }
            13 => {
                let (solver, _) = scene.edit(id).unwrap().solver_mut();
                let _ = solver.set_velocity(VertexId(1), [x, y, z]);
            }
            14 => {
                let (_, surface) = scene.edit(id).unwrap().solver_mut();
                surface.positions_mut()[2][1] += 0.02 * y;
            }
            15 => {
                let _ = undo.undo(scene, id);
            }
            16 => scene.colliders[0] = Collider::ground(-0.6 + 0.05 * y),
            _ => {}
        }
    }
}

/// Adds random bodies, the ground, a ball and a blade; returns the bodies.
fn set_up(scene: &mut Scene, seed: u64) -> Vec<BodyId> {
    let mut random = Random::new(seed);
    scene.params.sleep = (random.below(2) == 0).then(SleepParams::default);
    scene.params.contacts = (random.below(3) > 0).then(|| ContactParams {
        self_collision: random.below(2) == 0,
        ..ContactParams::default()
    });
    scene.colliders.push(Collider::ground(-0.6));
    scene.colliders.push(Collider::Sphere {
        center: [0.3, -0.6, 0.1],
        radius: 0.2,
    });
    scene.add_blade([[-3.0, 0.1, -3.0], [-3.0, 0.1, 3.0]]);
    (0..=random.below(3))
        .map(|i| {
            let surface = match random.below(3) {
                0 => icosphere(2, 0.4),
                1 => torus(0.35, 0.15, 20, 10),
                _ => cuboid([0.4, 0.1, 0.2], [6, 2, 3]),
            };
            let young_modulus = random.log(1e4, 1e8);
            let place = [0.2 * random.signed(), i as f64, 0.2 * random.signed()];
            add(scene, surface, young_modulus, place)
        })
        .collect()
}

/// Returns everything that is saved of a body.
///
/// Statistics are those of the last step on the CPU, which gets and plans colliders in reach only.
fn state_of(scene: &mut Scene, id: BodyId) -> [Value; 2] {
    scene.read_back(id).unwrap();
    let body = scene.body(id).unwrap();
    let mut solver = serde_json::to_value(body.solver()).unwrap();
    solver["step"]["stats"].take();
    solver["step"]["plan"].take();
    solver["constraints"]["colliders"].take();
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
