//! Remeshing around the rim: invariants of a cut, removed slivers, and the bound of displacements.

use incise_cut::{CutError, CutOutcome, CutParams, Cutter, Sweep};
use incise_mesh::geometry::{area_vector, corner_angles};
use incise_mesh::{Surface, TriangleId, Vec3, VertexId, icosphere};
use incise_models::{Model, build_model};
use incise_tests::{
    Planes, any_blade, any_body, any_level, cases, cut_and_check, self_intersecting_body,
};
use proptest::prelude::*;
use std::collections::BTreeSet;

/// A body cut twice along the same sweep, without remeshing and with it.
struct Twice {
    before: Surface,
    plain: (Surface, CutOutcome),
    remeshed: (Surface, CutOutcome),
    tolerance: f64,
}

/// Returns parameters of the exact method.
fn remeshing(snap: f64, remesh: f64) -> CutParams {
    CutParams {
        snap,
        remesh,
        ..CutParams::default()
    }
}

/// Cuts twice and asserts all invariants; `None` if the sweep misses or ends inside.
fn cut_twice(before: &Surface, sweep: &Sweep, params: &CutParams) -> Option<Twice> {
    let cut = |params: &CutParams| -> Option<(Surface, CutOutcome)> {
        let mut surface = before.clone();
        let mut cutter = Cutter::new(before);
        match cut_and_check(&mut surface, &mut cutter, sweep, params) {
            Ok(outcome) => (!outcome.is_miss()).then_some((surface, outcome)),
            Err(CutError::PartialCut { .. }) => None,
            Err(error) => panic!("{sweep:?} was refused: {error}"),
        }
    };
    let off = CutParams {
        remesh: 0.0,
        ..*params
    };
    Some(Twice {
        before: before.clone(),
        plain: cut(&off)?,
        remeshed: cut(params)?,
        tolerance: params.remesh,
    })
}

/// Returns the triangles that do not belong to caps.
fn old_surface((surface, outcome): &(Surface, CutOutcome)) -> impl Iterator<Item = TriangleId> {
    let caps: BTreeSet<TriangleId> = outcome.cap.iter().copied().collect();
    let triangles = surface.topology().triangles();
    triangles.filter(move |t| !caps.contains(t))
}

fn pieces(surface: &Surface) -> usize {
    let triangles = surface.topology().triangles();
    let pieces: BTreeSet<u32> = triangles.map(|t| surface.piece(t)).collect();
    pieces.len()
}

/// Returns the smallest angle of a triangle \[degrees\].
fn smallest_angle(surface: &Surface, t: TriangleId) -> f64 {
    let angles = corner_angles(surface.triangle_positions(t));
    angles.into_iter().fold(f64::MAX, f64::min).to_degrees()
}

impl Twice {
    /// Returns the triangles outside of caps that differ between the two cuts.
    fn differing(&self) -> [Vec<[Vec3; 3]>; 2] {
        // Rim vertices may have other ids, so they are compared by position.
        let at = |s: &Surface, t: TriangleId| {
            let bits = |v: VertexId| s.positions()[v.index()].map(f32::to_bits);
            let mut corners = s.topology().triangle(t).map(bits);
            let first = (0..3).min_by_key(|&i| corners[i]).unwrap_or_default();
            corners.rotate_left(first);
            corners
        };
        let all = |cut: &(Surface, CutOutcome)| -> BTreeSet<_> {
            old_surface(cut).map(|t| at(&cut.0, t)).collect()
        };
        let sets = [all(&self.plain), all(&self.remeshed)];
        let point = |p: [u32; 4]| {
            let [x, y, z, _] = p.map(|bits| f64::from(f32::from_bits(bits)));
            Vec3::new(x, y, z)
        };
        [0, 1].map(|i| {
            let own = sets[i].difference(&sets[1 - i]);
            own.map(|corners| corners.map(point)).collect()
        })
    }

    /// Returns the rounding error of stored positions \[m\].
    fn rounding(&self) -> f64 {
        let bounds = self.before.bounds();
        let coordinates = bounds.min.iter().chain(&bounds.max);
        let largest = coordinates.fold(0.0, |m, x| f64::from(x.abs()).max(m));
        16.0 * f64::from(f32::EPSILON) * largest
    }

