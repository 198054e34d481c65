//! Contacts within a piece: its sides do not hold each other where it is crushed or inverted.

use super::params;
use incise_mesh::{Surface, VertexId, icosphere};
use incise_models::scenes::sprung;
use incise_scene::{BodyId, ContactParams, Scene};

/// Returns a weightless scene with self-collision, in which a body is scaled along y.
fn scaled(surface: Surface, scale: f32) -> (Scene, BodyId) {
    let mut params = params([0.0; 3]);
    params.contacts = Some(ContactParams {
        self_collision: true,
        ..ContactParams::default()
    });
    let mut scene = Scene::new(params);
    let id = scene.add_body(surface, &sprung()).unwrap();
    let (_, surface) = scene.edit(id).unwrap().solver_mut();
    for p in surface.positions_mut() {
        p[1] *= scale;
    }
    (scene, id)
}

/// Returns a ball of 0.1 m whose surface is the wall of a cavity.
fn cavity() -> Surface {
    let ball = icosphere(3, 0.1);
    let topology = ball.topology();
    let reversed = |[a, b, c]: [VertexId; 3]| [a.0, c.0, b.0];
    let faces: Vec<_> = (topology.triangles())
        .map(|t| reversed(topology.triangle(t)))
        .collect();
    Surface::from_triangles(ball.rest_positions(), &faces).unwrap()
}

/// Regression: it kept -0.46 to 0.24 of its volume, because the sides of an inverted piece face
/// each other like those of a fold.
#[test]
fn an_inverted_ball_recovers() {
    for subdivisions in [2, 3] {
        let rest = icosphere(subdivisions, 0.1).volume();
        for scale in [0.0, -0.1, -0.3] {
            let (mut scene, id) = scaled(icosphere(subdivisions, 0.1), scale);
            for _ in 0..240 {
                scene.step().unwrap();
            }
            let volume = scene.body(id).unwrap().surface().volume() / rest;
            assert!((volume - 1.0).abs() < 1e-3, "{scale}: {volume} is left");
        }
    }
}

#[test]
fn the_sides_of_a_cavity_touch_and_those_of_a_ball_do_not() {
    for (surface, touches) in [(icosphere(3, 0.1), false), (cavity(), true)] {
        let (mut scene, _) = scaled(surface, 0.005);
        scene.step().unwrap();
        let contacts = scene.stats().contacts;
        assert_eq!(contacts > 0, touches, "{contacts} contacts");
    }
}
