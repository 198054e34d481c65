//! Sleeping and waking of bodies, through [`Scene::step`].

mod bits;
mod falling_asleep;
mod waking;

use incise_cut::CutOutcome;
use incise_mesh::{Surface, VertexId};
use incise_models::{Model, build_model};
use incise_pbd_gpu::{Material, SolverParams, Stiffness};
use incise_scene::{
    BladeId, BodyId, ContactParams, FrameStats, Scene, SceneError, SceneParams, SleepParams,
};

/// Number of frames after which a body that never moved sleeps.
pub(crate) const UNTIL_ASLEEP: u32 = 10 + SleepParams::LAG;

pub(crate) const SLEEP: SleepParams = SleepParams {
    speed: 6e-2,
    seconds: 10.0 / 60.0,
};

/// Returns parameters without gravity.
pub(crate) fn weightless() -> SceneParams {
    SceneParams {
        solver: SolverParams {
            gravity: [0.0; 3],
            ..SolverParams::default()
        },
        sleep: Some(SLEEP),
        ..SceneParams::default()
    }
}

/// Returns a tetrahedron whose edge lengths have no rounding error, cut from an Euler brick.
pub(crate) fn exact_tetrahedron(at: f32) -> Surface {
    let corners = [[0, 0, 0], [44, 0, 0], [0, 117, 0], [0, 0, 240]];
    let corners = corners.map(|c: [i16; 3]| c.map(|c| f32::from(c) / 256.0 + at));
    Surface::from_triangles(&corners, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap()
}

/// Returns a material with stretch constraints only.
pub(crate) fn stretch_only() -> Material {
    Material {
        bending: None,
        ..Material::default()
    }
}

/// Returns a soft material with damping.
pub(crate) fn soft_damped() -> Material {
    Material {
        stretch: Stiffness::Compliance(1e-4),
        damping: 5.0,
        ..Material::default()
    }
}

pub(crate) fn run(scene: &mut Scene, frames: u32) {
    for _ in 0..frames {
        scene.step().unwrap();
    }
}

/// Returns a scene with two sleeping spheres and a blade far from both.
pub(crate) fn sleeping_scene() -> (Scene, [BodyId; 2], BladeId) {
    let mut scene = Scene::new(weightless());
    let ids = [0.0, 3.0].map(|x| {
        let mut surface = build_model(Model::Sphere80);
        surface.positions_mut().iter_mut().for_each(|p| p[0] += x);
        surface
            .rest_positions_mut()
            .iter_mut()
            .for_each(|p| p[0] += x);
        scene.add_body(surface, &Material::default()).unwrap()
    });
    let blade = scene.add_blade([[-1.0, 0.1, -2.0], [-1.0, 0.1, 2.0]]);
    run(&mut scene, UNTIL_ASLEEP);
    let asleep = ids.map(|id| scene.is_asleep(id).unwrap());
    assert_eq!(asleep, [true; 2], "both are at rest");
    (scene, ids, blade)
}

/// Returns the numbers of bodies that sleep, fell asleep and woke.
pub(crate) fn counts(stats: &FrameStats) -> [u32; 3] {
    [stats.sleeping_bodies, stats.fell_asleep, stats.woken]
}
