//! Invariants of section meshes over random loops.

use super::sections::{
    RandomEdges, Shape, check_any, check_clean, check_no_duplicate_edges, corners, cross,
    polygon_area, run, run_with_edges,
};
use incise_refine::{SectionMeshParams, SectionMeshScratch, SectionMeshSize, triangulate_section};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// Returns a star-shaped loop around `center`, clockwise for a hole.
pub(crate) fn star(center: [f64; 2], radii: &[f64], hole: bool) -> Vec<[f64; 2]> {
    let n = radii.len();
    let mut points: Vec<[f64; 2]> = radii
        .iter()
        .enumerate()
        .map(|(i, r)| {
            let a = i as f64 * TAU / n as f64;
            [center[0] + r * a.cos(), center[1] + r * a.sin()]
        })
        .collect();
    if hole {
        points.reverse();
    }
    points
}

/// A loop with a hole, an island with a hole in that hole, and beside it a loop with a hole.
pub(crate) fn nested() -> impl Strategy<Value = Shape> {
    let radii = |from: f64, to: f64| prop::collection::vec(from..to, 5..40);
    (
        radii(8.0, 10.0),
        radii(4.0, 5.0),
        radii(2.0, 3.5),
        radii(0.3, 1.5),
        radii(0.2, 1.2),
        -0.5f64..0.5,
    )
        .prop_map(|(a, b, c, d, e, shift)| {
            let mut shape = Shape::default();
            shape.add(star([0.0, shift], &a, false));
            shape.add(star([0.1, shift], &b, true));
            shape.add(star([0.0, shift], &c, false));
            shape.add(star([0.1, shift], &d, true));
            shape.add(star([14.0, shift], &e, false));
            shape.add(star(
                [6.3, shift],
                &e.iter().map(|r| r * 0.5).collect::<Vec<_>>(),
                true,
            ));
            shape
        })
}

/// Random loops, which may cross themselves and each other.
pub(crate) fn any_loops() -> impl Strategy<Value = Shape> {
    let points = prop::collection::vec([-1.0f64..1.0, -1.0..1.0], 3..24);
    prop::collection::vec(points, 1..5).prop_map(shape_of)
}

/// Random loops on a 5 x 5 grid, with duplicate points, spikes and shared edges.
pub(crate) fn grid_loops() -> impl Strategy<Value = Shape> {
    let points = prop::collection::vec([-2i32..3, -2i32..3], 3..16);
    prop::collection::vec(points, 1..6).prop_map(|loops| {
        let to_f64 = |points: Vec<[i32; 2]>| points.into_iter().map(|p| p.map(f64::from));
        shape_of(loops.into_iter().map(to_f64))
    })
}

fn shape_of<P: IntoIterator<Item = [f64; 2]>>(loops: impl IntoIterator<Item = P>) -> Shape {
    let mut shape = Shape::default();
    for points in loops {
        shape.add(points);
    }
    shape
}

/// Random edges of a surrounding surface.
pub(crate) fn random_edges() -> impl Strategy<Value = RandomEdges> {
    (any::<u32>(), 1u32..4).prop_map(|(salt, quarters)| RandomEdges { salt, quarters })
}

