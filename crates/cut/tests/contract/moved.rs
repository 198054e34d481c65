//! Cuts of surfaces that have moved since the BVH was fitted: bit for bit those after a refit.

use incise_cut::{CutParams, Cutter, Incision, Sweep};
use incise_mesh::{Surface, cube_sphere, icosphere, torus};

/// Turns a body about the vertical axis, and bends it.
fn turn(body: &mut Surface, angle: f32, bend: f32) {
    let (sin, cos) = angle.sin_cos();
    for p in body.positions_mut() {
        let [x, y, z, w] = *p;
        *p = [cos * x + sin * z + bend * y * y, y, cos * z - sin * x, w];
    }
}

fn bodies() -> [Surface; 4] {
    [
        icosphere(4, 0.5),
        cube_sphere(20, 0.5),
        torus(0.35, 0.15, 48, 24),
        icosphere(1, 0.5),
    ]
}

#[test]
fn steps_in_a_moving_body_do_not_depend_on_refits() {
    let strokes = [
        // Along an axis, oblique, and with an end in the body.
        ([[-0.7, 0.02, -0.8], [-0.7, 0.02, 0.8]], [0.07, 0.0, 0.0]),
        ([[-0.9, -0.6, -0.5], [0.3, 0.5, -0.9]], [0.05, -0.01, 0.08]),
        ([[-0.7, 0.1, 0.0], [-0.7, 0.8, 0.03]], [0.07, 0.0, 0.004]),
    ];
    let (mut cuts, mut refits) = (0, 0);
    for whole in bodies() {
        for ((from, motion), bend) in strokes.into_iter().zip([0.0, 0.004, 0.004]) {
            // One is refitted before each step, one never, and one now and then.
            let mut runs = [0; 3].map(|_| {
                let body = whole.clone();
                (Cutter::new(&body), body, Incision::default())
            });
            for step in 0..24_u16 {
                let pose = from.map(|p| [0, 1, 2].map(|k| p[k] + motion[k] * f32::from(step)));
                let outcomes = [0, 1, 2].map(|run: u16| {
                    let (cutter, body, incision) = &mut runs[usize::from(run)];
                    if run == 0 || run == 2 && step % 5 == 0 {
                        cutter.refit(body);
                        cutter.bvh().validate(body).unwrap();
                        refits += 1;
                    }
                    let outcome = cutter.advance(body, incision, &pose, &CutParams::default());
                    if outcome.is_err() {
                        incision.restart(&pose);
                    }
                    outcome.map(|outcome| outcome.delta)
                });
                cuts += usize::from(matches!(&outcomes[0], Ok(delta) if !delta.is_empty()));
                for run in 1..3 {
                    assert_eq!(outcomes[run], outcomes[0], "step {step}");
                    assert!(runs[run].1 == runs[0].1, "step {step}");
                    assert_eq!(runs[run].2, runs[0].2, "step {step}");
                }
                for (_, body, _) in &mut runs {
                    turn(body, 0.02, bend);
                }
            }
            for (mut cutter, body, _) in runs {
                cutter.refit(&body);
                cutter.bvh().validate(&body).unwrap();
            }
        }
    }
    assert!(cuts > 60, "only {cuts} steps cut");
    assert!(refits > 0);
}

#[test]
fn slices_of_a_moving_body_do_not_depend_on_refits() {
    for whole in bodies() {
        let mut runs = [0; 2].map(|_| (Cutter::new(&whole), whole.clone()));
        let mut undos = [Vec::new(), Vec::new()];
        for i in 0..10_u8 {
            let height = 0.06 * f64::from(i) - 0.3;
            let normal = [0.3 * f64::from(i % 3), 1.0, 0.2];
            let sweep = Sweep::from_plane(normal, height, &runs[0].1.bounds()).unwrap();
            for (run, (cutter, body)) in runs.iter_mut().enumerate() {
                turn(body, 0.1, 0.01);
                if run == 0 {
                    cutter.refit(body);
                }
                let outcome = cutter.cut(body, &sweep, &CutParams::default()).unwrap();
                undos[run].push(outcome.undo);
            }
            assert!(runs[0].1 == runs[1].1, "cut {i}");
            if i % 4 == 3 {
                for (run, (cutter, body)) in runs.iter_mut().enumerate() {
                    if let Some(undo) = undos[run].pop().unwrap() {
                        let _ = cutter.undo(body, undo).unwrap();
                    }
                }
                assert!(runs[0].1 == runs[1].1, "undo {i}");
            }
        }
        for (mut cutter, body) in runs {
            cutter.refit(&body);
            cutter.bvh().validate(&body).unwrap();
            assert_eq!(cutter.bvh().bounds(), body.bounds());
        }
    }
}
