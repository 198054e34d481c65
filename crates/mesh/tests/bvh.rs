//! Queries of a BVH (planes, rays, nearest points), compared with brute force.

use incise_mesh::{
    Aabb, Bvh, MotionBounds, MovingPoint, Surface, TriangleId, Vec3, VertexId, cube_sphere,
    index_u32, torus,
};
use nalgebra::Matrix3;
use proptest::prelude::*;

/// Returns every triangle that straddles the plane, and every triangle whose box meets it.
fn on_plane(surface: &Surface, n: Vec3, d: f64) -> (Vec<TriangleId>, Vec<TriangleId>) {
    let (mut straddles, mut reaches) = (Vec::new(), Vec::new());
    for t in surface.topology().triangles() {
        let corners = surface.triangle_positions(t);
        let heights = corners.map(|p| n.dot(&p) - d);
        if heights.iter().any(|&h| h > 1e-6) && heights.iter().any(|&h| h < -1e-6) {
            straddles.push(t);
        }
        let [low, high] = [f64::min, f64::max]
            .map(|pick| Vec3::from_fn(|k, _| corners.iter().map(|p| p[k]).reduce(pick).unwrap()));
        let reach = n.abs().dot(&((high - low) / 2.0));
        if (n.dot(&((high + low) / 2.0)) - d).abs() <= reach + 1e-6 {
            reaches.push(t);
        }
    }
    (straddles, reaches)
}

proptest! {
    #[test]
    fn a_query_finds_all_and_little_more(
        n in [-1.0f64..1.0, -1.0..1.0, -1.0..1.0],
        d in -1.5f64..1.5,
        push in [0.01f32..0.3, 0.01..0.3, 0.01..0.3],
    ) {
        prop_assume!(Vec3::from(n).norm() > 0.1);
        let mut surface = torus(1.0, 0.4, 40, 20);
        let mut bvh = Bvh::build(&surface);
        bvh.validate(&surface).unwrap();
        for (i, p) in surface.positions_mut().iter_mut().enumerate() {
            p[i % 3] += push[i % 3];
        }
        prop_assert!(bvh.validate(&surface).is_err(), "boxes are stale");
        bvh.refit(&surface);
        bvh.validate(&surface).unwrap();
        let normal = Vec3::from(n).normalize();
        let (u, size) = (normal.cross(&Vec3::ith(normal.iamin(), 1.0)).normalize(), 10.0);
        let corner = |s: f64, t: f64| normal * d + (u * s + normal.cross(&u) * t) * size;
        let plane = [[corner(-2.0, -1.0), corner(2.0, -1.0), corner(0.0, 2.0)]];
        let mut found = Vec::new();
        bvh.query(&surface, plane, &mut found);
        found.sort_unstable();
        let (straddles, reaches) = on_plane(&surface, normal, d);
        prop_assert!(straddles.iter().all(|t| found.binary_search(t).is_ok()));
        prop_assert!(found.iter().all(|t| reaches.binary_search(t).is_ok()));
    }
}

#[test]
fn an_empty_surface_has_an_empty_tree() {
    let surface = Surface::default();
    let bvh = Bvh::build(&surface);
    bvh.validate(&surface).unwrap();
    let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vec3::from);
    let mut found = Vec::new();
    bvh.query(&surface, [triangle], &mut found);
    assert!(found.is_empty());
}

/// Returns the nearest hit of a ray by solving for each triangle.
fn nearest_crossing(surface: &Surface, origin: Vec3, direction: Vec3) -> Option<(f64, TriangleId)> {
    let mut best: Option<(f64, TriangleId)> = None;
    for t in surface.topology().triangles() {
        let [a, b, c] = surface.triangle_positions(t);
        let matrix = Matrix3::from_columns(&[b - a, c - a, -direction]);
        let Some(inverse) = matrix.try_inverse() else {
            continue;
        };
        let solution = inverse * (origin - a);
        let (u, v, way) = (solution.x, solution.y, solution.z);
        if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && way >= 0.0 && best.is_none_or(|b| way < b.0) {
            best = Some((way, t));
        }
    }
    best
}

