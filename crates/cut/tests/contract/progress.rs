//! Blades that move on from frame to frame.

use crate::common::{check, check_manifold, params};
use incise_cut::{CutError, Cutter, Incision, Sweep};
use incise_mesh::{Surface, cube_sphere, icosphere, sheet, torus};
use proptest::prelude::*;

/// Advances a blade of two points in equal steps.
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
fn a_blade_that_stands_or_trembles_changes_nothing() {
    let mut body = icosphere(4, 0.5);
    let mut cutter = Cutter::new(&body);
    let mut incision = Incision::default();
    let pose = |x: f32| [[x, 0.01, -1.0], [x, 0.02, 1.0]];
    for x in [-0.8, -0.3, 0.0] {
        let outcome = cutter.advance(&mut body, &mut incision, &pose(x), &params(0.1));
        assert_eq!(outcome.unwrap().is_miss(), x == -0.8);
    }
    assert!(incision.is_inside());
    let before = (body.clone(), incision.clone());
    for x in [0.0, 0.001, -0.001, 0.0] {
        let outcome = cutter.advance(&mut body, &mut incision, &pose(x), &params(0.1));
        assert!(outcome.unwrap().is_miss());
        assert_eq!((&body, &incision), (&before.0, &before.1));
    }
}

#[test]
fn every_step_can_be_undone() {
    let mut body = torus(0.35, 0.15, 32, 16);
    let mut cutter = Cutter::new(&body);
    let mut incision = Incision::default();
    let mut undos = Vec::new();
    for i in 0u8..12 {
        let x = -0.6 + 0.1 * f32::from(i);
        let before = (body.clone(), incision.clone());
        let pose = [[x, 0.03, -0.7], [x, -0.02, 0.4]];
        let outcome = cutter.advance(&mut body, &mut incision, &pose, &params(0.1));
        if let Some(undo) = outcome.unwrap().undo {
            undos.push((undo, before));
        }
    }
    assert!(undos.len() > 5);
    while let Some((undo, (before, tip))) = undos.pop() {
        let _ = cutter.undo(&mut body, undo).unwrap();
        assert_eq!(body, before);
        incision = tip;
    }
    assert!(!incision.is_inside());
}

