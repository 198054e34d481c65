//! Hundreds of successive cuts with all invariants, and volumes by point sampling.

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::geometry::to_f64;
use incise_mesh::{Surface, Vec3, icosphere, torus};
use incise_models::{Model, build_model};
use incise_refine::{RefineParams, RefinementLevel};
use incise_test_support::random::Random;
use incise_tests::{assert_closed_manifold, cut_and_check, euler_characteristics, shells};

/// Returns a point in the bounding box of a surface.
fn point(random: &mut Random, surface: &Surface) -> Vec3 {
    let bounds = surface.bounds();
    let (min, max) = (to_f64(bounds.min), to_f64(bounds.max));
    min + (max - min).map(|size| size * random.unit())
}

fn direction(random: &mut Random) -> Vec3 {
    loop {
        let v = Vec3::new(random.signed(), random.signed(), random.signed());
        if v.norm() > 0.1 && v.norm() < 1.0 {
            return v.normalize();
        }
    }
}

/// Returns a plane through a random triangle of one piece or of the body.
fn sweep(random: &mut Random, surface: &Surface, only: Option<u32>) -> Sweep {
    let bounds = surface.bounds();
    let triangles: Vec<_> = (surface.topology().triangles())
        .filter(|&t| only.is_none_or(|piece| surface.piece(t) == piece))
        .collect();
    let t = triangles[random.below(triangles.len())];
    let [a, b, c] = surface.triangle_positions(t);
    let at = (a + b + c) / 3.0;
    let normal = direction(random);
    Sweep::from_plane(normal.into(), normal.dot(&at), &bounds).expect("a plane")
}

/// Cuts a body many times, either the whole or only its largest piece.
fn cut_often(whole: &Surface, count: usize, snap: f64, seed: u64) {
    let mut random = Random::new(seed);
    let mut surface = whole.clone();
    let mut cutter = Cutter::new(&surface);
    let mut moved = 0.0;
    let mut cuts = 0;
    while cuts < count {
        let volumes = surface.piece_volumes();
        let largest = (0..).zip(&volumes).max_by(|a, b| a.1.total_cmp(b.1));
        let largest = largest.expect("a body has a piece").0;
        let params = CutParams {
            snap,
            // Cuts of all pieces double their number; a few are enough.
            only_piece: (cuts % 40 != 39).then_some(largest),
            // Coarse caps bound the cost of checking the invariants.
            refine: RefineParams {
                level: RefinementLevel::Coarser2,
                ..RefineParams::default()
            },
            ..CutParams::default()
        };
        let sweep = sweep(&mut random, &surface, params.only_piece);
        let result = cut_and_check(&mut surface, &mut cutter, &sweep, &params);
        let outcome = result.expect("a full slice cuts");
        moved += outcome.report.moved_volume;
        cuts += usize::from(!outcome.is_miss());
    }
    assert_closed_manifold(&surface);
    let error = (surface.volume() - whole.volume()).abs();
    let bound = moved + 1e-5 * whole.volume();
    assert!(
        error <= bound,
        "the volume changed by {error}, at most {bound} was reported"
    );
    let pieces = euler_characteristics(&surface).len();
    assert!(
        pieces > count / 2,
        "only {pieces} pieces after {count} cuts"
    );
}

#[test]
fn the_bunny_is_cut_50_times() {
    cut_often(&build_model(Model::Bunny), 50, 0.1, 1);
}

#[test]
fn a_torus_is_cut_50_times_exactly() {
    cut_often(&torus(0.4, 0.15, 24, 12), 50, 0.0, 4);
}

#[test]
#[ignore = "long"]
fn bodies_are_cut_200_times() {
    for snap in [0.0, 0.1] {
        cut_often(&build_model(Model::Bunny), 200, snap, 2);
        cut_often(&torus(0.4, 0.15, 24, 12), 200, snap, 3);
    }
}

/// Returns the winding number around a point by solid angles (van Oosterom and Strackee 1983).
fn winding(surface: &Surface, only: Option<u32>, at: Vec3) -> f64 {
    let triangles = surface.topology().triangles();
    let triangles = triangles.filter(|&t| only.is_none_or(|piece| surface.piece(t) == piece));
    let angle: f64 = triangles
        .map(|t| {
            let [a, b, c] = surface.triangle_positions(t).map(|p| p - at);
            let [la, lb, lc] = [a, b, c].map(|p| p.norm());
            let scale = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
            2.0 * a.dot(&b.cross(&c)).atan2(scale)
        })
        .sum();
    angle / (2.0 * std::f64::consts::TAU)
}

/// A point is in a piece if it was in the body and is on the piece's side of the plane.
///
/// Random points are tested by the winding number of the input and the side of the plane.
#[test]
fn pieces_contain_the_points_of_the_body() {
    let bodies = [
        shells(2),
        torus(0.4, 0.15, 16, 8),
        icosphere(2, 0.5),
        build_model(Model::Bunny),
    ];
    for (seed, body) in (10..).zip(bodies) {
        let mut random = Random::new(seed);
        for _ in 0..3 {
            let sweep = sweep(&mut random, &body, None);
            let (origin, normal) = sweep.plane();
            let mut surface = body.clone();
            let params = CutParams {
                snap: 0.0,
                ..CutParams::default()
            };
            let mut cutter = Cutter::new(&body);
            let cut = cut_and_check(&mut surface, &mut cutter, &sweep, &params);
            let _ = cut.expect("a full slice cuts");
            let pieces: Vec<u32> = euler_characteristics(&surface).into_keys().collect();
            let side = |piece: &u32| {
                let triangles = surface.topology().triangles();
                let of = triangles.filter(|&t| surface.piece(t) == *piece);
                let corners = of.flat_map(|t| surface.triangle_positions(t));
                let heights = corners.map(|p| normal.dot(&(p - origin)));
                heights.fold(0.0, |far: f64, h| if h.abs() > far.abs() { h } else { far })
            };
            let sides: Vec<f64> = pieces.iter().map(side).collect();
            for _ in 0..150 {
                let at = point(&mut random, &body);
                let height = normal.dot(&(at - origin));
                let was = winding(&body, None, at);
                // Points near the surface are skipped: flat caps and rounding decide there.
                if height.abs() < 1e-5 || (was - was.round()).abs() > 1e-6 {
                    continue;
                }
                for (&piece, &side) in pieces.iter().zip(&sides) {
                    let is = winding(&surface, Some(piece), at);
                    assert!(
                        is.abs() < 1e-6 || (side > 0.0) == (height > 0.0),
                        "{at} is in piece {piece}, beyond the plane: {is}"
                    );
                }
                let sum: f64 = pieces.iter().map(|&p| winding(&surface, Some(p), at)).sum();
                assert!(
                    (sum - was).abs() < 1e-6,
                    "{at} was held {was} times, is {sum} times"
                );
            }
        }
    }
}
