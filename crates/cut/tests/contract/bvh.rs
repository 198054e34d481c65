//! The BVH of a `Cutter` through cuts, undo and motion, compared with a fresh one and brute force.

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::geometry::round_to_f32;
use incise_mesh::{Bvh, Surface, TriangleId, VertexId, cube_sphere, torus};
use incise_refine::{RefineParams, RefinementLevel};
use incise_test_support::random::Random;
use proptest::prelude::*;
use std::cell::Cell;

/// Returns a number from -1 to 1.
fn signed(random: &mut Random) -> f32 {
    round_to_f32(random.signed())
}

/// Returns the sweep of a random plane near the center of a surface.
fn plane(random: &mut Random, surface: &Surface) -> Sweep {
    let n = [random.signed(), random.signed(), random.signed() + 0.0005];
    let bounds = surface.bounds();
    let d = random.signed() * bounds.diagonal() / 4.0;
    let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
    let center = bounds.center();
    let at = n[0] * center.x + n[1] * center.y + n[2] * center.z;
    Sweep::from_plane(n, at + d * length, &bounds).unwrap()
}

/// Returns a sweep of about 0.2 m.
fn small_sweep(random: &mut Random) -> Sweep {
    let corner = [0; 3].map(|_| signed(random));
    let to = |random: &mut Random| {
        [0, 1, 2].map(|k| corner[k] + 0.2 * signed(random) + 0.001 * k as f32)
    };
    let (a, b, c) = (to(random), to(random), to(random));
    Sweep::new([corner, a], [b, c]).unwrap()
}

/// Each triangle of a surface as a surface of its own, with its BVH.
struct SingleTriangles(Vec<(TriangleId, Surface, Bvh)>);

impl SingleTriangles {
    fn new(surface: &Surface) -> Self {
        let single = |t: TriangleId| {
            let corners = surface.topology().triangle(t);
            let corners = corners.map(|v| {
                let [x, y, z, _] = surface.positions()[v.index()];
                [x, y, z]
            });
            let alone = Surface::from_triangles(&corners, &[[0, 1, 2]]).unwrap();
            let bvh = Bvh::build(&alone);
            (t, alone, bvh)
        };
        Self(surface.topology().triangles().map(single).collect())
    }

    /// Compares a query of `bvh` with one over each triangle alone.
    fn assert_same_query(&self, bvh: &Bvh, surface: &Surface, sweep: &Sweep) {
        let mut found = Vec::new();
        bvh.query(surface, sweep.triangles(), &mut found);
        found.sort_unstable();
        let mut one = Vec::new();
        let expected = self.0.iter().filter_map(|(t, alone, bvh)| {
            one.clear();
            bvh.query(alone, sweep.triangles(), &mut one);
            (!one.is_empty()).then_some(*t)
        });
        let expected: Vec<TriangleId> = expected.collect();
        assert_eq!(
            found, expected,
            "a query finds the same triangles as brute force"
        );
    }
}

/// Returns the number of boxes that a query tests.
fn visits(bvh: &Bvh, surface: &Surface, sweep: &Sweep) -> usize {
    let count = Cell::new(0);
    let reach = sweep.bounds();
    let touches = |b: &incise_mesh::Aabb| {
        count.set(count.get() + 1);
        b.overlaps(&reach)
    };
    bvh.traverse(surface, touches, &mut Vec::new());
    count.get()
}

/// Cuts slices off and moves all pieces apart after every 20 cuts.
#[test]
fn a_hundred_cuts_keep_height_and_query_cost() {
    let mut surface = cube_sphere(32, 1.0);
    let mut cutter = Cutter::new(&surface);
    let mut random = Random::new(4);
    let mut cuts = 0;
    for _ in 0..600 {
        let sweep = plane(&mut random, &surface);
        let params = CutParams {
            only_piece: Some(u32::try_from(random.below(surface.piece_bound() as usize)).unwrap()),
            refine: RefineParams {
                level: RefinementLevel::Z(3.0),
                ..RefineParams::default()
            },
            ..CutParams::default()
        };
        let Ok(outcome) = cutter.cut(&mut surface, &sweep, &params) else {
            continue;
        };
        if outcome.is_miss() {
            continue;
        }
        cuts += 1;
        cutter.bvh().validate(&surface).unwrap();
        if cuts % 20 == 0 {
            push_apart(&mut surface);
            cutter.refit(&surface);
            cutter.bvh().validate(&surface).unwrap();
        }
    }
    assert!(cuts >= 100, "{cuts} cuts");
    let fresh = Bvh::build(&surface);
    let (height, fresh_height) = (cutter.bvh().height(), fresh.height());
    assert!(
        height <= fresh_height + 10,
        "{height} levels, {fresh_height} when fresh"
    );
    let single = SingleTriangles::new(&surface);
    let (mut old, mut new) = (0, 0);
    for _ in 0..200 {
        let sweep = small_sweep(&mut random);
        old += visits(cutter.bvh(), &surface, &sweep);
        new += visits(&fresh, &surface, &sweep);
        single.assert_same_query(cutter.bvh(), &surface, &sweep);
    }
    assert!(2 * old <= 3 * new, "{old} boxes, {new} in a fresh tree");
}