proptest! {
    /// Blades of any length that turn as they pass, through bodies that move meanwhile, leave
    /// closed surfaces of the same volume. A step is refused only at the walls of the incision,
    /// where its tip is on the surface, or where the blade is in the body without touching it.
    #[test]
    fn blades_in_motion_keep_the_surface_closed(
        body in 0usize..5,
        noise in prop::sample::select(vec![0.0, 0.0, 0.04]),
        half in 0.15f32..0.95,
        (y, z, tilt) in (-0.3f32..0.3, -0.3f32..0.3, -0.3f32..0.3),
        (turn, drop) in (-0.5f32..0.5, -0.2f32..0.2),
        steps in 3u16..13,
        is_moving in any::<bool>(),
        snap in prop::sample::select(vec![0.0, 0.1]),
    ) {
        let bodies = [
            icosphere(3, 0.5),
            torus(0.35, 0.15, 32, 16),
            cube_sphere(6, 0.5),
            cube_sphere(1, 0.5),
            icosphere(0, 0.5),
        ];
        let mut body = bodies[body].clone();
        // So much noise makes bodies of small triangles intersect themselves.
        for (i, p) in (0u16..).zip(body.positions_mut()) {
            let wave = |k: u16| (f32::from(i) * f32::from(7 * k + 5)).sin();
            (0..3).for_each(|k| p[k] += noise * wave(u16::try_from(k).unwrap()));
        }
        let mut cutter = Cutter::new(&body);
        let mut incision = Incision::default();
        for i in 0..=steps {
            let s = f32::from(i) / f32::from(steps);
            let (sin, cos) = (turn * s).sin_cos();
            let x = -0.9 + 1.8 * s;
            let at = |e: f32| [x + e * half * sin, y + drop * s + e * tilt, z + e * half * cos];
            let pose = [at(-1.0), at(1.0)];
            let before = (body.clone(), body.volume());
            match cutter.advance(&mut body, &mut incision, &pose, &params(snap)) {
                Ok(_) => {
                    let error = (body.volume() - before.1).abs() / before.1;
                    let bound = if snap == 0.0 { 1e-5 } else { 2e-3 };
                    prop_assert!(error < bound || noise > 0.0, "{}", error);
                }
                Err(error) => {
                    let is_expected = matches!(
                        error,
                        CutError::TipBlocked { .. }
                            | CutError::PartialCut { .. }
                            | CutError::OpenSection
                    );
                    prop_assert!(is_expected, "{}", error);
                    prop_assert_eq!(&body, &before.0);
                    incision.restart(&pose);
                }
            }
            check(&body);
            if is_moving {
                for p in body.positions_mut() {
                    p[1] += 0.01 * (3.0 * p[0]).sin();
                    p[0] += 0.005 * (4.0 * p[2]).cos();
                    p[2] *= 1.005;
                }
                cutter.refit(&body);
            }
        }
    }
}
/// Any number of steps through a body at rest gives the pieces of one slice.
#[test]
fn steps_of_a_stroke_equal_one_slice() {
    let bodies = [
        icosphere(4, 0.5),
        torus(0.35, 0.15, 48, 24),
        cube_sphere(12, 0.5),
    ];
    let strokes = [
        [
            [[-0.8, 0.01, -1.0], [-0.8, 0.01, 1.0]],
            [[0.8, 0.01, -1.0], [0.8, 0.01, 1.0]],
        ],
        [
            [[-0.8, -1.0, 0.03], [-0.8, 1.0, 0.02]],
            [[0.8, -1.0, 0.03], [0.8, 1.0, 0.02]],
        ],
        [
            [[-1.0, -0.7, 0.1], [0.7, 1.0, 0.1]],
            [[-0.3, -1.4, 0.05], [1.4, 0.3, 0.05]],
        ],
    ];
    for whole in bodies {
        for [from, to] in strokes {
            let sorted = |body: &Surface| {
                let mut volumes = body.piece_volumes();
                volumes.sort_by(f64::total_cmp);
                volumes
            };
            let mut once = whole.clone();
            let sweep = Sweep::new(from, to).unwrap();
            let outcome = Cutter::new(&once).incise(&mut once, &sweep, &params(0.0));
            let _ = outcome.unwrap();
            for steps in [1, 2, 5, 10, 16, 33, 64] {
                let (body, incision) = advance(&whole, from, to, steps, 0.0);
                assert!(!incision.is_inside());
                assert_eq!(check(&body), check(&once), "{steps} steps");
                let (found, expected) = (sorted(&body), sorted(&once));
                assert_eq!(found.len(), expected.len(), "{steps} steps");
                for (a, b) in found.iter().zip(&expected) {
                    assert!(
                        (a - b).abs() < 1e-6 * whole.volume(),
                        "{found:?} {expected:?}"
                    );
                }
            }
        }
    }
}

/// Moves a blade along x at the given places and returns the body after each.
fn along(whole: &Surface, places: &[f32]) -> Vec<(Surface, bool)> {
    let mut body = whole.clone();
    let mut cutter = Cutter::new(&body);
    let mut incision = Incision::default();
    let step = |&x: &f32| {
        let pose = [[x, 0.01, -1.0], [x, 0.02, 1.0]];
        let outcome = cutter.advance(&mut body, &mut incision, &pose, &params(0.1));
        let _ = outcome.unwrap_or_else(|error| panic!("at {x}: {error}"));
        check_manifold(&body);
        (body.clone(), incision.is_inside())
    };
    places.iter().map(step).collect()
}

#[test]
fn a_stroke_that_is_retraced_adds_nothing() {
    for whole in [
        icosphere(4, 0.5),
        torus(0.35, 0.15, 32, 16),
        sheet([1.0, 1.0], [31, 23]),
    ] {
        let mut places: Vec<f32> = (0..12u8).map(|i| -0.8 + 0.07 * f32::from(i)).collect();
        let there = places.len() - 1;
        let back: Vec<f32> = places[..there].iter().rev().copied().collect();
        for _ in 0..20 {
            let forth = places[1..=there].to_vec();
            places.extend_from_slice(&back);
            places.extend(forth);
        }
        let bodies = along(&whole, &places);
        assert!(bodies[there].1, "the blade is inside");
        for (body, _) in &bodies[there..] {
            assert!(*body == bodies[there].0);
        }
    }
}

#[test]
fn a_blade_goes_on_after_moving_back() {
    let whole = icosphere(4, 0.5);
    let there: Vec<f32> = (0..12u8).map(|i| -0.8 + 0.07 * f32::from(i)).collect();
    let onward: Vec<f32> = (12..25u8).map(|i| -0.8 + 0.07 * f32::from(i)).collect();
    let straight = along(&whole, &[there.clone(), onward.clone()].concat());
    for back in [-0.1, -0.35, -0.8] {
        let bent = along(
            &whole,
            &[there.clone(), vec![back], onward.clone()].concat(),
        );
        let (last, bent) = (straight.last().unwrap(), bent.last().unwrap());
        assert!(last == bent, "back to {back}");
        assert_eq!(bent.0.piece_count(), 2);
    }
}