    /// Asserts the bounds of remeshing: displacement, volume and number of pieces.
    fn check(&self) {
        let report = &self.remeshed.1.report;
        let off = &self.plain.1.report;
        assert_eq!(
            (off.flipped_edges, off.collapsed_vertices, off.moved_surface),
            (0, 0, 0.0),
            "nothing was asked for"
        );
        self.assert_other_vertices_are_unchanged();
        assert_eq!(
            pieces(&self.remeshed.0),
            pieces(&self.plain.0),
            "a piece came or went"
        );
        let longest = (self.plain.1.delta.triangles_removed.iter())
            .flat_map(|(_, [a, b, c])| [[a, b], [b, c], [c, a]])
            .map(|[a, b]| (self.before.position(*b) - self.before.position(*a)).norm())
            .fold(0.0, f64::max);
        assert!(
            report.moved_surface <= self.tolerance * longest,
            "{} was moved, to {} of {longest}",
            report.moved_surface,
            self.tolerance
        );
        let worst = |cut: &(Surface, CutOutcome)| {
            let angles = old_surface(cut).map(|t| smallest_angle(&cut.0, t));
            angles.fold(f64::MAX, f64::min)
        };
        let [was, is] = [worst(&self.plain), worst(&self.remeshed)];
        assert!(is >= was * (1.0 - 1e-6), "an angle of {was} became {is}");

        let differing = self.differing();
        let bound = report.moved_surface + self.rounding();
        for (own, other) in differing.iter().zip([&self.remeshed, &self.plain]) {
            let others: Vec<_> = old_surface(other)
                .map(|t| other.0.triangle_positions(t))
                .map(|t| (t, t[0].inf(&t[1]).inf(&t[2]), t[0].sup(&t[1]).sup(&t[2])))
                .collect();
            for point in own.iter().flat_map(samples) {
                let is_near = others.iter().any(|(t, min, max)| {
                    let beyond = (min - point).sup(&(point - max));
                    beyond.max() <= bound && distance(point, t) <= bound
                });
                assert!(
                    is_near,
                    "{point:?} moved by more than the {bound} that are said"
                );
            }
        }
        let area = |triangles: &[[Vec3; 3]]| -> f64 {
            let doubled = triangles.iter().map(|&t| area_vector(t).norm());
            doubled.sum::<f64>() / 2.0
        };
        let area = area(&differing[0]) + area(&differing[1]);
        let moved = (self.remeshed.0.volume() - self.plain.0.volume()).abs();
        let rounding = self.rounding() * self.before.area();
        assert!(
            moved <= bound * area + rounding,
            "a volume of {moved} was moved around the rim, {} at most",
            bound * area
        );
    }

    /// Asserts that triangles without a corner next to the cut are unchanged.
    fn assert_other_vertices_are_unchanged(&self) {
        let touched: BTreeSet<VertexId> = (self.plain.1.delta.triangles_removed.iter())
            .flat_map(|entry| entry.1)
            .collect();
        let (before, after) = (self.before.topology(), self.remeshed.0.topology());
        for t in before.triangles() {
            let corners = before.triangle(t);
            if corners.iter().all(|v| !touched.contains(v)) {
                assert_eq!(after.triangle(t), corners, "{t} is not of the ring");
            }
        }
        for v in before.vertices().filter(|v| !touched.contains(v)) {
            let places = [&self.before, &self.remeshed.0].map(|s| s.positions()[v.index()]);
            assert_eq!(places[0], places[1], "{v} is not of the ring");
        }
    }
}

/// Returns sample points of a triangle.
fn samples([a, b, c]: &[Vec3; 3]) -> impl Iterator<Item = Vec3> {
    let (a, b, c) = (*a, *b, *c);
    let parts = (0..=4).flat_map(|i| (0..=4 - i).map(move |j| (f64::from(i), f64::from(j))));
    parts.map(move |(i, j)| a + (b - a) * (i / 4.0) + (c - a) * (j / 4.0))
}

/// Returns the distance of a point from a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
fn distance(p: Vec3, [a, b, c]: &[Vec3; 3]) -> f64 {
    let on_edge = |a: &Vec3, b: &Vec3| {
        let along = b - a;
        let part = along.dot(&(p - a)) / along.norm_squared();
        let t = if part.is_finite() {
            part.clamp(0.0, 1.0)
        } else {
            0.0
        };
        (p - (a + along * t)).norm()
    };
    let edges = on_edge(a, b).min(on_edge(b, c)).min(on_edge(c, a));
    let normal = area_vector([*a, *b, *c]);
    let is_inside = [[a, b], [b, c], [c, a]]
        .iter()
        .all(|[a, b]| normal.dot(&area_vector([**a, **b, p])) >= 0.0);
    let height = (normal.dot(&(p - a)) / normal.norm()).abs();
    if is_inside && height.is_finite() {
        height.min(edges)
    } else {
        edges
    }
}

fn any_remesh() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.05), Just(0.1), 0.001..0.499_f64]
}

fn any_snap() -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 2 => Just(0.1), 1 => 0.0..0.4_f64]
}

