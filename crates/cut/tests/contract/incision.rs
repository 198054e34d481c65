//! Incisions: sweeps that end inside the body.

use crate::common::{check, params};
use incise_cut::{CutError, CutOutcome, Cutter, Sweep};
use incise_mesh::{Surface, TriangleId, cube_sphere, icosphere, torus};
use proptest::prelude::*;
use std::collections::BTreeSet;

/// Asserts that the two walls are mirror images at the same positions and at rest.
fn assert_walls_mirror(surface: &Surface, outcome: &CutOutcome) {
    let (below, above) = outcome.cap.split_at(outcome.cap.len() / 2);
    assert_eq!(below.len(), above.len(), "two walls");
    for (&a, &b) in below.iter().zip(above) {
        let corners = |t: TriangleId| surface.topology().triangle(t);
        let ([a, b, c], [d, e, f]) = (corners(a), corners(b));
        for (v, w) in [(a, d), (b, f), (c, e)] {
            assert_eq!(surface.position(v), surface.position(w), "{v} and {w}");
            assert_eq!(
                surface.rest_position(v),
                surface.rest_position(w),
                "{v} and {w}"
            );
        }
    }
}

/// Returns the Euler characteristic of the section: of one wall.
fn section_euler(surface: &Surface, outcome: &CutOutcome) -> i64 {
    let mut edges = BTreeSet::new();
    let mut vertices = BTreeSet::new();
    let below = &outcome.cap[..outcome.cap.len() / 2];
    for &t in below {
        let [a, b, c] = surface.topology().triangle(t);
        vertices.extend([a, b, c]);
        edges.extend([(a, b), (b, c), (c, a)].map(|(v, w)| (v.min(w), v.max(w))));
    }
    let count = |n: usize| i64::try_from(n).unwrap();
    count(vertices.len()) - count(edges.len()) + count(below.len())
}

/// Asserts chi(S') = chi(S) + 2 (chi(R) - a) for a slits.
fn assert_euler_law(before: i64, surface: &Surface, outcome: &CutOutcome) {
    let slits = i64::try_from(outcome.report.slits).unwrap();
    let change = 2 * (section_euler(surface, outcome) - slits);
    assert_eq!(check(surface), before + change, "{slits} slits");
}

fn wall_area(surface: &Surface, outcome: &CutOutcome) -> f64 {
    let area = |&t: &TriangleId| {
        incise_mesh::geometry::area_vector(surface.triangle_positions(t)).norm() / 2.0
    };
    outcome.cap.iter().map(area).sum()
}

/// Cuts a copy, checks everything that holds for any incision, undoes it and returns the outcome
/// and the body.
fn incise(whole: &Surface, sweep: &Sweep, snap: f64) -> (Surface, CutOutcome, i64) {
    let mut body = whole.clone();
    let mut cutter = Cutter::new(&body);
    let outcome = cutter.incise(&mut body, sweep, &params(snap)).unwrap();
    let euler = check(&body);
    assert_euler_law(check(whole), &body, &outcome);
    cutter.bvh().validate(&body).unwrap();
    assert_walls_mirror(&body, &outcome);
    let volumes = (whole.volume(), body.volume());
    let error = (volumes.0 - volumes.1).abs() / volumes.0;
    assert!(error < if snap == 0.0 { 1e-6 } else { 2e-3 }, "{error}");
    let mut undone = body.clone();
    outcome.undo.clone().unwrap().revert(&mut undone).unwrap();
    assert_eq!(undone, *whole, "the undo restores every bit");
    (body, outcome, euler)
}

fn stroke(from: f32, to: f32) -> Sweep {
    Sweep::new(
        [[from, 0.01, -1.0], [from, 0.01, 1.0]],
        [[to, 0.01, -1.0], [to, 0.01, 1.0]],
    )
    .unwrap()
}

/// A blade of `n` points that is bent and moves from x = -1 to `depth`.
fn curved_stroke(
    n: u16,
    [sag, height, along]: [f32; 3],
    depth: f32,
    bend: f32,
    half: f32,
) -> Sweep {
    let line = |x: f32| -> Vec<[f32; 3]> {
        let point = |i: u16| {
            let s = 2.0 * f32::from(i) / f32::from(n - 1) - 1.0;
            [
                x + sag * s * s,
                height + bend * (s + x) * s,
                half * s + along,
            ]
        };
        (0..n).map(point).collect()
    };
    Sweep::strip(&line(-1.0), &line(depth)).unwrap()
}