/// Moves every piece away from the center.
fn push_apart(surface: &mut Surface) {
    let count = surface.piece_bound() as usize;
    let mut sums = vec![([0.0_f32; 3], 0.0_f32); count];
    let triangles: Vec<TriangleId> = surface.topology().triangles().collect();
    for &t in &triangles {
        let corners = surface
            .topology()
            .triangle(t)
            .map(|v| surface.positions()[v.index()]);
        let (sum, of) = &mut sums[surface.piece(t) as usize];
        for (k, x) in sum.iter_mut().enumerate() {
            *x += corners.iter().map(|p| p[k]).fold(f32::INFINITY, f32::min);
        }
        *of += 1.0;
    }
    let mut moved = vec![false; surface.positions().len()];
    for t in triangles {
        let (sum, of) = sums[surface.piece(t) as usize];
        for v in surface.topology().triangle(t) {
            if !std::mem::replace(&mut moved[v.index()], true) {
                for (k, x) in sum.iter().enumerate() {
                    surface.positions_mut()[v.index()][k] += 0.05 * x / of;
                }
            }
        }
    }
}

fn around(surface: &Surface, v: VertexId) -> Vec<TriangleId> {
    let fan = surface.topology().outgoing_fan(v);
    fan.map(|h| h.triangle()).collect()
}

/// A huge sweep with nearly collinear corners has a normal that is mostly rounding. Triangles that
/// it crosses were no candidates then, and the cut failed with `StaleBvh` or missed.
#[test]
fn a_nearly_collinear_sweep_finds_all_triangles_that_it_crosses() {
    let body = torus(0.4, 0.15, 24, 12);
    let bvh = Bvh::build(&body);
    let mut random = Random::new(11);
    let (mut crossing, mut crossed) = (0, 0);
    for _ in 0..2_000 {
        let along = [0; 3].map(|_| random.signed());
        let near = [0; 3].map(|_| 0.4 * random.signed());
        // Far in both directions, by up to 10^8, and a few sizes of the body to the side.
        let mut corner = |side: f64| {
            let far = side * 10f64.powf(4.0 + 4.0 * random.signed());
            let off = 10f64.powf(0.5 + 1.5 * random.signed());
            let p = [0, 1, 2].map(|k| near[k] + far * along[k] + off * random.signed());
            incise_mesh::geometry::to_f32(p.into())
        };
        let corners = [corner(-1.0), corner(1.0), corner(1.0), corner(-1.0)];
        let [a, b, c, d] = corners;
        let Ok(sweep) = Sweep::new([a, b], [d, c]) else {
            continue;
        };
        let mut found = Vec::new();
        bvh.query(&body, sweep.triangles(), &mut found);
        found.sort_unstable();
        let before = crossed;
        for t in body.topology().triangles() {
            let corners = body.topology().triangle(t).map(|v| {
                let [x, y, z, _] = body.positions()[v.index()];
                [x, y, z]
            });
            let crosses = |k: usize| sweep.intersects_segment(corners[k], corners[(k + 1) % 3]);
            if (0..3).any(crosses) {
                crossed += 1;
                assert!(
                    found.binary_search(&t).is_ok(),
                    "{t} is crossed by {sweep:?} and no candidate"
                );
            }
        }
        crossing += usize::from(crossed > before);
    }
    assert!(crossing > 300, "only {crossing} sweeps crossed the body");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Cuts, moves some vertices and moves all of them, in any order.
    #[test]
    fn queries_equal_brute_force_after_cuts_undo_and_motion(
        seed in any::<u64>(),
        steps in 1..12_usize,
    ) {
        let mut random = Random::new(seed);
        let mut surface = if seed % 2 == 0 { torus(1.0, 0.4, 24, 12) } else { cube_sphere(8, 0.9) };
        let mut cutter = Cutter::new(&surface);
        for _ in 0..steps {
            match random.below(3) {
                0 => {
                    let sweep = plane(&mut random, &surface);
                    // A cut that fails changes nothing.
                    let done = cutter.cut(&mut surface, &sweep, &CutParams::default());
                    cutter.bvh().validate(&surface).unwrap();
                    if let Some(undo) = done.ok().and_then(|outcome| outcome.undo)
                        && random.below(2) == 0
                    {
                        cutter.undo(&mut surface, undo).unwrap();
                    }
                }
                1 => {
                    let vertices: Vec<VertexId> = surface.topology().vertices().collect();
                    let mut moved = Vec::new();
                    for _ in 0..random.below(9) {
                        let v = vertices[random.below(vertices.len())];
                        let axis = random.below(3);
                        surface.positions_mut()[v.index()][axis] += 0.1 * signed(&mut random);
                        moved.extend(around(&surface, v));
                    }
                    cutter.refit_moved(&surface, &moved);
                }
                _ => {
                    for p in surface.positions_mut() {
                        p[random.below(3)] += 0.02 * signed(&mut random);
                    }
                    prop_assert!(cutter.bvh().validate(&surface).is_err(), "boxes are stale");
                    cutter.refit(&surface);
                }
            }
            cutter.bvh().validate(&surface).unwrap();
            let single = SingleTriangles::new(&surface);
            single.assert_same_query(cutter.bvh(), &surface, &plane(&mut random, &surface));
            single.assert_same_query(cutter.bvh(), &surface, &small_sweep(&mut random));
        }
    }
}
