//! Blades that move on from frame to frame.

use incise_cut::{CutError, CutMethod, CutParams, Cutter, ExactParams, Incision};
use incise_mesh::{Surface, Vec3, cube_sphere, icosphere, torus};
use std::collections::BTreeMap;

fn params(snap: f64) -> CutParams {
    CutParams {
        method: CutMethod::Exact(ExactParams {
            snap,
            ..ExactParams::default()
        }),
        ..CutParams::default()
    }
}

fn check(surface: &Surface) -> i64 {
    surface.validate().unwrap();
    let topology = surface.topology();
    assert!(topology.is_closed(), "the surface is open");
    let mut edges = BTreeMap::new();
    for t in topology.triangles() {
        let [a, b, c] = topology.triangle(t);
        for (v, w) in [(a, b), (b, c), (c, a)] {
            *edges.entry((v.min(w), v.max(w))).or_insert(0) += 1;
        }
    }
    for (edge, count) in &edges {
        assert_eq!(*count, 2, "{edge:?} has {count} triangles");
    }
    let count = |n: usize| i64::try_from(n).unwrap();
    count(topology.vertex_count()) - count(edges.len()) + count(topology.triangle_count())
}

/// Advances a blade of two points in equal steps. Returns the pieces' volumes, ascending.
fn advance(
    whole: &Surface,
    from: [[f32; 3]; 2],
    to: [[f32; 3]; 2],
    steps: u16,
    snap: f64,
) -> (Surface, Incision) {
    let mut body = whole.clone();
    let mut cutter = Cutter::new(&body);
    let mut incision = Incision::default();
    for i in 0..=steps {
        let s = f32::from(i) / f32::from(steps);
        let at = |k: usize| [0, 1, 2].map(|c| from[k][c] + (to[k][c] - from[k][c]) * s);
        let outcome = cutter.advance(&mut body, &mut incision, &[at(0), at(1)], &params(snap));
        let _ = outcome.unwrap_or_else(|error| panic!("step {i}: {error}"));
        check(&body);
        cutter.bvh().validate(&body).unwrap();
    }
    (body, incision)
}

#[test]
fn a_blade_in_steps_cuts_a_ball_in_two() {
    let whole = icosphere(4, 0.5);
    for snap in [0.0, 0.1] {
        for steps in [1, 2, 3, 7, 20] {
            let (body, incision) = advance(
                &whole,
                [[-0.8, 0.01, -1.0], [-0.8, 0.02, 1.0]],
                [[0.8, 0.01, -1.0], [0.8, 0.02, 1.0]],
                steps,
                snap,
            );
            assert!(!incision.is_inside());
            assert_eq!(check(&body), 4, "{steps} steps");
            let volumes = body.piece_volumes();
            assert_eq!(volumes.len(), 2);
            let error = (volumes.iter().sum::<f64>() - whole.volume()).abs() / whole.volume();
            assert!(error < if snap == 0.0 { 1e-6 } else { 2e-3 }, "{error}");
        }
    }
}

#[test]
#[ignore]
fn survey() {
    let bodies = [
        icosphere(3, 0.5),
        torus(0.35, 0.15, 32, 16),
        cube_sphere(6, 0.5),
        icosphere(4, 0.5),
    ];
    let mut seed = 12345u64;
    let mut random = || {
        seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((seed >> 33) as f64 / (1u64 << 31) as f64) as f32
    };
    let (mut runs, mut steps_done, mut failures) = (0, 0, BTreeMap::<String, usize>::new());
    for case in 0..600 {
        let whole = &bodies[case % 4];
        let mut r = |s: f32| (2.0 * random() - 1.0) * s;
        let half = 0.15 + (r(1.0) + 1.0) * 0.4;
        let (y, z, tilt, turn, drop) = (r(0.3), r(0.3), r(0.3), r(0.5), r(0.2));
        let steps = 3 + (r(1.0) * 10.0).abs() as u16;
        let move_body = case % 3 == 2;
        let mut body = whole.clone();
        let mut cutter = Cutter::new(&body);
        let mut incision = Incision::default();
        runs += 1;
        for i in 0..=steps {
            let s = f32::from(i) / f32::from(steps);
            let x = -0.9 + 1.8 * s;
            let (c, t) = ((turn * s).cos(), (turn * s).sin());
            let at = |e: f32| [x + e * half * t, y + drop * s + e * tilt, z + e * half * c];
            let result = cutter.advance(
                &mut body,
                &mut incision,
                &[at(-1.0), at(1.0)],
                &params(if case % 2 == 0 { 0.1 } else { 0.0 }),
            );
            match result {
                Ok(_) => {
                    steps_done += 1;
                }
                Err(error) => {
                    *failures.entry(format!("{error:.60}")).or_insert(0) += 1;
                    if std::env::var("SHOW").is_ok() {
                        println!("case {case} step {i}/{steps}: {error}");
                    }
                    incision.restart(&[at(-1.0), at(1.0)]);
                }
            }
            let r = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| check(&body)));
            if r.is_err() {
                println!("case {case} step {i}");
                std::panic::resume_unwind(r.unwrap_err());
            }
            if move_body {
                for q in body.positions_mut() {
                    let (x, z) = (q[0], q[2]);
                    q[1] += 0.01 * (3.0 * x).sin();
                    q[0] += 0.005 * (4.0 * z).cos();
                    q[2] *= 1.005;
                }
                cutter.refit(&body);
            }
        }
    }
    println!("{runs} runs, {steps_done} steps, {failures:?}");
}