#[test]
fn a_blade_that_turns_about_its_end_keeps_its_tip() {
    let whole = icosphere(4, 0.5);
    let mut body = whole.clone();
    let mut cutter = Cutter::new(&body);
    let mut incision = Incision::default();
    for i in 0..=40u8 {
        let x = -1.5 + 3.0 * f32::from(i) / 40.0;
        let pose = [[0.0, 0.013, 3.0], [x, 0.02, -1.5]];
        let outcome = cutter.advance(&mut body, &mut incision, &pose, &params(0.1));
        let outcome = outcome.unwrap_or_else(|error| panic!("step {i}: {error}"));
        check(&body);
        assert!(
            outcome.is_miss() || incision.is_inside() || x > 0.4,
            "step {i}"
        );
    }
    assert_eq!(body.piece_count(), 2);
}

#[test]
fn a_blade_that_is_no_polyline_is_an_error() {
    let mut body = icosphere(2, 0.5);
    let mut cutter = Cutter::new(&body);
    let mut incision = Incision::default();
    for x in [-0.8, -0.2] {
        let pose = [[x, 0.01, -1.0], [x, 0.02, 1.0]];
        let _ = cutter
            .advance(&mut body, &mut incision, &pose, &params(0.1))
            .unwrap();
    }
    assert!(incision.is_inside(), "the blade is inside");
    let before = (body.clone(), incision.clone());
    for _ in 0..2 {
        for blade in [&[[0.1, 0.0, 0.0]][..], &[][..]] {
            let refused = cutter.advance(&mut body, &mut incision, blade, &params(0.1));
            assert!(
                matches!(refused, Err(CutError::PolylineLength { .. })),
                "{refused:?}"
            );
        }
        let blade = [[f32::NAN, 0.01, -1.0], [0.2, 0.02, 1.0]];
        let refused = cutter.advance(&mut body, &mut incision, &blade, &params(0.1));
        assert!(
            matches!(refused, Err(CutError::SweepNotFinite { corner: 0 })),
            "{refused:?}"
        );
    }
    assert_eq!((body, incision), before);
}

#[test]
fn a_motion_along_the_edge_outside_is_no_cut() {
    let whole = icosphere(3, 0.5);
    let mut body = whole.clone();
    let mut cutter = Cutter::new(&body);
    let mut incision = Incision::default();
    for [x, low] in [[-0.8, -1.0], [-0.8, 4.0], [0.83, 4.0]] {
        let pose = [[x, 0.013, low], [x, 0.013, low + 2.0]];
        let outcome = cutter.advance(&mut body, &mut incision, &pose, &params(0.1));
        assert!(outcome.unwrap().is_miss(), "the blade stays outside");
    }
    assert_eq!(body, whole);
}

/// Strokes of random direction and turn that cross each other's walls leave a valid body. A step
/// may be refused, and the next stroke goes on.
#[test]
fn crossing_strokes_keep_the_surface_closed() {
    let mut seed = 777u64;
    let mut random = move || {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        f32::from(u16::try_from(seed >> 48).unwrap()) / 65_536.0
    };
    let (mut steps, mut refused) = (0, 0);
    for whole in [icosphere(1, 0.5), cube_sphere(8, 0.5)] {
        for _ in 0..10 {
            let mut body = whole.clone();
            let mut cutter = Cutter::new(&body);
            for _ in 0..4 {
                let mut incision = Incision::default();
                let mut vector = |size: f32| [0, 1, 2].map(|_| (random() - 0.5) * size);
                let (from, motion, edge) = (vector(1.2), vector(2.0), vector(2.0));
                for i in 0..8u8 {
                    let s = f32::from(i) / 7.0 - 0.2;
                    let at = |c: usize, e: f32| from[c] + motion[c] * s + edge[c] * e;
                    let pose = [-0.5, 0.5].map(|e| [0, 1, 2].map(|c| at(c, e)));
                    let outcome = cutter.advance(&mut body, &mut incision, &pose, &params(0.1));
                    steps += 1;
                    if outcome.is_err() {
                        refused += 1;
                        incision.restart(&pose);
                    }
                    check(&body);
                    cutter.bvh().validate(&body).unwrap();
                }
            }
        }
    }
    assert!(
        refused * 50 < steps,
        "{refused} of {steps} steps were refused"
    );
}