#[test]
fn a_stroke_into_a_ball_opens_one_slit() {
    for snap in [0.0, 0.1] {
        for n in 0..5 {
            let whole = icosphere(n, 0.5);
            let (body, outcome, euler) = incise(&whole, &stroke(-1.0, 0.1), snap);
            assert_eq!(euler, 2);
            assert!(outcome.delta.pieces_added.is_empty());
            assert_eq!((outcome.report.loops, outcome.report.slits), (0, 1));
            if n == 4 {
                // A circular segment beyond x = 0.1, twice.
                let (r, d): (f64, f64) = (0.5, 0.1);
                let beyond = r * r * (d / r).acos() - d * (r * r - d * d).sqrt();
                let area = 2.0 * (std::f64::consts::PI * r * r - beyond);
                let found = wall_area(&body, &outcome);
                assert!((found / area - 1.0).abs() < 0.01, "{found} {area}");
            }
        }
    }
}

#[test]
fn a_short_blade_leaves_three_sides_of_the_slit_inside() {
    let sweep = Sweep::new(
        [[-1.0, 0.01, -0.2], [-1.0, 0.01, 0.2]],
        [[0.1, 0.01, -0.2], [0.1, 0.01, 0.25]],
    );
    for snap in [0.0, 0.1] {
        let (.., euler) = incise(&icosphere(4, 0.5), &sweep.clone().unwrap(), snap);
        assert_eq!(euler, 2);
    }
}

#[test]
fn a_nick_inside_one_triangle_is_a_slit() {
    let whole = cube_sphere(1, 0.5);
    let top = whole.bounds().max[1];
    for depth in [0.01, 0.2] {
        let sweep = Sweep::new(
            [[0.05, top + 0.1, -0.11], [0.06, top + 0.1, -0.02]],
            [[0.05, top - depth, -0.11], [0.06, top - depth, -0.02]],
        );
        let (_, outcome, euler) = incise(&whole, &sweep.unwrap(), 0.1);
        assert_eq!(euler, 2);
        assert_eq!(outcome.report.hits, 1);
    }
}

#[test]
fn a_stroke_through_the_hole_of_a_torus_follows_the_law() {
    // Across the tube on one side only: a full slice, which opens the ring.
    let whole = torus(0.35, 0.15, 48, 24);
    let across = |to: f32, y: f32| {
        Sweep::new(
            [[-1.0, -y, 0.01], [-1.0, y, 0.01]],
            [[to, -y, 0.01], [to, y, 0.01]],
        )
        .unwrap()
    };
    let (.., euler) = incise(&whole, &across(0.0, 1.0), 0.1);
    assert_eq!(euler, 2, "a sphere");
    // Into the tube: a slit.
    let (.., euler) = incise(&whole, &across(-0.35, 1.0), 0.1);
    assert_eq!(euler, 0, "still a torus");
    // A short blade through the whole tube leaves by both sides: the section is a strip.
    let (.., euler) = incise(&whole, &across(0.0, 0.05), 0.1);
    assert_eq!(euler, 2 * (1 - 2), "chi + 2 (chi(R) - a)");
}

/// A ball with a ball-shaped cavity, whose wall is a piece of its own.
fn hollow_ball() -> Surface {
    let (outer, inner) = (icosphere(3, 0.5), icosphere(3, 0.25));
    let count = u32::try_from(outer.positions().len()).unwrap();
    let positions = |s: &Surface| s.positions().iter().map(|p| [p[0], p[1], p[2]]).collect();
    let faces = |s: &Surface| -> Vec<[u32; 3]> {
        let topology = s.topology();
        let all = topology
            .triangles()
            .map(|t| topology.triangle(t).map(|v| v.0));
        all.collect()
    };
    let mut all: Vec<[f32; 3]> = positions(&outer);
    all.extend::<Vec<_>>(positions(&inner));
    let mut triangles = faces(&outer);
    triangles.extend(
        faces(&inner)
            .iter()
            .map(|t| [t[0], t[2], t[1]].map(|v| v + count)),
    );
    Surface::from_triangles(&all, &triangles).unwrap()
}

