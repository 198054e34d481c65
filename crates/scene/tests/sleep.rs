//! Bodies at rest sleep, and wake for whatever may move them; nothing is lost by it.

use incise_mesh::{Model, Surface, VertexId, build_model};
use incise_pbd_gpu::{Material, SolverParams, Stiffness};
use incise_scene::{
    BladeId, BodyId, ContactParams, FrameStats, Scene, SceneError, SceneParams, SleepParams,
};

/// Frames after which a body that is at rest from the start sleeps.
const UNTIL_ASLEEP: u32 = 10 + SleepParams::LAG;

const SLEEP: SleepParams = SleepParams {
    speed: 6e-2,
    seconds: 10.0 / 60.0,
};

/// Nothing pulls.
fn weightless() -> SceneParams {
    SceneParams {
        solver: SolverParams {
            gravity: [0.0; 3],
            ..SolverParams::default()
        },
        sleep: Some(SLEEP),
        ..SceneParams::default()
    }
}

/// A tetrahedron all of whose edges have whole numbers for lengths, so that none is off by rounding: Euler's brick.
fn exact(at: f32) -> Surface {
    let corners = [[0, 0, 0], [44, 0, 0], [0, 117, 0], [0, 0, 240]];
    let corners = corners.map(|c: [i16; 3]| c.map(|c| f32::from(c) / 256.0 + at));
    Surface::from_triangles(&corners, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap()
}

/// Edges alone.
fn edges() -> Material {
    Material {
        bending: None,
        ..Material::default()
    }
}

/// Edges that give, and friction with the air.
fn jelly() -> Material {
    Material {
        stretch: Stiffness::Compliance(1e-4),
        damping: 5.0,
        ..Material::default()
    }
}

fn bits(scene: &Scene, id: BodyId) -> Vec<[u32; 4]> {
    let body = scene.body(id);
    let all = body.surface().positions.iter();
    let all = all.chain(body.solver().velocities());
    all.map(|p| p.map(f32::to_bits)).collect()
}

fn run(scene: &mut Scene, frames: u32) {
    for _ in 0..frames {
        scene.step().unwrap();
    }
}

/// Two spheres apart that sleep, and a blade far from both.
fn sleepers() -> (Scene, [BodyId; 2], BladeId) {
    let mut scene = Scene::new(weightless());
    let ids = [0.0, 3.0].map(|x| {
        let mut surface = build_model(Model::Sphere80);
        surface.positions.iter_mut().for_each(|p| p[0] += x);
        surface.rest.iter_mut().for_each(|p| p[0] += x);
        scene.add_body(surface, &Material::default()).unwrap()
    });
    let blade = scene.add_blade([[-1.0, 0.1, -2.0], [-1.0, 0.1, 2.0]]);
    run(&mut scene, UNTIL_ASLEEP);
    let asleep = ids.map(|id| scene.is_asleep(id));
    assert_eq!(asleep, [true; 2], "both are at rest");
    (scene, ids, blade)
}

/// Asleep, fallen asleep and woken.
fn counts(stats: &FrameStats) -> [u32; 3] {
    [stats.asleep, stats.fell_asleep, stats.woken]
}

#[test]
fn a_body_at_rest_sleeps_after_so_many_frames() {
    let mut scene = Scene::new(weightless());
    let id = scene.add_body(exact(0.0), &edges()).unwrap();
    for frame in 1..UNTIL_ASLEEP {
        assert_eq!(counts(scene.step().unwrap()), [0; 3], "frame {frame}");
        assert!(!scene.is_asleep(id));
    }
    assert_eq!(counts(scene.step().unwrap()), [0, 1, 0]);
    assert!(scene.is_asleep(id));
    for _ in 0..100 {
        assert_eq!(counts(scene.step().unwrap()), [1, 0, 0]);
    }
}

#[test]
fn who_never_moves_is_where_it_is_if_it_never_sleeps() {
    let pinned = |scene: &mut Scene| {
        let id = scene
            .add_body(build_model(Model::Sphere20), &Material::default())
            .unwrap();
        let (solver, surface) = scene.edit(id).unwrap().solver_mut();
        let vertices: Vec<VertexId> = surface.topology().vertices().collect();
        for v in vertices {
            solver.pin(surface, v).unwrap();
        }
        id
    };
    let [asleep, awake] = [Some(SLEEP), None].map(|sleep| {
        let mut params = weightless();
        params.sleep = sleep;
        let mut scene = Scene::new(params);
        let free = scene.add_body(exact(0.0), &edges()).unwrap();
        // What is pinned everywhere rests under any weight.
        params.solver.gravity = [0.0, -9.81, 0.0];
        let mut heavy = Scene::new(params);
        let held = pinned(&mut heavy);
        run(&mut scene, 200);
        run(&mut heavy, 200);
        assert_eq!(scene.is_asleep(free), sleep.is_some());
        assert_eq!(heavy.is_asleep(held), sleep.is_some());
        (bits(&scene, free), bits(&heavy, held))
    });
    assert!(asleep == awake, "to the bit");
}

/// The law of sleeping: it is time that stands still. A scene that sleeps for a while and one that does not are in
/// the same states, one after the other.
#[test]
fn a_body_that_is_woken_goes_on_with_the_bits_that_it_would_have_had() {
    let settle = |sleep| {
        let mut params = weightless();
        params.sleep = sleep;
        let mut scene = Scene::new(params);
        let id = scene
            .add_body(build_model(Model::Sphere80), &jelly())
            .unwrap();
        let (_, surface) = scene.edit(id).unwrap().solver_mut();
        surface.positions[3][1] += 0.05;
        (scene, id)
    };
    let (mut scene, id) = settle(Some(SLEEP));
    let mut frames = 0;
    while !scene.is_asleep(id) {
        scene.step().unwrap();
        frames += 1;
        assert!(frames < 2000, "it comes to rest");
    }
    assert!(frames > UNTIL_ASLEEP, "it was not at rest from the start");
    let slept_in = bits(&scene, id);
    run(&mut scene, 500);
    assert!(bits(&scene, id) == slept_in, "nothing moves in its sleep");
    let (mut other, other_id) = settle(None);
    run(&mut other, frames);
    assert!(bits(&other, other_id) == slept_in);
    // What is lost is what would have moved by itself: no more than the bound.
    let mut never = bits(&other, other_id);
    scene.wake(id);
    for frame in 0..UNTIL_ASLEEP - 1 {
        assert_eq!(counts(scene.step().unwrap()), [0, 0, u32::from(frame == 0)]);
        other.step().unwrap();
        assert!(bits(&scene, id) == bits(&other, other_id), "frame {frame}");
    }
    run(&mut other, 500);
    let edge = other.body(other_id).solver().mean_rest_length();
    let substeps = f64::from(other.params.solver.substeps);
    let rounding = 2.0 * f64::from(f32::EPSILON) * substeps;
    let bound = (f64::from(SLEEP.speed) / 60.0 * edge + rounding) * f64::from(500 + UNTIL_ASLEEP);
    let now = bits(&other, other_id);
    let vertices = other.body(other_id).surface().positions.len();
    never.truncate(vertices);
    for (now, then) in now.iter().zip(&never) {
        for k in 0..3 {
            let way = f64::from(f32::from_bits(now[k])) - f64::from(f32::from_bits(then[k]));
            assert!(way.abs() <= bound, "{way} m, at most {bound}");
        }
    }
}

#[test]
fn a_body_thrown_up_does_not_fall_asleep_at_the_top() {
    let mut params = weightless();
    params.solver.gravity = [0.0, -9.81, 0.0];
    params.sleep = Some(SleepParams::default());
    let mut scene = Scene::new(params);
    let id = scene.add_body(exact(0.0), &edges()).unwrap();
    let (solver, _) = scene.edit(id).unwrap().solver_mut();
    for v in 0..4 {
        solver.set_velocity(VertexId(v), [0.0, 9.81, 0.0]).unwrap();
    }
    for frame in 0..120 {
        assert_eq!(scene.step().unwrap().fell_asleep, 0, "frame {frame}");
    }
    let height = scene.body(id).surface().positions[0][1];
    assert!(height < 0.1, "it came down again, to {height} m");
}

#[test]
fn a_body_in_slow_flight_stays_awake() {
    let mut scene = Scene::new(weightless());
    let id = scene.add_body(exact(0.0), &edges()).unwrap();
    let edge = scene.body(id).solver().mean_rest_length();
    #[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
    let edge = edge as f32;
    for (part, sleeps) in [(1.05, false), (0.95, true)] {
        let speed = SLEEP.speed * edge * part;
        let (solver, _) = scene.edit(id).unwrap().solver_mut();
        for v in 0..4 {
            solver.set_velocity(VertexId(v), [speed, 0.0, 0.0]).unwrap();
        }
        run(&mut scene, 2 * UNTIL_ASLEEP);
        assert_eq!(scene.is_asleep(id), sleeps, "at {part} of the bound");
    }
}

#[test]
fn an_edit_wakes_the_body_that_it_is_for() {
    let (mut scene, [first, second], _) = sleepers();
    let (solver, _) = scene.edit(second).unwrap().solver_mut();
    solver.set_velocity(VertexId(0), [0.0, 1.0, 0.0]).unwrap();
    assert_eq!(counts(scene.step().unwrap()), [1, 0, 1]);
    assert!(scene.is_asleep(first) && !scene.is_asleep(second));
}

#[test]
fn a_target_elsewhere_wakes_and_the_same_one_does_not() {
    let (mut scene, [first, _], _) = sleepers();
    let (solver, surface) = scene.edit(first).unwrap().solver_mut();
    solver.pin(surface, VertexId(5)).unwrap();
    let target = solver.pins()[0].target;
    run(&mut scene, UNTIL_ASLEEP);
    assert!(scene.is_asleep(first), "a pin alone moves nothing");
    scene.set_pin_target(first, VertexId(5), target).unwrap();
    assert_eq!(counts(scene.step().unwrap()), [2, 0, 0]);
    // Slower than what counts as motion, and still it is never left behind.
    for frame in 1..=3 * UNTIL_ASLEEP {
        let to = [target[0] + 1e-6 * frame as f32, target[1], target[2]];
        scene.set_pin_target(first, VertexId(5), to).unwrap();
        let stats = *scene.step().unwrap();
        assert_eq!(counts(&stats), [1, 0, u32::from(frame == 1)]);
        assert_eq!(scene.body(first).surface().positions[5][..3], to);
    }
}

#[test]
fn another_kind_of_frame_wakes_all() {
    let changes: [fn(&mut SceneParams); 6] = [
        |p| p.solver.gravity = [0.0, -1.0, 0.0],
        |p| p.solver.ground = Some(0.2),
        |p| p.solver.iterations += 1,
        |p| p.dt *= 0.5,
        |p| p.contacts = Some(ContactParams::default()),
        |p| p.sleep = None,
    ];
    for (i, change) in changes.into_iter().enumerate() {
        let (mut scene, ids, _) = sleepers();
        change(&mut scene.params);
        assert_eq!(counts(scene.step().unwrap()), [0, 0, 2], "change {i}");
        assert_eq!(ids.map(|id| scene.is_asleep(id)), [false; 2]);
    }
    // How bodies are cut is nothing to those that are not.
    let (mut scene, ..) = sleepers();
    scene.params.cut.snap = 0.0;
    scene.params.skip_far_sweeps = false;
    assert_eq!(counts(scene.step().unwrap()), [2, 0, 0]);
}

#[test]
fn a_blade_wakes_what_it_cuts_and_nothing_else() {
    let (mut scene, [first, second], blade) = sleepers();
    let move_to = |scene: &mut Scene, x: f32, y: f32| {
        scene.move_blade(blade, [[x, y, -2.0], [x, y, 2.0]]);
        *scene.step().unwrap()
    };
    // Beside both, then into the corner of a box without a touch, then through the first one.
    let far = move_to(&mut scene, -1.0, 3.0);
    assert_eq!((far.detections, far.detections_skipped), (0, 2));
    assert_eq!(counts(&far), [2, 0, 0]);
    scene.jump_blade(blade, [[-0.6, 0.45, -2.0], [-0.6, 0.45, 2.0]]);
    let graze = move_to(&mut scene, -0.4, 0.48);
    assert_eq!((graze.detections, graze.cuts, graze.hits), (1, 0, 0));
    assert_eq!(counts(&graze), [2, 0, 0]);
    scene.jump_blade(blade, [[-1.0, 0.1, -2.0], [-1.0, 0.1, 2.0]]);
    let stopped = move_to(&mut scene, 0.0, 0.1);
    assert_eq!((stopped.refused, stopped.cuts), (1, 0));
    assert_eq!(counts(&stopped), [2, 0, 0], "it is as it was");
    scene.jump_blade(blade, [[-1.0, 0.1, -2.0], [-1.0, 0.1, 2.0]]);
    let cut = move_to(&mut scene, 1.0, 0.1);
    assert_eq!(cut.cuts, 1);
    assert_eq!(counts(&cut), [1, 0, 1]);
    assert!(!scene.is_asleep(first) && scene.is_asleep(second));
    assert_eq!(scene.body(first).pieces().len(), 2);
}

#[test]
fn a_cut_in_its_sleep_is_the_cut_of_the_same_body_awake() {
    let sweep = |scene: &mut Scene, blade| {
        scene.move_blade(blade, [[1.0, 0.13, -2.0], [1.0, 0.17, 2.0]]);
        assert_eq!(scene.step().unwrap().cuts, 1);
    };
    let (mut asleep, [id, _], blade) = sleepers();
    run(&mut asleep, 50);
    sweep(&mut asleep, blade);
    let mut awake = Scene::new(SceneParams {
        sleep: None,
        ..weightless()
    });
    let other = awake
        .add_body(build_model(Model::Sphere80), &Material::default())
        .unwrap();
    let other_blade = awake.add_blade([[-1.0, 0.1, -2.0], [-1.0, 0.1, 2.0]]);
    run(&mut awake, UNTIL_ASLEEP);
    sweep(&mut awake, other_blade);
    for frame in 0..5 {
        let same = asleep.body(id).surface() == awake.body(other).surface();
        assert!(same, "surfaces differ {frame} frames after the cut");
        assert!(bits(&asleep, id) == bits(&awake, other), "frame {frame}");
        asleep.step().unwrap();
        awake.step().unwrap();
    }
}

#[test]
fn a_body_that_is_removed_in_its_sleep_is_counted_no_more() {
    let (mut scene, [first, second], _) = sleepers();
    scene.remove_body(first).unwrap();
    assert_eq!(counts(scene.step().unwrap()), [1, 0, 0]);
    scene.wake(second);
    assert_eq!(counts(scene.step().unwrap()), [0, 0, 1]);
    let third = scene.add_body(exact(9.0), &edges()).unwrap();
    assert!(!scene.is_asleep(third));
}

#[test]
fn the_skips_of_the_solver_are_counted() {
    let mut params = weightless();
    params.sleep = None;
    params.solver = SolverParams {
        residual: Some(1e-5),
        ground: Some(-5.0),
        ..params.solver
    };
    params.solver.iterations = 4;
    let mut scene = Scene::new(params);
    for at in [0.0, 2.0] {
        scene.add_body(exact(at), &edges()).unwrap();
    }
    let stats = scene.step().unwrap();
    let substeps = params.solver.substeps;
    assert_eq!(stats.iterations_skipped, 2 * substeps * 3);
    assert_eq!(stats.ground_passes_skipped, 2 * substeps);
}

/// A sphere of 80 triangles somewhere, that moves.
fn thrown(params: SceneParams, at: [f32; 3], velocity: [f32; 3]) -> (Scene, BodyId) {
    let mut surface = build_model(Model::Sphere80);
    for p in &mut surface.positions {
        (0..3).for_each(|k| p[k] += at[k]);
    }
    for p in &mut surface.rest {
        (0..3).for_each(|k| p[k] += at[k]);
    }
    let mut scene = Scene::new(params);
    let id = scene.add_body(surface, &edges()).unwrap();
    let (solver, surface) = scene.edit(id).unwrap().solver_mut();
    let vertices: Vec<VertexId> = surface.topology().vertices().collect();
    for v in vertices {
        solver.set_velocity(v, velocity).unwrap();
    }
    (scene, id)
}

#[test]
fn a_body_in_flight_stays_awake_however_short_the_frames_are() {
    for dt in [1.0 / 60.0, 1.0 / 4000.0, 1e-5] {
        for speed in [0.0, 2e-3] {
            let params = SceneParams {
                dt,
                solver: SolverParams::default(),
                ..SceneParams::default()
            };
            let (mut scene, id) = thrown(params, [0.0; 3], [0.0, speed, 0.0]);
            run(&mut scene, 200);
            assert!(
                !scene.is_asleep(id),
                "thrown at {speed} m/s, frames of {dt} s"
            );
        }
    }
}

#[test]
fn a_body_that_moves_far_from_the_origin_stays_awake() {
    for (x, speed) in [(1e2, 0.02), (1e3, 0.2), (1e4, 2.0), (1e5, 20.0)] {
        let params = SceneParams {
            sleep: Some(SleepParams::default()),
            ..weightless()
        };
        let (mut scene, id) = thrown(params, [x, 0.0, 0.0], [0.0, speed, 0.0]);
        run(&mut scene, 100);
        assert!(!scene.is_asleep(id), "{speed} m/s at {x} m");
    }
}

#[test]
fn a_clock_that_jitters_keeps_nobody_awake() {
    let mut scene = Scene::new(weightless());
    let id = scene.add_body(exact(0.0), &edges()).unwrap();
    let dt = scene.params.dt;
    for frame in 0..UNTIL_ASLEEP {
        scene.params.dt = if frame % 2 == 0 { dt * 1.1 } else { dt * 0.95 };
        scene.step().unwrap();
    }
    assert!(scene.is_asleep(id), "after {UNTIL_ASLEEP} frames");
    scene.params.dt = dt * 2.0;
    scene.step().unwrap();
    assert!(!scene.is_asleep(id), "in frames of twice the time");
}

#[test]
fn a_frame_that_is_refused_wakes_nobody() {
    let (mut scene, ids, _) = sleepers();
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
        let is_typed = matches!(error, SceneError::Frame(_) | SceneError::BadSleep { .. });
        assert!(is_typed, "{error}");
        assert!(ids.iter().all(|&id| scene.is_asleep(id)), "after {error}");
    }
    scene.params = good;
    let stats = *scene.step().unwrap();
    assert_eq!((stats.woken, stats.asleep), (0, 2));
}

#[test]
fn a_cut_that_is_undone_leaves_a_body_that_is_cut_again() {
    let (mut scene, [id, _], blade) = sleepers();
    let before = scene.body(id).surface().topology().triangle_count();
    for _ in 0..3 {
        scene.jump_blade(blade, [[-2.0, -2.0, 0.05], [2.0, -2.0, 0.05]]);
        scene.move_blade(blade, [[-2.0, 2.0, 0.05], [2.0, 2.0, 0.05]]);
        scene.step().unwrap();
        assert_eq!(scene.stats().cuts, 1, "the blade goes through one of them");
        let undo = scene.outcomes()[0].1.undo.clone().unwrap();
        let stale = undo.clone();
        scene.undo(id, undo).unwrap();
        let body = scene.body(id);
        assert_eq!(body.surface().topology().triangle_count(), before);
        assert_eq!(body.solver().validate(body.surface()), Ok(()));
        let again = scene.undo(id, stale);
        assert!(matches!(again, Err(SceneError::Undo(_))), "{again:?}");
        run(&mut scene, 2);
    }
}
