//! Scenes for the tests of saving and loading.

use incise_mesh::{Blend, Channel, Domain, Surface, VertexId, icosphere, sheet};
use incise_models::scenes::sprung;
use incise_pbd_gpu::{Collider, Material, PatchParams, SolverParams, Stiffness};
use incise_scene::{BladeMode, BodyId, ContactParams, Scene, SceneParams, SleepParams};

/// Number of frames after which the bodies of [`busy`] are cut, touch, or sleep.
pub(crate) const BUSY_FRAMES: u32 = 100;

/// Patches of bodies with few triangles.
pub(crate) const SMALL_PATCHES: PatchParams = PatchParams {
    vertices: 16,
    room: 4,
};

/// Moves the vertices of a surface and their rest positions \[m\].
fn moved(mut surface: Surface, by: [f32; 3]) -> Surface {
    for p in surface.positions_mut() {
        (0..3).for_each(|k| p[k] += by[k]);
    }
    for p in surface.rest_positions_mut() {
        (0..3).for_each(|k| p[k] += by[k]);
    }
    surface
}

/// Returns a ball with texture coordinates and a color per vertex.
fn colored(subdivisions: u32, radius: f64) -> Surface {
    let mut ball = icosphere(subdivisions, radius);
    let slots = ball.topology().vertex_slots();
    let values = (0..3 * slots).map(|i| i as f32 / (3 * slots) as f32);
    let colors = Channel::new("color", Domain::Vertex, Blend::Linear, 3, values.collect());
    ball.set_channel(colors.unwrap()).unwrap();
    let corners = 3 * ball.topology().triangle_slots();
    let uvs = (0..corners).map(|i| [i as f32, 0.5]);
    ball.set_corner_uvs(uvs.collect()).unwrap();
    ball
}

/// Returns a scene of two balls that a blade cuts and that fall onto each other and a collider, a
/// cloth that falls asleep on the ground, a hanging ball with a blade in it, and a removed body.
///
/// `levels` are the levels of subdivision of the balls. The second ball is divided into patches.
pub(crate) fn busy(levels: [u32; 3], patches: &PatchParams) -> Scene {
    let mut scene = Scene::new(SceneParams {
        solver: SolverParams {
            substep: None,
            iterations: 3,
            ..SolverParams::default()
        },
        contacts: Some(ContactParams::default()),
        sleep: Some(SleepParams {
            seconds: 0.25,
            ..SleepParams::default()
        }),
        ..SceneParams::default()
    });
    let ball = Collider::Sphere {
        center: [0.2, 0.0, 0.1],
        radius: 0.15,
    };
    scene.colliders = vec![ball, Collider::ground(0.0)];
    let soft = Material {
        stretch: Stiffness::Compliance(1e-5),
        ..sprung()
    };
    let [upper, lower, hanging] = levels;
    let upper = moved(icosphere(upper, 0.25), [0.0, 1.0, 0.0]);
    scene.add_body(upper, &soft).unwrap();
    let (lower, shell) = (
        moved(colored(lower, 0.3), [0.05, 0.4, 0.0]),
        Material::shell(),
    );
    (scene.add_body_with_patches(lower, &shell, Some(patches))).unwrap();
    let removed = scene
        .add_body(icosphere(1, 0.1), &Material::default())
        .unwrap();
    let cloth = moved(sheet([0.3, 0.3], [3, 3]), [-3.0, 0.0, 0.0]);
    scene.add_body(flat(cloth), &Material::cloth()).unwrap();
    let hanging = moved(icosphere(hanging, 0.4), [3.0, 1.0, 0.0]);
    let hanging = scene.add_body(hanging, &Material::soft_body()).unwrap();
    pin_top(&mut scene, hanging);
    scene.remove_body(removed).unwrap();
    let slicer = scene.add_blade([[-2.0, -1.0, 0.01], [-2.0, 3.0, 0.05]]);
    scene.set_blade_mode(slicer, BladeMode::FullSlices).unwrap();
    scene.add_blade(held(0));
    let pusher = scene.add_blade(pushing(0));
    scene.set_blade_face(pusher, Some([0.0, 0.5, 0.0])).unwrap();
    scene
}

