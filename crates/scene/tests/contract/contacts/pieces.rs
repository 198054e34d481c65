//! Contacts between pieces: rest, collisions, tunneling and thin plates.

use super::*;

#[test]
fn a_ball_rests_on_another_ball() {
    let ball = cube_sphere(6, 1.0);
    let body = merged(&[
        moved(&ball, [0.0, 1.0, 0.0], [1.0; 3]),
        moved(&ball, [0.02, 3.05, 0.01], [1.0; 3]),
    ]);
    for contacts in [Some(ContactParams::default()), None] {
        let params = SceneParams {
            contacts,
            ..params([0.0, -9.81, 0.0])
        };
        let mut scene = Scene::new(params);
        scene.colliders.push(Collider::ground(0.0));
        let id = scene.add_body(body.clone(), &firm(1.0, 0.0)).unwrap();
        // The upper ball rolls off eventually, but not within 0.8 s.
        for _ in 0..48 {
            scene.step().unwrap();
        }
        let [low, _] = height_range(scene.body(id).unwrap(), 1);
        let is_stopped = low > 1.0;
        assert_eq!(is_stopped, contacts.is_some(), "it is {low} m high");
        let deep = max_penetration(scene.body(id).unwrap().surface());
        assert_eq!(deep < 0.02, contacts.is_some(), "{deep} m in each other");
    }
}

#[test]
fn a_collision_conserves_momentum() {
    let ball = cube_sphere(6, 1.0);
    let body = merged(&[ball.clone(), moved(&ball, [2.5, 0.4, 0.1], [1.0; 3])]);
    let mut scene = Scene::new(params([0.0; 3]));
    let id = scene.add_body(body, &firm(0.5, 0.0)).unwrap();
    set_piece_velocity(&mut scene, id, 0, [3.0, 0.0, 0.0]);
    let solver = scene.body(id).unwrap().solver();
    let (before, energy) = (solver.momentum(), solver.kinetic_energy());
    let mut deep = 0.0_f64;
    let mut touched = 0;
    for _ in 0..60 {
        touched += scene.step().unwrap().contacts;
        deep = deep.max(max_penetration(scene.body(id).unwrap().surface()));
    }
    assert!(
        touched > 0 && deep < 0.02,
        "{touched} contacts, {deep} m deep"
    );
    let body = scene.body(id).unwrap();
    let mass = body.solver().total_mass();
    for (is, was) in body.solver().momentum().into_iter().zip(before) {
        assert!((is - was).abs() < 1e-3 * mass, "{was} became {is}");
    }
    assert!(body.solver().kinetic_energy() < energy, "none is made");
    let mut pushed = [0.0; 3];
    for v in body.surface().topology().vertices() {
        if piece_of(body.surface(), v) == 1 {
            let (velocity, mass) = (body.solver().velocity(v), body.solver().masses()[v.index()]);
            (0..3).for_each(|k| pushed[k] += velocity[k] * mass);
        }
    }
    assert!(pushed[0] > 0.5, "the other one goes on: {pushed:?}");
}

#[test]
fn a_fast_ball_does_not_tunnel_through_a_plate() {
    let ball = cube_sphere(5, 1.0);
    // A plate of a tenth of the ball's size with all vertices pinned.
    let plate = moved(&cube(8), [0.0; 3], [2.0, 0.1, 2.0]);
    for offset in [0.0, 0.13, 0.7] {
        let above = moved(&ball, [offset, 3.0, offset / 3.0], [1.0; 3]);
        let body = merged(&[plate.clone(), above]);
        let speed = 10.0 * 2.0 * 3.0_f32.sqrt();
        let mut scene = Scene::new(params([0.0; 3]));
        let id = scene.add_body(body, &firm(0.0, 0.0)).unwrap();
        pin_piece(&mut scene, id, 0);
        set_piece_velocity(&mut scene, id, 1, [0.0, -speed, 0.0]);
        let mut lowest = f32::INFINITY;
        for _ in 0..30 {
            scene.step().unwrap();
            lowest = lowest.min(height_range(scene.body(id).unwrap(), 1)[0]);
        }
        assert!(
            lowest > 0.0,
            "it came down to {lowest} m, the top being 0.1 m"
        );
    }
}

/// Regression: the upper half of a limp ball inverts at the impact and reaches the plate with its
/// normals upward. Vertices passed through, because only triangles that faced them stopped them.
#[test]
fn an_inverted_ball_does_not_pass_through_a_plate() {
    let scale = 100.0;
    let plate = moved(&cube(8), [0.0; 3], [2.0 * scale, 0.1 * scale, 2.0 * scale]);
    let ball = moved(&cube_sphere(6, 1.0), [0.0, 3.0 * scale, 0.0], [scale; 3]);
    let material = Material {
        stretch: Stiffness::Compliance(1e-5),
        volume: Some(Volume::default()),
        ..Material::default()
    };
    let mut scene = Scene::new(params([0.0; 3]));
    let id = scene.add_body(merged(&[plate, ball]), &material).unwrap();
    pin_piece(&mut scene, id, 0);
    let speed = 8.0 * 2.0 * 3.0_f32.sqrt() * scale;
    set_piece_velocity(&mut scene, id, 1, [0.0, -speed, 0.0]);
    for frame in 0..30 {
        scene.step().unwrap();
        let [low, _] = height_range(scene.body(id).unwrap(), 1);
        assert!(low > 0.0, "it came down to {low} m in frame {frame}");
    }
}

