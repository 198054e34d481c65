//! Friction on slopes, colliders, and parameters out of range.

use super::*;

/// Returns how far a block slides down a slope in half a second \[m\].
///
/// `slope` is the tangent of its angle.
fn slide_distance(friction: f32, slope: f32) -> f32 {
    let block = moved(&cube(3), [-0.5, 0.22, 0.0], [0.2; 3]);
    let plate = moved(&cube(6), [0.0, -0.1, 0.0], [2.0, 0.1, 2.0]);
    let g = 9.81 / (1.0 + slope * slope).sqrt();
    // The plate is horizontal and gravity is inclined.
    let mut scene = Scene::new(params([g * slope, -g, 0.0]));
    let id = (scene.add_body(merged(&[plate, block]), &firm(friction, 0.0))).unwrap();
    pin_piece(&mut scene, id, 0);
    // The block starts in contact: it neither falls nor recovers a distance.
    let edges = scene.body(id).unwrap().solver().stretch().batches().iter();
    let edges: Vec<f32> = edges.flat_map(|batch| batch.rest().to_vec()).collect();
    let edge = edges.iter().sum::<f32>() / edges.len() as f32;
    scene.params.contacts = Some(ContactParams {
        thickness: 0.02 / edge,
        ..ContactParams::default()
    });
    let along = |scene: &Scene| {
        let surface = scene.body(id).unwrap().surface();
        let block = of_piece(surface, 1);
        let sum: f32 = block
            .iter()
            .map(|v| surface.positions()[v.index()][0])
            .sum();
        sum / block.len() as f32
    };
    let start = along(&scene);
    for _ in 0..30 {
        scene.step().unwrap();
    }
    along(&scene) - start
}

#[test]
fn a_block_slides_where_the_slope_is_steeper_than_friction() {
    let found = slide_distance(0.5, 0.4);
    assert!(found < 0.01, "it holds, but for {found} m");
    for friction in [0.0, 0.3] {
        let slope = 0.6_f32;
        let a = 9.81 * (slope - friction) / (1.0 + slope * slope).sqrt();
        let (found, expected) = (slide_distance(friction, slope), a * 0.125);
        assert!(
            (found / expected - 1.0).abs() < 0.1,
            "{found}, not {expected} m"
        );
    }
}

#[test]
fn bodies_stay_out_of_colliders_and_sleep_on_flat_ones() {
    // A block, since a ball would roll off the round colliders.
    let block = moved(&cube(4), [0.0, 1.0, 0.0], [0.5; 3]);
    let all = [
        Collider::Plane {
            point: [0.0, 0.2, 0.0],
            normal: [0.0, 1.0, 0.0],
        },
        Collider::Box {
            center: [0.0, -0.3, 0.0],
            half: [2.0, 0.5, 2.0],
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        },
        Collider::Sphere {
            center: [0.0, -19.8, 0.0],
            radius: 20.0,
        },
        Collider::Capsule {
            ends: [[-3.0, -19.8, 0.0], [3.0, -19.8, 0.0]],
            radius: 20.0,
        },
    ];
    for collider in all {
        let mut scene = Scene::new(SceneParams {
            contacts: None,
            sleep: Some(SleepParams::default()),
            ..params([0.0, -9.81, 0.0])
        });
        // The broad phase excludes the distant collider.
        let far = Collider::Sphere {
            center: [100.0, 0.0, 0.0],
            radius: 1.0,
        };
        scene.colliders = vec![far, collider];
        // On a round collider the block rocks on a point. On a flat one it may tremble without
        // bending.
        let is_flat = matches!(collider, Collider::Plane { .. } | Collider::Box { .. });
        let material = Material {
            bending: is_flat.then_some(Stiffness::Pbd(0.2)),
            damping: 1.0,
            ..firm(1.0, 0.0)
        };
        let body = merged(std::slice::from_ref(&block));
        let id = scene.add_body(body, &material).unwrap();
        let mut lowest = f32::INFINITY;
        for frame in 0..1800 {
            scene.step().unwrap();
            assert!(scene.stats().collider_pairs <= 1, "in frame {frame}");
            lowest = lowest.min(height_range(scene.body(id).unwrap(), 0)[0]);
            if scene.is_asleep(id).unwrap() {
                break;
            }
        }
        // The corners of the block touch the ball of 20 m 12.5 mm below its top.
        assert!(lowest > 0.187, "it got to {lowest} m in {collider:?}");
        assert!(lowest < 0.21, "it has fallen: {lowest} m at {collider:?}");
        assert!(
            scene.is_asleep(id).unwrap() || !is_flat,
            "it rests on {collider:?}"
        );
        scene.colliders.clear();
        for _ in 0..30 {
            scene.step().unwrap();
        }
        let low = height_range(scene.body(id).unwrap(), 0)[0];
        assert!(low < -0.5, "it falls without the collider: {low} m");
    }
}