/// Returns whether no two loops cross; those of [`nested`] with few points may.
pub(crate) fn is_clean(shape: &Shape) -> bool {
    let edges: Vec<[[f64; 2]; 2]> = (0..shape.loops.len())
        .flat_map(|i| {
            let p = shape.loop_points(i);
            (0..p.len())
                .map(move |k| [p[k], p[(k + 1) % p.len()]])
                .collect::<Vec<_>>()
        })
        .collect();
    edges.iter().enumerate().all(|(i, [a, b])| {
        edges[..i].iter().all(|[c, d]| {
            [a, b].into_iter().any(|p| p == c || p == d)
                || cross(*a, *b, *c) * cross(*a, *b, *d) > 0.0
                || cross(*c, *d, *a) * cross(*c, *d, *b) > 0.0
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn nested_loops_are_covered_exactly_once(
        shape in nested(),
        length in prop::option::of(0.15f64..3.0),
        scale in -30i32..=30,
        offset in prop::option::of(-1e5f64..1e5),
    ) {
        prop_assume!(is_clean(&shape));
        let offset = offset.unwrap_or(0.0);
        let shape = shape.map(|p| p.map(|x| x + offset));
        let mesh = run(&shape, length)?;
        check_clean(&shape, &mesh);
        // Powers of ten round coordinates, so triangles may differ.
        let scale = 10f64.powi(scale);
        let shape = shape.map(|p| p.map(|x| x * scale));
        let mesh = run(&shape, length.map(|l| l * scale))?;
        check_clean(&shape, &mesh);
    }

    #[test]
    fn any_loops_give_a_manifold(
        shape in any_loops(),
        length in prop::option::of(0.05f64..1.0),
    ) {
        check_any(&shape, &run(&shape, length)?);
    }

    #[test]
    fn loops_on_a_coarse_grid_give_a_manifold(
        shape in grid_loops(),
        length in prop::option::of(0.05f64..1.0),
    ) {
        check_any(&shape, &run(&shape, length)?);
    }

    /// Coordinates of one loop may differ by 600 orders of magnitude.
    #[test]
    fn coordinates_of_any_magnitude_give_a_manifold(
        points in prop::collection::vec(
            ([-1.0f64..1.0, -1.0..1.0], [-300i32..300, -300i32..300]),
            3..20,
        ),
        fine in prop::option::of(0.05f64..1.0),
    ) {
        let mut shape = Shape::default();
        let scaled = |(p, e): ([f64; 2], [i32; 2])| [0, 1].map(|k| p[k] * 10f64.powi(e[k]));
        shape.add(points.into_iter().map(scaled));
        let mesh = run(&shape, fine.map(|l| l * shape.extent()))?;
        prop_assert!(mesh.validate(&shape.section(), f64::MAX).is_ok());
    }

    /// Coordinates are rounded to more than the distance of some neighbors, as 32 bits would.
    ///
    /// Loops that cross themselves by such a rounding keep their Steiner points and overlap
    /// nowhere.
    #[test]
    fn crossings_by_rounding_keep_the_core(
        radii in prop::collection::vec(0.8f64..1.0, 40..80),
        twins in prop::collection::vec([-2e-7f64..2e-7, -2e-7..2e-7], 1..20),
        hole: bool,
    ) {
        let mut points = star([0.0, 0.0], &radii, false);
        for (i, d) in twins.iter().enumerate() {
            let at = i * 7 % points.len();
            let p = points[at];
            points.insert(at, [p[0] + d[0], p[1] + d[1]]);
        }
        let mut shape = Shape::default();
        shape.add(points);
        if hole {
            shape.add(star([0.1, 0.0], &[0.3; 30], true));
        }
        let shape = shape.map(|p| p.map(|x| (x * 1e7).round() * 1e-7));
        let mesh = run(&shape, Some(0.1))?;
        check_any(&shape, &mesh);
        let area = |&t: &[u32; 3]| polygon_area(&corners(&shape, &mesh, t)).abs();
        let error = mesh.triangles.iter().map(area).sum::<f64>() - shape.area();
        prop_assert!(error.abs() < 1e-4 * shape.area(), "{error} {:?}", mesh.report);
        prop_assert!(mesh.steiner_points.len() > 100, "{:?}", mesh.report);
    }

    #[test]
    fn edges_of_the_surface_are_not_duplicated(
        shape in nested(),
        length in prop::option::of(0.3f64..3.0),
        surface in random_edges(),
    ) {
        let has_edge = |a: u32, b: u32| surface.has_edge(a, b);
        let mesh = run_with_edges(&shape, length, has_edge)?;
        check_any(&shape, &mesh);
        check_no_duplicate_edges(&shape, &mesh, has_edge);
    }

    #[test]
    fn results_are_deterministic(
        shape in nested(),
        length in prop::option::of(0.15f64..3.0),
    ) {
        let size = length.map_or(SectionMeshSize::Any, SectionMeshSize::Uniform);
        let params = SectionMeshParams { size, grading: 0.0, ..SectionMeshParams::default() };
        let mut scratch = SectionMeshScratch::default();
        let section = shape.section();
        let first = triangulate_section(&section, &params, |_, _| false, &mut scratch)?;
        let second = triangulate_section(&section, &params, |_, _| false, &mut scratch)?;
        prop_assert_eq!(&first, &second);
        prop_assert_eq!(&first, &run(&shape, length)?);
    }
}