#[test]
fn a_dragged_pin_does_not_tunnel_through_a_piece() {
    let plate = moved(&cube(8), [0.0; 3], [2.0, 0.1, 2.0]);
    let above = moved(&cube_sphere(5, 1.0), [0.1, 1.4, 0.2], [1.0; 3]);
    let mut scene = Scene::new(params([0.0; 3]));
    let id = (scene.add_body(merged(&[plate, above]), &firm(0.0, 0.0))).unwrap();
    scene.step().unwrap();
    pin_piece(&mut scene, id, 1);
    let pins = scene.body(id).unwrap().solver().pins().to_vec();
    for pin in pins {
        let [x, y, z] = pin.target;
        let to = [x, y - 2.0, z];
        scene.set_pin_target(id, pin.vertex, to).unwrap();
    }
    // The pins move the whole ball, and the plate with it, 2 m down within a frame.
    for _ in 0..3 {
        scene.step().unwrap();
    }
    let [_, top] = height_range(scene.body(id).unwrap(), 0);
    let [bottom, _] = height_range(scene.body(id).unwrap(), 1);
    assert!(
        bottom < -1.0,
        "the ball is where it was dragged: {bottom} m"
    );
    assert!(
        vertical_velocity(scene.body(id).unwrap(), 0) < 0.0,
        "the plate goes before it"
    );
    assert!(top < 0.0, "its top is at {top} m");
}

/// Plates are a fifth of their edge length thick, so vertices are near both sides of the other.
///
/// Interior springs keep the sides of each plate apart; without them the plates would invert.
#[test]
fn thin_plates_rest_on_each_other() {
    for half in [0.02, 0.05] {
        let plate = moved(&cube(4), [0.0; 3], [0.5, half, 0.5]);
        let below = moved(&plate, [0.0, half + 0.03, 0.0], [1.0; 3]);
        let above = moved(&plate, [0.0, 3.0 * half + 0.06, 0.0], [1.0; 3]);
        let mut scene = Scene::new(params([0.0, -9.81, 0.0]));
        scene.colliders.push(Collider::ground(0.0));
        let material = Material {
            damping: 1.0,
            interior_springs: Some(InteriorSprings::default()),
            ..Material::default()
        };
        let body = merged(&[below, above]);
        let id = scene.add_body(body, &material).unwrap();
        let mut fastest = 0.0_f32;
        for _ in 0..180 {
            scene.step().unwrap();
            let velocities = scene.body(id).unwrap().solver().velocities().iter();
            fastest = velocities.flatten().fold(fastest, |a, c| a.max(c.abs()));
        }
        // The fall alone gives 1.1 m/s.
        assert!(fastest < 5.0, "{fastest} m/s of plates of {half} m");
    }
}

/// Returns the contacts of two balls that fall by two thirds of a meter a frame, one above the
/// other.
fn contacts_of_falling_balls(gap: f32, collider: Collider) -> usize {
    let ball = cube_sphere(6, 1.0);
    let body = merged(&[
        moved(&ball, [0.0, 1.2, 0.0], [1.0; 3]),
        moved(&ball, [0.0, 3.2 + gap, 0.0], [1.0; 3]),
    ]);
    let mut scene = Scene::new(params([0.0, -9.81, 0.0]));
    scene.colliders.push(collider);
    let id = scene.add_body(body, &firm(0.5, 0.0)).unwrap();
    for piece in [0, 1] {
        set_piece_velocity(&mut scene, id, piece, [0.0, -40.0, 0.0]);
    }
    scene.step().unwrap().contacts
}

/// The search follows relative motion: the fall itself brings no triangle into reach. A plane does
/// not change this, as it does not hold a group of pieces.
#[test]
fn pieces_that_fall_together_have_no_contacts() {
    for gap in [0.6, 1.0] {
        assert_eq!(contacts_of_falling_balls(gap, Collider::ground(0.0)), 0);
    }
}

/// A collider may stop one of two pieces that fall together, and throw it back at the other one.
#[test]
fn pieces_that_fall_onto_a_collider_reach_each_other_by_their_motion() {
    let table = Collider::Box {
        center: [0.0, -1.0, 0.0],
        half: [9.0, 1.0, 9.0],
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    };
    let contacts = |gap| contacts_of_falling_balls(gap, table);
    for gap in [0.6, 2.5] {
        assert!(
            contacts(gap) > 0,
            "{gap} m are less than twice the motion of both"
        );
    }
    assert_eq!(contacts(3.0), 0, "more than twice the motion of both");
}

#[test]
fn bars_of_one_body_rest_on_each_others_edges() {
    // Bars of 12 triangles: no vertex of one is over a face of the other.
    let bar = cube(1);
    let body = merged(&[
        moved(&bar, [0.0; 3], [0.5, 0.05, 0.05]),
        moved(&bar, [0.0, 0.13, 0.0], [0.05, 0.05, 0.5]),
    ]);
    let mut scene = Scene::new(params([0.0, -9.81, 0.0]));
    let id = scene.add_body(body, &firm(0.5, 0.0)).unwrap();
    pin_piece(&mut scene, id, 0);
    for _ in 0..60 {
        scene.step().unwrap();
    }
    let [low, _] = height_range(scene.body(id).unwrap(), 1);
    assert!(low > 0.04, "it has fallen to {low} m");
}
