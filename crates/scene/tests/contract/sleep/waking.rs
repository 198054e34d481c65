//! Edits, pin targets, parameters and cuts wake bodies; failed frames do not.

use super::*;
use incise_scene::BladeMode;

#[test]
fn an_edit_wakes_only_its_body() {
    let (mut scene, [first, second], _) = sleeping_scene();
    let (solver, _) = scene.edit(second).unwrap().solver_mut();
    solver.set_velocity(VertexId(0), [0.0, 1.0, 0.0]).unwrap();
    assert_eq!(counts(scene.step().unwrap()), [1, 0, 1]);
    assert!(scene.is_asleep(first).unwrap() && !scene.is_asleep(second).unwrap());
}

#[test]
fn a_changed_pin_target_wakes_and_the_same_one_does_not() {
    let (mut scene, [first, _], _) = sleeping_scene();
    let (solver, surface) = scene.edit(first).unwrap().solver_mut();
    solver.pin(surface, VertexId(5)).unwrap();
    let target = solver.pins()[0].target;
    run(&mut scene, UNTIL_ASLEEP);
    assert!(scene.is_asleep(first).unwrap(), "a pin alone moves nothing");
    scene.set_pin_target(first, VertexId(5), target).unwrap();
    assert_eq!(counts(scene.step().unwrap()), [2, 0, 0]);
    // Slower than the sleep speed; the body still follows its pins.
    for frame in 1..=3 * UNTIL_ASLEEP {
        let to = [target[0] + 1e-6 * frame as f32, target[1], target[2]];
        scene.set_pin_target(first, VertexId(5), to).unwrap();
        let stats = *scene.step().unwrap();
        assert_eq!(counts(&stats), [1, 0, u32::from(frame == 1)]);
        assert_eq!(scene.body(first).unwrap().surface().positions()[5][..3], to);
    }
}

#[test]
fn changed_parameters_wake_all_bodies() {
    let changes: [fn(&mut SceneParams); 5] = [
        |p| p.solver.gravity = [0.0, -1.0, 0.0],
        |p| p.solver.iterations += 1,
        |p| p.solver.substep = None,
        |p| p.contacts = Some(ContactParams::default()),
        |p| p.sleep = None,
    ];
    for (i, change) in changes.into_iter().enumerate() {
        let (mut scene, ids, _) = sleeping_scene();
        change(&mut scene.params);
        assert_eq!(counts(scene.step().unwrap()), [0, 0, 2], "change {i}");
        assert_eq!(ids.map(|id| scene.is_asleep(id).unwrap()), [false; 2]);
    }
    // Cut parameters do not affect bodies that are not cut.
    let (mut scene, ..) = sleeping_scene();
    scene.params.cut.cap_material = 7;
    scene.params.skip_far_sweeps = false;
    assert_eq!(counts(scene.step().unwrap()), [2, 0, 0]);
}

#[test]
fn a_blade_wakes_only_the_bodies_that_it_cuts() {
    let (mut scene, [first, second], blade) = sleeping_scene();
    // A sweep that ends inside is refused.
    scene.set_blade_mode(blade, BladeMode::FullSlices).unwrap();
    let move_to = |scene: &mut Scene, x: f32, y: f32| {
        scene
            .move_blade(blade, [[x, y, -2.0], [x, y, 2.0]])
            .unwrap();
        *scene.step().unwrap()
    };
    // Past both bodies, then through a corner of a bounding box only, then through the first body.
    let far = move_to(&mut scene, -1.0, 3.0);
    assert_eq!(
        (far.narrow_phase_queries, far.broad_phase_rejections),
        (0, 2)
    );
    assert_eq!(counts(&far), [2, 0, 0]);
    scene
        .teleport_blade(blade, [[-0.6, 0.45, -2.0], [-0.6, 0.45, 2.0]])
        .unwrap();
    let graze = move_to(&mut scene, -0.4, 0.48);
    assert_eq!(
        (graze.narrow_phase_queries, graze.cuts, graze.hit_triangles),
        (1, 0, 0)
    );
    assert_eq!(counts(&graze), [2, 0, 0]);
    scene
        .teleport_blade(blade, [[-1.0, 0.1, -2.0], [-1.0, 0.1, 2.0]])
        .unwrap();
    let stopped = move_to(&mut scene, 0.0, 0.1);
    assert_eq!((stopped.failed_cuts, stopped.cuts), (1, 0));
    assert_eq!(counts(&stopped), [2, 0, 0], "it is as it was");
    scene
        .teleport_blade(blade, [[-1.0, 0.1, -2.0], [-1.0, 0.1, 2.0]])
        .unwrap();
    let cut = move_to(&mut scene, 1.0, 0.1);
    assert_eq!(cut.cuts, 1);
    assert_eq!(counts(&cut), [1, 0, 1]);
    assert!(!scene.is_asleep(first).unwrap() && scene.is_asleep(second).unwrap());
    assert_eq!(scene.body(first).unwrap().pieces().len(), 2);
}

#[test]
fn an_invalid_frame_wakes_no_body() {
    let (mut scene, ids, _) = sleeping_scene();
    let good = scene.params;
    let sleep = |speed, seconds| Some(SleepParams { speed, seconds });
    for bad in [
        SceneParams { dt: 0.0, ..good },
        SceneParams {
            dt: f32::NAN,
            ..good
        },
        SceneParams {
            sleep: sleep(f32::NAN, 0.5),
            ..good
        },
        SceneParams {
            sleep: sleep(f32::INFINITY, 0.5),
            ..good
        },
        SceneParams {
            sleep: sleep(6e-3, -1.0),
            ..good
        },
    ] {
        scene.params = bad;
        let error = scene.step().unwrap_err();
        assert!(matches!(error, SceneError::Parameter(_)), "{error}");
        assert!(
            ids.iter().all(|&id| scene.is_asleep(id).unwrap()),
            "after {error}"
        );
    }
    scene.params = good;
    let stats = *scene.step().unwrap();
    assert_eq!((stats.woken, stats.sleeping_bodies), (0, 2));
}

#[test]
fn a_removed_sleeping_body_is_not_counted() {
    let (mut scene, [first, second], _) = sleeping_scene();
    scene.remove_body(first).unwrap();
    assert_eq!(counts(scene.step().unwrap()), [1, 0, 0]);
    scene.wake(second).unwrap();
    assert_eq!(counts(scene.step().unwrap()), [0, 0, 1]);
    let third = scene
        .add_body(exact_tetrahedron(9.0), &stretch_only())
        .unwrap();
    assert!(!scene.is_asleep(third).unwrap());
}