proptest! {
    #[test]
    fn a_ray_hits_the_nearest_triangle(
        origin in [-2.0f64..2.0, -2.0..2.0, -2.0..2.0],
        direction in [-1.0f64..1.0, -1.0..1.0, -1.0..1.0],
    ) {
        let surface = torus(1.0, 0.4, 24, 12);
        let bvh = Bvh::build(&surface);
        let (origin, direction) = (Vec3::from(origin), Vec3::from(direction));
        prop_assume!(direction.norm() > 0.1);
        let hit = bvh.cast(&surface, origin, direction, |_| true);
        let expected = nearest_crossing(&surface, origin, direction);
        match (hit, expected) {
            (None, None) => {}
            (Some(hit), Some((way, _))) => {
                prop_assert!((hit.distance - way).abs() < 1e-9, "{hit:?}, not {way}");
                let corners = surface.triangle_positions(hit.triangle);
                let at: Vec3 = corners.iter().zip(hit.weights).map(|(p, w)| p * w).sum();
                prop_assert!((at - (origin + direction * way)).norm() < 1e-9);
                let [a, b, c] = corners;
                let normal = (b - a).cross(&(c - a));
                prop_assert_eq!(hit.from_inside, normal.dot(&direction) > 0.0);
            }
            (hit, expected) => prop_assert!(false, "{hit:?}, not {expected:?}"),
        }
    }

    /// Rays to vertices and edges of a body hit it from outside.
    #[test]
    fn a_ray_through_an_edge_hits(from in [-3i8..=3, -3i8..=3], axis in 0usize..3) {
        let surface = cube_sphere(4, 1.0);
        let bvh = Bvh::build(&surface);
        let mut origin = Vec3::repeat(-5.0);
        origin[(axis + 1) % 3] = f64::from(from[0]) / 8.0;
        origin[(axis + 2) % 3] = f64::from(from[1]) / 8.0;
        let mut direction = Vec3::zeros();
        direction[axis] = 1.0;
        let hit = bvh.cast(&surface, origin, direction, |_| true);
        prop_assert!(hit.is_some_and(|hit| !hit.from_inside), "{hit:?}");
    }
}

proptest! {
    #[test]
    fn the_nearest_point_is_nearest_and_on_the_right_side(
        to in [-2.0f64..2.0, -2.0..2.0, -1.0..1.0],
        reach in 0.05f64..1.5,
    ) {
        let surface = torus(1.0, 0.4, 24, 12);
        let bvh = Bvh::build(&surface);
        let to = Vec3::from(to);
        let found = bvh.nearest(&surface, to, reach, |_| true);
        // A fine grid over every triangle.
        let mut expected = f64::INFINITY;
        for t in surface.topology().triangles() {
            let [a, b, c] = surface.triangle_positions(t);
            for i in 0..=16 {
                for j in 0..=16 - i {
                    let (u, v) = (f64::from(i) / 16.0, f64::from(j) / 16.0);
                    expected = expected.min((a * (1.0 - u - v) + b * u + c * v - to).norm());
                }
            }
        }
        match found {
            None => prop_assert!(expected > reach - 1e-9, "{expected} within {reach}"),
            Some(found) => {
                let distance = found.distance.abs();
                prop_assert!(distance <= expected + 1e-9 && distance <= reach + 1e-9);
                prop_assert!(expected < distance + 0.02, "the grid is that fine");
                let corners = surface.triangle_positions(found.triangle);
                let at: Vec3 = corners.iter().zip(found.weights).map(|(p, w)| p * w).sum();
                prop_assert!((at - found.point).norm() < 1e-12);
                prop_assert!(((to - at).norm() - distance).abs() < 1e-12);
                // A point is inside if a ray from it crosses the surface an odd number of times.
                let way = Vec3::new(0.31, 0.73, 0.52);
                let mut crossings = 0;
                for t in surface.topology().triangles() {
                    crossings += i32::from(bvh.cast(&surface, to, way, |s| s == t).is_some());
                }
                if distance > 1e-6 {
                    prop_assert_eq!(found.distance < 0.0, crossings % 2 == 1);
                }
            }
        }
    }
}

