//! Contacts between the halves of a cut: they separate slowly and gain no energy.

use super::*;

#[test]
fn halves_of_a_cut_separate_slowly() {
    let mut scene = Scene::new(params([0.0; 3]));
    let id = scene
        .add_body(cube_sphere(8, 1.0), &firm(0.5, 0.0))
        .unwrap();
    let blade = scene.add_blade([[-2.0, 0.1, -2.0], [-2.0, 0.1, 2.0]]);
    scene.step().unwrap();
    assert_eq!(scene.stats().contact_searches, 0, "it is in one piece");
    scene
        .move_blade(blade, [[2.0, 0.1, -2.0], [2.0, 0.1, 2.0]])
        .unwrap();
    scene.step().unwrap();
    assert!(scene.stats().contacts > 100, "caps lie on each other");
    let mut fastest = 0.0_f32;
    for _ in 0..60 {
        scene.step().unwrap();
        let [upper, lower] = [0, 1].map(|piece| vertical_velocity(scene.body(id).unwrap(), piece));
        fastest = fastest.max((upper - lower).abs());
    }
    // The speed is too low to rise by a contact thickness under gravity.
    let thickness = 0.1 * scene.body(id).unwrap().solver().mean_rest_length();
    let most = (2.0 * 9.81 * thickness).sqrt();
    assert!(
        f64::from(fastest) < most,
        "thrown apart by {fastest} of {most} m/s"
    );
    let surface = scene.body(id).unwrap().surface();
    assert!(max_penetration(surface) < 1e-3);
    let [lower, upper] = [0, 1].map(|piece| height_range(scene.body(id).unwrap(), piece));
    let between = f64::from(lower[0].max(upper[0]) - lower[1].min(upper[1]));
    assert!(between > 0.9 * thickness, "{between} m apart");
}

/// The halves of a ball roll on each other and on the ground without exceeding the fall's speed.
#[test]
fn rolling_halves_gain_no_speed() {
    for i in 0..6 {
        let mut scene = Scene::new(params([0.0, -9.81, 0.0]));
        scene.colliders.push(Collider::ground(-1.0));
        let material = Material {
            damping: 1.0,
            ..firm(0.5, 0.0)
        };
        let id = scene.add_body(cube_sphere(8, 0.5), &material).unwrap();
        let y = 0.013 + 0.011 * i as f32;
        let blade = scene.add_blade([[-2.0, y, -2.0], [-2.0, y + 0.1, 2.0]]);
        scene
            .move_blade(blade, [[2.0, y, -2.0], [2.0, y + 0.1, 2.0]])
            .unwrap();
        let mut fastest = 0.0_f32;
        for _ in 0..240 {
            scene.step().unwrap();
            let velocities = scene.body(id).unwrap().solver().velocities().iter();
            fastest = velocities.flatten().fold(fastest, |a, c| a.max(c.abs()));
        }
        assert!(fastest < 10.0, "{fastest} m/s after a cut at {y} m");
    }
}