/// A floor that moved in one substep of a frame threw bodies at many times its speed.
#[test]
fn a_moving_floor_lifts_and_drags_at_its_speed() {
    let block = merged(&[moved(&cube(4), [0.0, 0.5, 0.0], [0.5; 3])]);
    let mut scene = Scene::new(SceneParams {
        contacts: None,
        ..params([0.0, -9.81, 0.0])
    });
    let id = scene.add_body(block, &firm(1.0, 0.0)).unwrap();
    // Up by 0.5 m at 1 m/s, then to the side by 0.5 m at 0.5 m/s.
    let (mut fastest, mut x, mut y) = (0.0_f32, 0.0, 0.0);
    for frame in 0..120 {
        match frame {
            1..=30 => y += 1.0 / 60.0,
            60.. => x += 0.5 / 60.0,
            _ => {}
        }
        scene.colliders = vec![Collider::Plane {
            point: [x, y, 0.0],
            normal: [0.0, 1.0, 0.0],
        }];
        scene.step().unwrap();
        let velocities = scene.body(id).unwrap().solver().velocities().iter();
        fastest = velocities.fold(fastest, |a, v| a.max(v[0].abs()).max(v[1].abs()));
    }
    assert!(fastest < 2.0, "a vertex moves at {fastest} m/s");
    let low = height_range(scene.body(id).unwrap(), 0)[0];
    assert!((low - 0.5).abs() < 0.02, "it is at {low} m");
    let positions = scene.body(id).unwrap().surface().positions();
    let center = positions.iter().map(|p| p[0]).sum::<f32>() / positions.len() as f32;
    assert!(
        (center - x).abs() < 0.05,
        "it is at {center} m, the floor at {x} m"
    );
}

#[test]
fn an_invalid_collider_is_an_error_before_anything_moves() {
    let mut scene = Scene::new(params([0.0, -9.81, 0.0]));
    let id = scene
        .add_body(cube_sphere(3, 0.5), &firm(0.5, 0.0))
        .unwrap();
    let far = |radius| Collider::Sphere {
        center: [1e3; 3],
        radius,
    };
    scene.colliders = vec![far(1.0), far(f32::NAN)];
    let error = scene.step().unwrap_err();
    assert!(error.to_string().contains("collider 1"), "{error}");
    assert_eq!(scene.body(id).unwrap().solver().kinetic_energy(), 0.0);
    scene.colliders.pop();
    scene.step().unwrap();
}

#[test]
fn a_thickness_out_of_range_is_an_error() {
    for thickness in [0.0, -1.0, f32::NAN] {
        let contacts = ContactParams {
            thickness,
            ..ContactParams::default()
        };
        let mut scene = Scene::new(SceneParams {
            contacts: Some(contacts),
            ..SceneParams::default()
        });
        let error = scene.step().unwrap_err().to_string();
        let range = "it must be above 0 and at most 100";
        assert_eq!(error, format!("contacts.thickness is {thickness}; {range}"));
    }
}
