//! Rays through a body against looking at every triangle, and a way against a sweep.

use incise_cut::{Bvh, CutParams, Cutter, NodeReaches, Sweep};
use incise_mesh::{Aabb, Surface, TriangleId, Vec3, VertexId, cube_sphere, torus};
use proptest::prelude::*;

/// The nearest crossing by solving for it, of triangles that are met well inside.
fn brute_force(surface: &Surface, origin: Vec3, direction: Vec3) -> Option<(f64, TriangleId)> {
    let mut best: Option<(f64, TriangleId)> = None;
    for t in surface.topology().triangles() {
        let [a, b, c] = surface.triangle_positions(t);
        let matrix = nalgebra_columns(b - a, c - a, -direction);
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

type Matrix = nalgebra::Matrix3<f64>;

fn nalgebra_columns(a: Vec3, b: Vec3, c: Vec3) -> Matrix {
    Matrix::from_columns(&[a, b, c])
}

proptest! {
    #[test]
    fn a_ray_hits_what_is_nearest(
        origin in [-2.0f64..2.0, -2.0..2.0, -2.0..2.0],
        direction in [-1.0f64..1.0, -1.0..1.0, -1.0..1.0],
    ) {
        let surface = torus(1.0, 0.4, 24, 12);
        let bvh = Bvh::build(&surface);
        let (origin, direction) = (Vec3::from(origin), Vec3::from(direction));
        prop_assume!(direction.norm() > 0.1);
        let hit = bvh.cast(&surface, origin, direction, |_| true);
        let expected = brute_force(&surface, origin, direction);
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

    /// Through vertices and edges of a body whose coordinates are few: whatever a ray meets there, it gets into the body
    /// and out of it.
    #[test]
    fn nothing_slips_through(from in [-3i8..=3, -3i8..=3], axis in 0usize..3) {
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

    #[test]
    fn a_way_meets_a_flat_sweep_if_its_ends_are_on_both_sides(
        from in [-1.0f32..1.0, -1.0..1.0, -1.0..1.0],
        to in [-1.0f32..1.0, -1.0..1.0, -1.0..1.0],
        n in [-1.0f64..1.0, -1.0..1.0, -1.0..1.0],
        d in -0.5f64..0.5,
    ) {
        let normal = Vec3::from(n);
        prop_assume!(normal.norm() > 0.1);
        let bounds = Aabb { min: [-1.0; 3], max: [1.0; 3] };
        let sweep = Sweep::across_box(n, d * normal.norm(), &bounds).unwrap();
        let side = |p: [f32; 3]| normal.dot(&Vec3::from(p.map(f64::from))) / normal.norm() - d;
        let (a, b) = (side(from), side(to));
        prop_assume!(a.abs() > 1e-5 && b.abs() > 1e-5);
        prop_assert_eq!(sweep.meets(from, to), (a < 0.0) != (b < 0.0));
        prop_assert_eq!(sweep.meets(to, from), sweep.meets(from, to));
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
                // An odd number of crossings along any way out is inside.
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
    /// What is farther than its own reach is not found, nor what is of the piece that is left out, and a good guess changes nothing.
    #[test]
    fn the_nearest_in_reach_is_that_of_all_triangles_one_by_one(
        to in [-1.6f64..1.6, -1.6..1.6, -0.6..0.6],
        more in 0.0f64..0.2,
        seed in 0u32..1000,
    ) {
        let mut surface = torus(1.0, 0.4, 24, 12);
        let mut cutter = Cutter::new(&surface);
        for (normal, d) in [([1.0, 0.2, 0.1], 0.03), ([0.1, 1.0, 0.2], -0.02)] {
            let sweep = Sweep::across_box(normal, d, &surface.bounds()).unwrap();
            cutter.cut(&mut surface, &sweep, &CutParams::default()).unwrap();
        }
        prop_assert_eq!(surface.piece_count(), 4);
        let bvh = cutter.bvh();
        let to = Vec3::from(to);
        let own = |t: TriangleId| {
            f64::from((t.0.wrapping_mul(2_654_435_761) ^ seed.wrapping_mul(97)) % 64) / 256.0
        };
        let mut reaches = NodeReaches::default();
        reaches.find(bvh, &surface, own);
        let counts = |t: TriangleId| !t.0.is_multiple_of(3);
        for but in [None, Some(1), Some(2)] {
            let others = surface.topology().triangles();
            let others = others.filter(|&t| counts(t) && Some(surface.piece(t)) != but);
            let each = others.filter_map(|t| {
                let found = bvh.nearest(&surface, to, own(t) + more, |other| other == t)?;
                Some(found.distance.abs())
            });
            let expected = each.min_by(f64::total_cmp);
            for first in [None, Some(TriangleId(seed)), Some(TriangleId(seed / 3))] {
                let search = (&reaches, but);
                let found = bvh.nearest_in_reach(&surface, (to, more), search, first, counts);
                let found = found.map(|found| found.distance.abs());
                prop_assert_eq!(found.is_some(), expected.is_some());
                let off = found.zip(expected).map_or(0.0, |(a, b)| (a - b).abs());
                prop_assert!(off < 1e-9, "{found:?}, not {expected:?}");
            }
        }
    }
}

#[test]
fn a_way_beside_a_sweep_or_before_it_misses() {
    let sweep = Sweep::new(
        [[0.0; 3], [1.0, 0.0, 0.0]],
        [[0.0, 1.0, 0.0], [1.0, 1.0, 0.5]],
    );
    let sweep = sweep.unwrap();
    let through = |x: f32, y: f32| sweep.meets([x, y, -2.0], [x, y, 2.0]);
    assert!(through(0.2, 0.5) && through(0.8, 0.5), "both triangles");
    assert!(through(0.5, 0.5), "the crease");
    assert!(through(0.0, 0.0) && through(1.0, 0.5), "the border");
    assert!(!through(1.1, 0.5) && !through(0.5, -0.1), "beside it");
    assert!(!sweep.meets([0.5, 0.2, 1.0], [0.5, 0.2, 2.0]), "before it");
}

#[test]
fn the_vertex_across_a_ball_is_the_one_opposite() {
    let surface = cube_sphere(8, 1.0);
    let bvh = Bvh::build(&surface);
    for v in surface.topology().vertices() {
        let other = bvh.across(&surface, v).expect("a ball has two sides");
        let gap = (surface.position(v) + surface.position(other)).norm();
        assert!(gap < 0.15, "{other} is {gap} m beside the antipode of {v}");
    }
    assert_eq!(bvh.across(&surface, VertexId::NULL), None);
}

#[test]
fn a_sheet_has_no_other_side() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let surface = Surface::from_triangles(&corners, &[[0, 1, 2]]).unwrap();
    let bvh = Bvh::build(&surface);
    assert_eq!(bvh.across(&surface, VertexId(0)), None);
}