/// Returns a scene of [`busy`] with few triangles after 40 frames.
pub(crate) fn small() -> Scene {
    let mut scene = busy([1, 1, 1], &SMALL_PATCHES);
    for frame in 0..40 {
        move_blades(&mut scene, frame);
        scene.step().unwrap();
    }
    scene
}

/// Returns a scene of a hanging ball with an energy after some frames; the last two follow an edit.
pub(crate) fn hanging(solver: SolverParams) -> Scene {
    let mut scene = Scene::new(SceneParams {
        solver,
        ..SceneParams::default()
    });
    let material = Material {
        stretch: Stiffness::Compliance(1e-4),
        bending: Some(Stiffness::Compliance(1e-2)),
        ..Material::default()
    };
    let ball = moved(icosphere(2, 0.4), [0.0, 1.0, 0.0]);
    let ball = scene.add_body(ball, &material).unwrap();
    for frame in 0..4 {
        if frame == 2 {
            pin_top(&mut scene, ball);
        }
        scene.step().unwrap();
    }
    scene
}

/// Returns a scene of two balls deep in each other.
pub(crate) fn overlapping() -> Scene {
    let mut scene = Scene::new(SceneParams {
        contacts: Some(ContactParams::default()),
        ..SceneParams::default()
    });
    for x in [0.0, 0.1] {
        let ball = moved(icosphere(2, 0.4), [x, 1.0, 0.0]);
        scene.add_body(ball, &Material::soft_body()).unwrap();
    }
    for _ in 0..12 {
        scene.step().unwrap();
    }
    scene
}

/// Returns a sheet that lies on the ground.
fn flat(mut cloth: Surface) -> Surface {
    for p in cloth.positions_mut() {
        p[1] = 0.0;
    }
    cloth
}

fn pin_top(scene: &mut Scene, body: BodyId) {
    let (solver, surface) = scene.edit(body).unwrap().solver_mut();
    let vertices = surface.topology().vertices();
    let top: Vec<VertexId> = vertices.filter(|&v| surface.position(v).y > 1.35).collect();
    for v in top {
        solver.pin(surface, v).unwrap();
    }
}

/// Returns the edge of the blade that moves through the hanging ball.
fn held(frame: u32) -> [[f32; 3]; 2] {
    let x = 2.45 + 0.006 * frame.min(180) as f32;
    [[x, 0.9, -1.0], [x, 0.92, 1.0]]
}

/// Returns the edge of the blade whose face pushes the lower ball.
fn pushing(frame: u32) -> [[f32; 3]; 2] {
    let x = -1.2 + 0.008 * frame.min(110) as f32;
    [[x, 0.0, -0.5], [x, 0.0, 0.5]]
}

/// Moves the blades of [`busy`] to their places in a frame.
pub(crate) fn move_blades(scene: &mut Scene, frame: u32) {
    let blades: Vec<_> = scene.blades().collect();
    let slice = match frame {
        10 => Some([[2.0, -1.0, 0.01], [2.0, 3.0, 0.05]]),
        160 => Some([[-2.0, -1.0, -0.09], [-2.0, 3.0, 0.12]]),
        _ => None,
    };
    if let Some(edge) = slice {
        scene.move_blade(blades[0], edge).unwrap();
    }
    scene.move_blade(blades[1], held(frame)).unwrap();
    if let Some(&blade) = blades.get(2) {
        scene.move_blade(blade, pushing(frame)).unwrap();
    }
}

/// Returns the bits of positions and velocities of all bodies.
pub(crate) fn states(scene: &Scene) -> Vec<[u32; 8]> {
    let of_body = |id| {
        let body = scene.body(id).unwrap();
        let states = body
            .surface()
            .positions()
            .iter()
            .zip(body.solver().velocities());
        states.map(|(&[x, y, z, w], &[a, b, c, d])| [x, y, z, w, a, b, c, d].map(f32::to_bits))
    };
    scene.bodies().flat_map(of_body).collect()
}