#[test]
fn a_stroke_into_a_cavity_ends_in_the_wall_around_it() {
    for (to, slits) in [
        (-0.3, 1),
        (-0.2, 2),
        (0.0, 2),
        (0.2, 2),
        (0.3, 1),
        (0.45, 1),
    ] {
        let (_, outcome, _) = incise(&hollow_ball(), &stroke(-1.0, to), 0.1);
        assert_eq!(outcome.report.slits, slits, "to {to}");
    }
    // A blade that is shorter than the cavity is wide.
    let short = Sweep::new(
        [[-1.0, 0.01, -0.1], [-1.0, 0.01, 0.1]],
        [[0.0, 0.01, -0.1], [0.0, 0.01, 0.1]],
    );
    let (_, outcome, _) = incise(&hollow_ball(), &short.unwrap(), 0.1);
    assert_eq!(outcome.report.slits, 2);
}

#[test]
fn overlapping_bodies_are_never_joined() {
    let single = icosphere(3, 0.5);
    let count = u32::try_from(single.positions().len()).unwrap();
    let topology = single.topology();
    let faces: Vec<[u32; 3]> = topology
        .triangles()
        .map(|t| topology.triangle(t).map(|v| v.0))
        .collect();
    let mut positions: Vec<[f32; 3]> = single
        .positions()
        .iter()
        .map(|p| [p[0], p[1], p[2]])
        .collect();
    positions.extend(
        positions
            .clone()
            .iter()
            .map(|p| [p[0] + 0.1, p[1], p[2] + 0.2]),
    );
    let mut triangles = faces.clone();
    triangles.extend(faces.iter().map(|t| t.map(|v| v + count)));
    let whole = Surface::from_triangles(&positions, &triangles).unwrap();
    for to in [-0.3, 0.0, 0.3] {
        let (body, outcome, euler) = incise(&whole, &stroke(-1.0, to), 0.1);
        assert_eq!((euler, outcome.report.slits), (4, 2));
        assert_eq!(body.piece_count(), 2);
    }
}

/// Strokes that random tests found: slits of two nodes, chains along edges of the surface, slits
/// inside one triangle beside each other.
#[test]
fn regressions_of_bent_strokes() {
    let ball = |n| icosphere(n, 0.5);
    let cube = cube_sphere(2, 0.5);
    let cases: [(&Surface, [[f32; 3]; 4]); 5] = [
        (
            &cube,
            [
                [0.0; 3],
                [0.0, 0.0, 0.181_548_2],
                [0.584_519_6, 0.0, 0.0],
                [0.0, -0.074_019_66, 0.0],
            ],
        ),
        (
            &cube,
            [
                [-0.723_888_04, 0.0, 0.160_314_22],
                [0.0, -0.624_189_85, -0.632_023_93],
                [0.554_848_7, 0.0, 0.0],
                [-0.055_503_447, 0.441_694_74, 0.211_383_5],
            ],
        ),
        (
            &cube,
            [
                [0.0; 3],
                [0.681_809_54, 0.128_703_68, 0.627_674_3],
                [0.213_121_61, -0.126_942_19, 0.506_246_1],
                [-0.465_044_1, -0.261_308_16, 0.0],
            ],
        ),
        (
            &ball(0),
            [
                [0.288_707_94, -0.627_080_26, 0.443_099_32],
                [-0.063_840_02, 0.230_200_37, -0.593_920_77],
                [-0.128_779_46, 0.0, -0.794_340_3],
                [-0.209_175_99, 0.0, 0.346_920_4],
            ],
        ),
        (
            &ball(2),
            [
                [0.616_424_14, 0.270_581_45, -0.347_727_95],
                [-0.065_166_615, -0.149_662_61, 0.222_972],
                [-0.432_997_58, -0.542_539_66, 0.503_003_06],
                [0.625_372_6, 0.309_677_78, -0.348_174_42],
            ],
        ),
    ];
    for (whole, [a, b, c, d]) in cases {
        let _ = incise(whole, &Sweep::new([a, b], [c, d]).unwrap(), 0.0);
    }
}

#[test]
fn regressions_of_strips() {
    let ring = torus(0.35, 0.15, 24, 12);
    for (n, seed, depth, bend, half) in [
        (
            6,
            [-0.140_321_98, -0.208_462_4, -0.101_076_86],
            0.827_087_7,
            0.270_396_05,
            0.428_307_27,
        ),
        (
            5,
            [0.0, 0.165_532_5, -0.193_237_4],
            0.457_697_24,
            -0.158_861_71,
            0.730_445_86,
        ),
    ] {
        let _ = incise(&ring, &curved_stroke(n, seed, depth, bend, half), 0.1);
    }
}

