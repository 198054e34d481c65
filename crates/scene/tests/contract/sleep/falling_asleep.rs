//! Bodies at rest fall asleep, moving ones do not.

use super::*;

/// Returns a scene with a sphere of 80 triangles that moves.
fn moving_sphere(params: SceneParams, at: [f32; 3], velocity: [f32; 3]) -> (Scene, BodyId) {
    let mut surface = build_model(Model::Sphere80);
    for p in surface.positions_mut() {
        (0..3).for_each(|k| p[k] += at[k]);
    }
    for p in surface.rest_positions_mut() {
        (0..3).for_each(|k| p[k] += at[k]);
    }
    let mut scene = Scene::new(params);
    let id = scene.add_body(surface, &stretch_only()).unwrap();
    let (solver, surface) = scene.edit(id).unwrap().solver_mut();
    let vertices: Vec<VertexId> = surface.topology().vertices().collect();
    for v in vertices {
        solver.set_velocity(v, velocity).unwrap();
    }
    (scene, id)
}

#[test]
fn a_body_at_rest_falls_asleep_after_the_observed_frames() {
    let mut scene = Scene::new(weightless());
    let id = scene
        .add_body(exact_tetrahedron(0.0), &stretch_only())
        .unwrap();
    for frame in 1..UNTIL_ASLEEP {
        assert_eq!(counts(scene.step().unwrap()), [0; 3], "frame {frame}");
        assert!(!scene.is_asleep(id).unwrap());
    }
    assert_eq!(counts(scene.step().unwrap()), [0, 1, 0]);
    assert!(scene.is_asleep(id).unwrap());
    for _ in 0..100 {
        assert_eq!(counts(scene.step().unwrap()), [1, 0, 0]);
    }
}

#[test]
fn a_body_at_the_top_of_its_flight_stays_awake() {
    let mut params = weightless();
    params.solver.gravity = [0.0, -9.81, 0.0];
    params.sleep = Some(SleepParams::default());
    let mut scene = Scene::new(params);
    let id = scene
        .add_body(exact_tetrahedron(0.0), &stretch_only())
        .unwrap();
    let (solver, _) = scene.edit(id).unwrap().solver_mut();
    for v in 0..4 {
        solver.set_velocity(VertexId(v), [0.0, 9.81, 0.0]).unwrap();
    }
    for frame in 0..120 {
        assert_eq!(scene.step().unwrap().fell_asleep, 0, "frame {frame}");
    }
    let height = scene.body(id).unwrap().surface().positions()[0][1];
    assert!(height < 0.1, "it came down again, to {height} m");
}

#[test]
fn a_body_in_slow_flight_stays_awake() {
    let mut scene = Scene::new(weightless());
    let id = scene
        .add_body(exact_tetrahedron(0.0), &stretch_only())
        .unwrap();
    let edge = scene.body(id).unwrap().solver().mean_rest_length();
    #[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
    let edge = edge as f32;
    for (part, sleeps) in [(1.05, false), (0.95, true)] {
        let speed = SLEEP.speed * edge * part;
        let (solver, _) = scene.edit(id).unwrap().solver_mut();
        for v in 0..4 {
            solver.set_velocity(VertexId(v), [speed, 0.0, 0.0]).unwrap();
        }
        run(&mut scene, 2 * UNTIL_ASLEEP);
        assert_eq!(
            scene.is_asleep(id).unwrap(),
            sleeps,
            "at {part} of the bound"
        );
    }
}

#[test]
fn a_falling_body_stays_awake_in_short_frames() {
    for dt in [1.0 / 60.0, 1.0 / 4000.0, 1e-5] {
        for speed in [0.0, 2e-3] {
            let params = SceneParams {
                dt,
                solver: SolverParams::default(),
                ..SceneParams::default()
            };
            let (mut scene, id) = moving_sphere(params, [0.0; 3], [0.0, speed, 0.0]);
            run(&mut scene, 200);
            assert!(
                !scene.is_asleep(id).unwrap(),
                "moving_sphere at {speed} m/s, frames of {dt} s"
            );
        }
    }
}

#[test]
fn a_slow_body_far_from_the_origin_stays_awake() {
    for (x, speed) in [(1e2, 0.02), (1e3, 0.2), (1e4, 2.0), (1e5, 20.0)] {
        let params = SceneParams {
            sleep: Some(SleepParams::default()),
            ..weightless()
        };
        let (mut scene, id) = moving_sphere(params, [x, 0.0, 0.0], [0.0, speed, 0.0]);
        run(&mut scene, 100);
        assert!(!scene.is_asleep(id).unwrap(), "{speed} m/s at {x} m");
    }
}

#[test]
fn frames_of_any_time_are_observed_for_the_same_time() {
    let mut scene = Scene::new(weightless());
    let id = scene
        .add_body(exact_tetrahedron(0.0), &stretch_only())
        .unwrap();
    let times = [60.0, 30.0, 240.0, 144.0, 20.0].map(|rate: f32| rate.recip());
    let sleep = scene.params.sleep.unwrap();
    let (mut time, mut more) = (0.0, 0);
    for dt in times.into_iter().cycle() {
        scene.params.dt = dt;
        scene.step().unwrap();
        more += u32::from(time >= f64::from(sleep.seconds));
        time += f64::from(dt);
        let is_over = more == SleepParams::LAG;
        assert_eq!(scene.is_asleep(id).unwrap(), is_over, "after {time} s");
        if is_over {
            break;
        }
    }
    for dt in times {
        scene.params.dt = dt;
        assert_eq!(counts(scene.step().unwrap()), [1, 0, 0], "frames of {dt} s");
    }
}

#[test]
fn jittering_substeps_wake_no_body() {
    let mut params = weightless();
    params.solver.substep = None;
    let mut scene = Scene::new(params);
    let id = scene
        .add_body(exact_tetrahedron(0.0), &stretch_only())
        .unwrap();
    let dt = scene.params.dt;
    for frame in 0..UNTIL_ASLEEP {
        scene.params.dt = if frame % 2 == 0 { dt * 1.1 } else { dt * 0.95 };
        scene.step().unwrap();
    }
    assert!(scene.is_asleep(id).unwrap(), "after {UNTIL_ASLEEP} frames");
    scene.params.dt = dt * 2.0;
    scene.step().unwrap();
    assert!(
        !scene.is_asleep(id).unwrap(),
        "in substeps of twice the time"
    );
}
