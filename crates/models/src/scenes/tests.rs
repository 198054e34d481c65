//! Every named scene, and the shapes of their bodies.

use super::*;
use std::collections::BTreeSet;

#[test]
fn every_scene_has_a_name_of_its_own_and_moves() {
    let names: BTreeSet<&str> = SCENES.iter().map(|scene| scene.name).collect();
    assert_eq!(names.len(), SCENES.len(), "{names:?}");
    for named in SCENES {
        let mut scripted = (named.build)(&BackendRequest::default()).unwrap();
        let positions = |scene: &Scene| {
            let of = |body| scene.body(body).unwrap().surface().positions().to_vec();
            scene.bodies().map(of).collect::<Vec<_>>()
        };
        let before = positions(&scripted.scene);
        let mut after = before.clone();
        // The plates reach the bunny in frame 12.
        for frame in 0..13 {
            scripted.step().unwrap();
            after = positions(&scripted.scene);
            if frame >= 2 && before != after {
                break;
            }
        }
        assert!(scripted.scene.failed_cuts().is_empty(), "{}", named.name);
        assert!(before != after, "{} moves", named.name);
        let mut all = after.iter().flatten().flatten();
        assert!(all.all(|c| c.is_finite()), "{}", named.name);
    }
    assert!(find("knot").is_some() && find("not").is_none());
}

#[test]
fn boxes_and_tubes_are_closed_and_have_their_volumes() {
    let plate = cuboid([1.0, 0.1, 2.0], [3, 1, 4]);
    assert!((plate.volume() - 0.2).abs() < 1e-6, "{}", plate.volume());
    assert_eq!(cuboid([1.0; 3], [1; 3]).topology().triangle_count(), 12);
    let line: Vec<Vec3> = (0..9).map(|i| Vec3::new(f64::from(i), 0.0, 0.0)).collect();
    let tube = solids::tube(&line, 0.1, 6);
    let hexagon = 1.5 * 3.0_f64.sqrt() * 0.01;
    assert!(
        (tube.volume() - 8.0 * hexagon).abs() < 1e-6,
        "{}",
        tube.volume()
    );
    assert!(tube.topology().is_closed() && plate.topology().is_closed());
}