proptest! {
    /// Compares motions, an excluded piece and a first guess with a search over all triangles.
    #[test]
    fn the_nearest_in_reach_equals_brute_force(
        to in [-1.6f32..1.6, -1.6..1.6, -0.6..0.6],
        own in [-0.3f32..0.3, -0.3..0.3, -0.3..0.3],
        margin in 0.0f64..0.2,
        seed in 0u32..1000,
    ) {
        let mut surface = torus(1.0, 0.4, 24, 12);
        let triangles: Vec<TriangleId> = surface.topology().triangles().collect();
        for &t in &triangles {
            let [a, _, _] = surface.triangle_positions(t);
            surface.set_piece(t, u32::from(a.x > 0.03) + 2 * u32::from(a.y > -0.02));
        }
        prop_assert_eq!(surface.piece_count(), 4);
        let bvh = Bvh::build(&surface);
        let displacements: Vec<[f32; 3]> = (0..index_u32(surface.positions().len()))
            .map(|i| {
                let random = |k: u32| i.wrapping_mul(2_654_435_761) ^ (seed + k).wrapping_mul(97);
                let along = |k: u32| (random(k) % 64) as f32 / 256.0 - 0.125;
                [along(0), along(1), along(2)]
            })
            .collect();
        let mut bounds = MotionBounds::default();
        bounds.find(&bvh, &surface, &displacements);
        for piece in 0..4 {
            let at = Vec3::from(to.map(f64::from));
            let found = bvh.nearest_of_pieces(&surface, at, &bounds, |p| p == piece);
            let is_own = |t| surface.piece(t) == piece;
            prop_assert_eq!(found, bvh.nearest(&surface, at, f64::INFINITY, is_own));
        }
        for excluded_piece in [None, Some(1), Some(2)] {
            let counts = |t: TriangleId| !t.0.is_multiple_of(3);
            let point = MovingPoint {
                position: Vec3::from(to.map(f64::from)),
                displacement: own,
                margin,
                excluded_piece,
            };
            let is_in_reach = |t: TriangleId, distance: f64| {
                let corners = surface.topology().triangle(t).map(|v| v.index());
                let all = corners.map(|i| displacements[i]);
                let motion = [0, 1, 2].map(|k| {
                    let along = all.iter().map(|d: &[f32; 3]| d[k].abs());
                    along.fold(0.0, f32::max)
                });
                let at = corners.map(|i| surface.positions()[i]);
                let around = Aabb::around(at.map(|[x, y, z, _]| [x, y, z]));
                let relative: f32 = (0..3)
                    .map(|k| (2.0 * (own[k].abs() + motion[k])).powi(2))
                    .sum();
                // Positions have 32 bits.
                let radius = margin + f64::from(relative.sqrt());
                (point.reaches(&around, motion), distance - radius)
            };
            let others = triangles.iter().copied();
            let others =
                others.filter(|&t| counts(t) && Some(surface.piece(t)) != excluded_piece);
            let each: Vec<f64> = others
                .filter_map(|t| {
                    let found = bvh.nearest(&surface, point.position, f64::MAX, |o| o == t)?;
                    let distance = found.distance.abs();
                    let (is_near, beyond) = is_in_reach(t, distance);
                    (is_near && beyond <= 1e-6).then_some(distance)
                })
                .collect();
            let expected = each.into_iter().min_by(f64::total_cmp);
            for first in [None, Some(TriangleId(seed)), Some(TriangleId(seed / 3))] {
                let found = bvh.nearest_in_reach(&surface, &point, &bounds, first, counts);
                let found = found.map(|found| found.distance.abs());
                prop_assert_eq!(found.is_some(), expected.is_some());
                let off = found.zip(expected).map_or(0.0, |(a, b)| (a - b).abs());
                prop_assert!(off < 1e-9, "{found:?}, not {expected:?}");
            }
        }
    }
}

#[test]
fn the_opposite_vertex_of_a_ball_is_the_antipode() {
    let surface = cube_sphere(8, 1.0);
    let bvh = Bvh::build(&surface);
    for v in surface.topology().vertices() {
        let other = bvh
            .opposite_vertex(&surface, v)
            .expect("a ball has two sides");
        let gap = (surface.position(v) + surface.position(other)).norm();
        assert!(gap < 0.15, "{other} is {gap} m beside the antipode of {v}");
    }
    assert_eq!(bvh.opposite_vertex(&surface, VertexId::NULL), None);
}

#[test]
fn a_sheet_has_no_opposite_vertex() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let surface = Surface::from_triangles(&corners, &[[0, 1, 2]]).unwrap();
    let bvh = Bvh::build(&surface);
    assert_eq!(bvh.opposite_vertex(&surface, VertexId(0)), None);
}

/// Returns the winding number of a point: the solid angle of all triangles over that of a sphere.
///
/// Van Oosterom and Strackee 1983, "The solid angle of a plane triangle".
fn by_solid_angle(surface: &Surface, at: Vec3) -> f64 {
    let angle = |t: TriangleId| {
        let [a, b, c] = surface.triangle_positions(t).map(|p| p - at);
        let [la, lb, lc] = [a, b, c].map(|p| p.norm());
        let cosine = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
        2.0 * a.dot(&b.cross(&c)).atan2(cosine)
    };
    let sum: f64 = surface.topology().triangles().map(angle).sum();
    sum / (4.0 * std::f64::consts::PI)
}

proptest! {
    /// The torus is bent until it intersects itself, and turned inside out by a negative scale.
    #[test]
    fn the_winding_number_is_the_solid_angle(
        at in [-1.5f64..1.5, -1.5..1.5, -0.8..0.8],
        bend in 0.0f32..6.0,
        scale in prop_oneof![Just(1.0f32), Just(-1.0)],
    ) {
        let mut surface = torus(1.0, 0.4, 24, 12);
        for p in surface.positions_mut() {
            let [x, y, z, w] = *p;
            *p = [x + 0.5 * (bend * z).sin(), y + 0.5 * (bend * x).sin(), scale * z, w];
        }
        let bvh = Bvh::build(&surface);
        let at = Vec3::from(at);
        let near = bvh.nearest(&surface, at, 1e-6, |_| true);
        prop_assume!(near.is_none());
        let found = bvh.winding_number(&surface, at, |_| true);
        let expected = by_solid_angle(&surface, at);
        prop_assert!((f64::from(found) - expected).abs() < 1e-6, "{found}, not {expected}");
    }
}