proptest! {
    #![proptest_config(cases(75))]

    #[test]
    fn any_body_and_blade(
        body in any_body(),
        blade in any_blade(),
        level in any_level(),
        snap in any_snap(),
        remesh in any_remesh(),
    ) {
        let before = body.build();
        let Ok(sweep) = blade.sweep(&before) else { return Ok(()) };
        let mut params = remeshing(snap, remesh);
        params.refine.level = level;
        if let Some(twice) = cut_twice(&before, &sweep, &params) {
            twice.check();
        }
    }

    #[test]
    fn self_intersecting_bodies(
        body in self_intersecting_body(),
        blade in any_blade(),
        snap in any_snap(),
        remesh in any_remesh(),
    ) {
        let before = body.build();
        let Ok(sweep) = blade.sweep(&before) else { return Ok(()) };
        let params = remeshing(snap, remesh);
        if let Some(twice) = cut_twice(&before, &sweep, &params) {
            twice.check();
        }
    }

    /// Deformed bodies are cut repeatedly.
    #[test]
    fn deformed_bodies_cut_repeatedly(
        body in any_body(),
        blades in prop::collection::vec((any_blade(), any_snap(), any_remesh()), 1..=4),
        wave in 0.05..0.3_f64,
    ) {
        let mut surface = body.build();
        let vertices: Vec<VertexId> = surface.topology().vertices().collect();
        for v in vertices {
            let p = surface.rest_position(v);
            let bend = Vec3::new(1.0 + p.y * p.z, (3.0 * p.x).sin() - 2.0, 1.0 + p.x * p.x) * wave;
            let [x, y, z] = incise_mesh::geometry::to_f32(p + bend);
            surface.positions_mut()[v.index()] = [x, y, z, 1.0];
        }
        for (blade, snap, remesh) in blades {
            let Ok(sweep) = blade.sweep(&surface) else { continue };
            let params = remeshing(snap, remesh);
            if let Some(twice) = cut_twice(&surface, &sweep, &params) {
                twice.check();
                surface = twice.remeshed.0;
            }
        }
    }
}

/// Counts triangles outside of caps with a corner on the rim and an angle below `degrees`.
fn slivers(cut: &(Surface, CutOutcome), degrees: f64) -> usize {
    let (surface, outcome) = cut;
    let topology = surface.topology();
    let caps = outcome.cap.iter().flat_map(|&t| topology.triangle(t));
    let rim: BTreeSet<VertexId> = caps.collect();
    let near = |t: &TriangleId| topology.triangle(*t).iter().any(|v| rim.contains(v));
    let own = old_surface(cut).filter(near);
    own.filter(|&t| smallest_angle(surface, t) < degrees)
        .count()
}

#[test]
fn slivers_are_rare() {
    for (model, share) in [
        (Model::Bunny, 0.5),
        // Almost all edges of its arms are sharp features.
        (Model::Octopus, 0.85),
        (Model::Banana, 0.35),
        (Model::Armadillo, 0.6),
    ] {
        let whole = build_model(model);
        let planes = Planes {
            whole: &whole,
            is_embedded: false,
            all_invariants: false,
        };
        let mut sums = [0, 0];
        for i in 0..24 {
            let sweep = planes.sweep(i).expect("the model has a size");
            for (sum, remesh) in sums.iter_mut().zip([0.0, 0.1]) {
                let params = CutParams {
                    remesh,
                    ..CutParams::default()
                };
                let mut surface = whole.clone();
                let cut = Cutter::new(&whole).cut(&mut surface, &sweep, &params);
                let outcome = cut.expect("a full slice");
                *sum += slivers(&(surface, outcome), 10.0);
            }
        }
        let [was, is] = sums.map(|n| n as f64);
        assert!(
            is <= share * was,
            "{is} of {was} slivers are left in the {model:?}"
        );
    }
}

/// Crossing loops of a section have separate caps.
///
/// Merging rim vertices could separate loops that barely cross; a common cap would then join
/// pieces.
#[test]
fn crossing_loops_join_no_pieces() {
    let ball = icosphere(4, 0.5);
    let mut random = 1u64;
    let mut noise = || {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (random >> 40) as f64 / f64::from(1u32 << 24) - 0.5
    };
    let mut whole = ball.clone();
    for v in ball.topology().vertices() {
        let moved = ball.position(v) + Vec3::new(noise(), noise(), noise()) * 0.1;
        let [x, y, z] = incise_mesh::geometry::to_f32(moved);
        whole.positions_mut()[v.index()] = [x, y, z, 1.0];
        whole.rest_positions_mut()[v.index()] = [x, y, z];
    }
    let mut loops = 0;
    for _ in 0..150 {
        let normal = [noise(), noise(), noise()];
        let sweep = Sweep::from_plane(normal, 0.2 * noise(), &whole.bounds()).expect("a plane");
        let cut = |remesh| {
            let params = CutParams {
                remesh,
                ..CutParams::default()
            };
            let mut surface = whole.clone();
            let outcome = Cutter::new(&whole).cut(&mut surface, &sweep, &params);
            outcome
                .ok()
                .map(|outcome| (pieces(&surface), outcome.report.loops))
        };
        let plain = cut(0.0);
        loops = loops.max(plain.map_or(0, |(_, loops)| loops));
        for remesh in [0.01, 0.1] {
            assert_eq!(cut(remesh), plain, "{sweep:?} and {remesh}");
        }
    }
    assert!(loops > 5, "at most {loops} loops");
}
