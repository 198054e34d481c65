//! Incisions that cross each other or themselves: number of triangles, partners of walls, volumes
//! and undo.

use crate::common::{check, params, shortest_edge};
use incise_cut::{CutParams, Cutter, Incision, Sweep};
use incise_mesh::geometry::{area_vector, to_f32};
use incise_mesh::{AngleStats, HalfEdge, Surface, TriangleId, Vec3, VertexId, icosphere};
use std::collections::BTreeMap;

/// Random unit vectors, by a linear congruential generator.
struct Directions(u64);

impl Directions {
    fn next_unit(&mut self) -> Vec3 {
        let mut part = || {
            self.0 = (self.0)
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            f64::from(u32::try_from(self.0 >> 32).unwrap()) / f64::from(u32::MAX)
        };
        // Archimedes: the height of a point on the sphere is uniform.
        let (height, angle) = (2.0 * part() - 1.0, std::f64::consts::TAU * part());
        let radius = (1.0 - height * height).sqrt();
        Vec3::new(radius * angle.cos(), radius * angle.sin(), height)
    }
}

/// Returns a sweep from one side of a ball of radius 0.5 to its middle, in a random plane.
fn slit(random: &mut Directions) -> Sweep {
    let along = random.next_unit();
    let inward = random.next_unit().cross(&along).normalize();
    let offset = random.next_unit() * 0.05;
    let pose = |depth: f64| [-1.0, 1.0].map(|s| to_f32(offset + along * s + inward * depth));
    Sweep::new(pose(-1.0), pose(0.05)).unwrap()
}

fn walls(surface: &Surface) -> impl Iterator<Item = TriangleId> + '_ {
    let wall = CutParams::default().cap_material;
    let triangles = surface.topology().triangles();
    triangles.filter(move |&t| surface.material(t) == wall)
}

/// Returns the number of wall triangles without a partner: one with equal rest positions in the
/// opposite order.
fn lone_walls(surface: &Surface) -> usize {
    let key = |t: TriangleId, is_mirrored: bool| {
        let mut corners = (surface.topology().triangle(t))
            .map(|v| surface.rest_positions()[v.index()].map(f32::to_bits));
        if is_mirrored {
            corners.swap(1, 2);
        }
        let least = (0..3).min_by_key(|&k| corners[k]).unwrap();
        corners.rotate_left(least);
        corners
    };
    let mut counts: BTreeMap<_, i32> = BTreeMap::new();
    for t in walls(surface) {
        *counts.entry(key(t, false)).or_default() += 1;
    }
    let is_lone = |&t: &TriangleId| counts.get(&key(t, true)) != counts.get(&key(t, false));
    walls(surface).filter(is_lone).count()
}

fn rest(surface: &Surface, t: TriangleId) -> [Vec3; 3] {
    let corners = surface.topology().triangle(t);
    corners.map(|v| surface.rest_position(v))
}

/// Returns the number of vertices that are neither in a plane nor along a straight crease, within
/// 0.8 degrees.
fn corner_count(surface: &Surface) -> usize {
    const COSINE: f64 = 0.9999;
    let topology = surface.topology();
    let normal = |h: HalfEdge| area_vector(rest(surface, h.triangle()));
    let is_corner = |&v: &VertexId| {
        let fan = topology.outgoing_fan(v);
        let creases = fan.filter(|&h| {
            let [m, n] = [h, topology.twin(h)].map(normal);
            m.dot(&n) <= COSINE * m.norm() * n.norm()
        });
        let way = |h| surface.rest_position(topology.target(h)) - surface.rest_position(v);
        let ways: Vec<Vec3> = creases.map(|h| way(h).normalize()).collect();
        match ways[..] {
            [] => false,
            [a, b] => a.dot(&b) > -COSINE,
            _ => true,
        }
    };
    let used = topology.vertices();
    used.filter(|&v| !topology.outgoing(v).is_null())
        .filter(is_corner)
        .count()
}

/// Twenty slits through the middle leave at most twice the triangles that the corners of their
/// arrangement and the area of the walls need. All walls stay mirror images, no edge is without
/// length, and a body at rest stays at rest.
#[test]
fn crossing_slits_leave_few_triangles() {
    for snap in [0.0, 0.1] {
        let mut body = icosphere(2, 0.5);
        let (volume, target) = (body.volume(), body.mean_edge_length());
        let mut cutter = Cutter::new(&body);
        let mut random = Directions(3);
        for i in 0..20 {
            let before = body.clone();
            let sweep = slit(&mut random);
            let outcome = cutter.incise(&mut body, &sweep, &params(snap)).unwrap();
            check(&body);
            cutter.bvh().validate(&body).unwrap();
            assert_eq!(lone_walls(&body), 0, "snap {snap}, slit {i}");
            let mut shapes = body.positions().iter().zip(body.rest_positions());
            let is_at_rest = |(position, rest): (&[f32; 4], &[f32; 3])| position[..3] == *rest;
            assert!(shapes.all(is_at_rest), "snap {snap}, slit {i}");
            assert!(shortest_edge(&body) > 0.0, "snap {snap}, slit {i}");
            let error = (body.volume() / volume - 1.0).abs();
            assert!(error < if snap == 0.0 { 1e-6 } else { 2e-3 }, "{error}");
            let mut undone = body.clone();
            outcome.undo.unwrap().revert(&mut undone).unwrap();
            assert_eq!(undone, before, "the undo restores every bit");
        }
        let triangles = || walls(&body).map(|t| rest(&body, t));
        let area: f64 = triangles().map(|t| area_vector(t).norm() / 2.0).sum();
        let count = body.topology().triangle_count() as f64;
        let needed = 2.0 * corner_count(&body) as f64 + area / target.powi(2);
        assert!(count < 2.0 * needed, "snap {snap}: {count} of {needed}");
        let angle = AngleStats::from_triangles(triangles()).percentile_5;
        assert!(angle > 9.0, "snap {snap}: {angle} degrees");
    }
}

