//! A body that slept continues with the same bits as one that stayed awake.

use super::*;

fn bits(scene: &Scene, id: BodyId) -> Vec<[u32; 4]> {
    let body = scene.body(id).unwrap();
    let all = body.surface().positions().iter();
    let all = all.chain(body.solver().velocities());
    all.map(|p| p.map(f32::to_bits)).collect()
}

/// Returns the change of the last frame's first cut.
fn outcome(scene: &Scene) -> &CutOutcome {
    let mut cuts = scene.cuts().iter();
    &cuts.find_map(|sweep| sweep.cut.as_ref()).unwrap().1
}

#[test]
fn a_pinned_body_has_the_same_bits_asleep_and_awake() {
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
        let free = scene
            .add_body(exact_tetrahedron(0.0), &stretch_only())
            .unwrap();
        // A body with all vertices pinned is at rest under any gravity.
        params.solver.gravity = [0.0, -9.81, 0.0];
        let mut heavy = Scene::new(params);
        let held = pinned(&mut heavy);
        run(&mut scene, 200);
        run(&mut heavy, 200);
        assert_eq!(scene.is_asleep(free).unwrap(), sleep.is_some());
        assert_eq!(heavy.is_asleep(held).unwrap(), sleep.is_some());
        (bits(&scene, free), bits(&heavy, held))
    });
    assert!(asleep == awake, "to the bit");
}

/// A scene that sleeps for a while passes through the same states as one that does not.
#[test]
fn a_woken_body_continues_with_the_same_bits() {
    let settle = |sleep| {
        let mut params = weightless();
        params.sleep = sleep;
        let mut scene = Scene::new(params);
        let id = scene
            .add_body(build_model(Model::Sphere80), &soft_damped())
            .unwrap();
        let (_, surface) = scene.edit(id).unwrap().solver_mut();
        surface.positions_mut()[3][1] += 0.05;
        (scene, id)
    };
    let (mut scene, id) = settle(Some(SLEEP));
    let mut frames = 0;
    while !scene.is_asleep(id).unwrap() {
        scene.step().unwrap();
        frames += 1;
        assert!(frames < 2000, "it comes to rest");
    }
    assert!(frames > UNTIL_ASLEEP, "it was not at rest from the start");
    let slept_in = bits(&scene, id);
    run(&mut scene, 500);
    assert!(
        bits(&scene, id) == slept_in,
        "a sleeping body does not move"
    );
    let (mut other, other_id) = settle(None);
    run(&mut other, frames);
    assert!(bits(&other, other_id) == slept_in);
    // Sleep suppresses only motion that would have stayed below the bound.
    let mut never = bits(&other, other_id);
    scene.wake(id).unwrap();
    for frame in 0..UNTIL_ASLEEP - 1 {
        assert_eq!(counts(scene.step().unwrap()), [0, 0, u32::from(frame == 0)]);
        other.step().unwrap();
        assert!(bits(&scene, id) == bits(&other, other_id), "frame {frame}");
    }
    run(&mut other, 500);
    let solver = other.body(other_id).unwrap().solver();
    let (edge, substeps) = (solver.mean_rest_length(), f64::from(solver.substeps()));
    let rounding = 2.0 * f64::from(f32::EPSILON) * substeps;
    let bound = (f64::from(SLEEP.speed) / 60.0 * edge + rounding) * f64::from(500 + UNTIL_ASLEEP);
    let now = bits(&other, other_id);
    let vertices = other.body(other_id).unwrap().surface().positions().len();
    never.truncate(vertices);
    for (now, then) in now.iter().zip(&never) {
        for k in 0..3 {
            let way = f64::from(f32::from_bits(now[k])) - f64::from(f32::from_bits(then[k]));
            assert!(way.abs() <= bound, "{way} m, at most {bound}");
        }
    }
}

#[test]
fn a_sleeping_body_is_cut_like_an_awake_one() {
    let sweep = |scene: &mut Scene, blade| {
        scene
            .move_blade(blade, [[1.0, 0.13, -2.0], [1.0, 0.17, 2.0]])
            .unwrap();
        assert_eq!(scene.step().unwrap().cuts, 1);
    };
    let (mut asleep, [id, _], blade) = sleeping_scene();
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
        let same = asleep.body(id).unwrap().surface() == awake.body(other).unwrap().surface();
        assert!(same, "surfaces differ {frame} frames after the cut");
        assert!(bits(&asleep, id) == bits(&awake, other), "frame {frame}");
        asleep.step().unwrap();
        awake.step().unwrap();
    }
}

#[test]
fn a_body_is_cut_again_after_an_undo() {
    let (mut scene, [id, _], blade) = sleeping_scene();
    let before = scene
        .body(id)
        .unwrap()
        .surface()
        .topology()
        .triangle_count();
    for _ in 0..3 {
        scene
            .teleport_blade(blade, [[-2.0, -2.0, 0.05], [2.0, -2.0, 0.05]])
            .unwrap();
        scene
            .move_blade(blade, [[-2.0, 2.0, 0.05], [2.0, 2.0, 0.05]])
            .unwrap();
        scene.step().unwrap();
        assert_eq!(scene.stats().cuts, 1, "the blade goes through one of them");
        let undo = outcome(&scene).undo.clone().unwrap();
        let stale = undo.clone();
        scene.undo(id, undo).unwrap();
        let body = scene.body(id).unwrap();
        assert_eq!(body.surface().topology().triangle_count(), before);
        assert_eq!(body.solver().validate(body.surface()), Ok(()));
        let again = scene.undo(id, stale);
        assert!(matches!(again, Err(SceneError::Undo(_))), "{again:?}");
        run(&mut scene, 2);
    }
}

#[test]
fn skipped_iterations_are_counted() {
    let mut params = weightless();
    params.sleep = None;
    params.solver = SolverParams {
        residual: Some(1e-5),
        ..params.solver
    };
    params.solver.iterations = 4;
    let mut scene = Scene::new(params);
    let [id, _] = [0.0, 2.0].map(|at| {
        let body = scene.add_body(exact_tetrahedron(at), &stretch_only());
        body.unwrap()
    });
    let stats = *scene.step().unwrap();
    let substeps = scene.body(id).unwrap().solver().substeps();
    assert_eq!(stats.iterations_skipped, 2 * substeps * 3);
}