proptest! {
    /// Any flat or bent stroke of any blade into any body keeps all invariants.
    #[test]
    fn strokes_keep_the_surface_closed(
        body in 0usize..4,
        corners in prop::array::uniform4(prop::array::uniform3(-0.8f32..0.8)),
        snap in prop::sample::select(vec![0.0, 0.1]),
    ) {
        let ring = torus(0.35, 0.15, 24, 12);
        let whole = [icosphere(2, 0.5), ring, cube_sphere(2, 0.5), icosphere(0, 0.5)];
        let whole = &whole[body];
        let [a, b, c, d] = corners;
        let Ok(sweep) = Sweep::new([a, b], [c, d]) else { return Ok(()) };
        let mut body = whole.clone();
        let mut cutter = Cutter::new(&body);
        match cutter.incise(&mut body, &sweep, &params(snap)) {
            Ok(outcome) if outcome.is_miss() => prop_assert_eq!(&body, whole),
            Ok(outcome) => {
                assert_euler_law(check(whole), &body, &outcome);
                assert_walls_mirror(&body, &outcome);
                let error = (whole.volume() - body.volume()).abs() / whole.volume();
                prop_assert!(error < if snap == 0.0 { 1e-5 } else { 4e-3 }, "{}", error);
                outcome.undo.unwrap().revert(&mut body).unwrap();
                prop_assert_eq!(&body, whole);
            }
            Err(error) => {
                prop_assert!(matches!(error, CutError::PartialCut { .. }), "{}", error);
                prop_assert_eq!(&body, whole);
            }
        }
    }

    /// A blade of many points cuts as well.
    #[test]
    fn strips_keep_the_surface_closed(
        body in 0usize..3,
        n in 2u16..9,
        seed in prop::array::uniform3(-0.3f32..0.3),
        depth in -0.4f32..0.9,
        bend in -0.4f32..0.4,
        half in 0.1f32..1.0,
    ) {
        let whole = [icosphere(3, 0.5), torus(0.35, 0.15, 24, 12), cube_sphere(3, 0.5)];
        let whole = &whole[body];
        let sweep = curved_stroke(n, seed, depth, bend, half);
        let mut body = whole.clone();
        let mut cutter = Cutter::new(&body);
        match cutter.incise(&mut body, &sweep, &params(0.1)) {
            Ok(outcome) if outcome.is_miss() => prop_assert_eq!(&body, whole),
            Ok(outcome) => {
                assert_euler_law(check(whole), &body, &outcome);
                assert_walls_mirror(&body, &outcome);
                outcome.undo.unwrap().revert(&mut body).unwrap();
                prop_assert_eq!(&body, whole);
            }
            Err(error) => {
                prop_assert!(matches!(error, CutError::PartialCut { .. }), "{}", error);
            }
        }
    }
}

/// A sweep exactly through vertices that ends inside leaves no edges without length.
#[test]
fn a_sweep_through_vertices_has_room_at_its_ends() {
    let whole = cube_sphere(16, 0.5);
    let sweep = Sweep::strip(
        &[[0.0, 1.0, -0.7], [0.0, 1.0, 0.7]],
        &[[0.0, 0.2, -0.7], [0.0, 0.2, 0.7]],
    );
    let (body, outcome, euler) = incise(&whole, &sweep.unwrap(), 0.1);
    assert_eq!((outcome.report.slits, euler), (1, 2));
    let topology = body.topology();
    for h in topology.edges() {
        let [a, b] = [topology.origin(h), topology.target(h)];
        assert_ne!(body.rest_position(a), body.rest_position(b), "{a} and {b}");
    }
}

#[test]
fn a_new_cutter_slices_across_the_walls_of_an_incision() {
    let mut slit = cube_sphere(8, 0.5);
    let stroke = Sweep::new(
        [[-0.8, 0.01, -1.0], [-0.8, 0.02, 1.0]],
        [[0.1, 0.01, -1.0], [0.1, 0.02, 1.0]],
    );
    let outcome = Cutter::new(&slit).incise(&mut slit, &stroke.unwrap(), &params(0.1));
    assert_eq!(outcome.unwrap().report.slits, 1);
    for i in 0..24u8 {
        let angle = f64::from(i) * 0.26;
        let normal = [angle.sin(), angle.cos(), 0.3 * (3.0 * angle).sin()];
        let plane = Sweep::from_plane(normal, 0.02 * f64::from(i % 5), &slit.bounds()).unwrap();
        let mut body = slit.clone();
        let outcome = Cutter::new(&body).cut(&mut body, &plane, &params(0.1));
        let _ = outcome.unwrap_or_else(|error| panic!("plane {i}: {error}"));
        check(&body);
        assert!(body.piece_count() > 1, "plane {i}");
    }
}