/// A slit in 110 steps has less than twice the wall triangles of the same slit in one.
///
/// Rim points between steps go where the skin is flat.
#[test]
fn a_slit_in_steps_has_few_walls() {
    // Poses at a distance behind the middle; the blade comes from negative ones.
    let pose = |depth: f32| [-1.0, 1.0].map(|y| [0.01 + 0.1 * y, y, depth]);
    for has_normals in [false, true] {
        let mut whole = icosphere(2, 0.5);
        if !has_normals {
            whole.set_corner_normals(Vec::new()).unwrap();
        }
        let mut body = whole.clone();
        let sweep = Sweep::new(pose(-1.0), pose(0.05)).unwrap();
        let outcome = Cutter::new(&body).incise(&mut body, &sweep, &params(0.1));
        assert!(outcome.is_ok());
        let once = walls(&body).count();
        let mut body = whole.clone();
        let (mut cutter, mut incision) = (Cutter::new(&body), Incision::default());
        for step in 0..=110u8 {
            let depth = -0.7 + 0.75 * f32::from(step) / 110.0;
            let outcome = cutter.advance(&mut body, &mut incision, &pose(depth), &params(0.1));
            assert!(outcome.is_ok(), "step {step}");
        }
        check(&body);
        assert_eq!(lone_walls(&body), 0);
        let count = walls(&body).count();
        assert!(count < 2 * once, "{count} and {once}");
    }
}

/// Ends of the curves of a circling blade move on both walls of its slit.
#[test]
fn walls_of_a_circling_blade_keep_their_partners() {
    let mut body = icosphere(2, 0.5);
    let volume = body.volume();
    let (mut cutter, mut incision) = (Cutter::new(&body), Incision::default());
    for step in 0..=170u8 {
        let (sin, cos) = (0.0623 * f64::from(step)).sin_cos();
        let lift = if step == 0 { 0.7 } else { 0.0 };
        let pose = [0.0, 1.0].map(|y| to_f32(Vec3::new(0.2 * cos, y + lift, 0.2 * sin)));
        let outcome = cutter.advance(&mut body, &mut incision, &pose, &params(0.1));
        assert!(outcome.is_ok(), "step {step}: {outcome:?}");
        assert_eq!(lone_walls(&body), 0, "step {step}");
    }
    check(&body);
    assert!((body.volume() / volume - 1.0).abs() < 1e-4);
    assert!(body.topology().triangle_count() < 3000);
}

/// A blade that circles 1,000 frames on a cylinder through a ball cuts on its first lap, and at
/// most until it has crossed its start.
///
/// Radii, turns per frame, and drifts of the radius by up to a hundredth of an edge in a lap.
#[test]
fn a_blade_that_circles_cuts_once() {
    let circles = [
        (0.2, 0.0623, 0.0, 0.1),
        (0.1, 0.0623, 0.0, 0.0),
        (0.15, 0.1, 0.0, 0.1),
        (0.1, 0.5, 2e-5, 0.0),
        (0.2, 0.5, -2e-4, 0.1),
    ];
    for (radius, turn, drift, snap) in circles {
        let mut body = icosphere(2, 0.5);
        let count = body.topology().triangle_count();
        let volume = body.volume();
        let (mut cutter, mut incision) = (Cutter::new(&body), Incision::default());
        for frame in 0..=1000u16 {
            let angle = turn * f64::from(frame);
            let (sin, cos) = angle.sin_cos();
            let radius = radius + drift * angle;
            let out = if frame == 0 { 1.0 } else { 0.0 };
            let pose = [-1.0, 1.0].map(|y| to_f32(Vec3::new(radius * cos - out, y, radius * sin)));
            let before = body.clone();
            let outcome = cutter.advance(&mut body, &mut incision, &pose, &params(snap));
            let Some(undo) = outcome.unwrap().undo else {
                continue;
            };
            check(&body);
            assert_eq!(lone_walls(&body), 0, "{radius}, frame {frame}");
            let mut undone = body.clone();
            undo.revert(&mut undone).unwrap();
            assert_eq!(undone, before, "the undo restores every bit");
        }
        let error = (body.volume() / volume - 1.0).abs();
        let bound = if snap == 0.0 { 1e-6 } else { 2e-3 };
        assert!(error < bound, "{radius}: {error}");
        let mut pieces = body.piece_volumes();
        pieces.sort_by(f64::total_cmp);
        let free: f64 = pieces.iter().rev().skip(1).sum();
        let inscribed =
            0.8 * std::f64::consts::PI * (radius * radius) * 2.0 * (0.25 - radius * radius).sqrt();
        assert!(free > inscribed, "{radius}: {pieces:?}");
        let circling = body.topology().triangle_count();
        assert!(circling < 20 * count, "{radius}: {circling}");
    }
}
