//! The paper's refinement of sections: the invariants of any mesh, and agreement with its listings.

use super::properties::{any_loops, grid_loops, is_clean, nested, random_edges, star};
use super::sections::{Shape, check_any, check_clean, check_no_duplicate_edges, corners};
use incise_mesh::Vec3;
use incise_refine::paper::{fill, triangulate};
use incise_refine::{
    RefineError, RefineMethod, RefineParams, SectionMesh, SectionMeshParams, SectionMeshScratch,
    SectionMeshSize, triangulate_section,
};
use proptest::prelude::*;
use std::collections::BTreeMap;

fn params<'a>(length: Option<f64>) -> SectionMeshParams<'a> {
    SectionMeshParams {
        method: RefineMethod::Paper,
        size: length.map_or(SectionMeshSize::Any, SectionMeshSize::Uniform),
        ..SectionMeshParams::default()
    }
}

fn run_with_edges(
    shape: &Shape,
    length: Option<f64>,
    has_edge: impl Fn(u32, u32) -> bool,
) -> Result<SectionMesh, RefineError> {
    let section = shape.section();
    let mut scratch = SectionMeshScratch::default();
    triangulate_section(&section, &params(length), has_edge, &mut scratch)
}

fn run(shape: &Shape, length: Option<f64>) -> Result<SectionMesh, RefineError> {
    run_with_edges(shape, length, |_, _| false)
}

/// Checks that Algorithm 4 left no triangle with a mean edge above the target.
///
/// Triangles whose smallest height is below 0.65 targets are exempt.
fn assert_no_triangle_is_too_large(shape: &Shape, mesh: &SectionMesh, length: f64) {
    for &t in &mesh.triangles {
        let [a, b, c] = corners(shape, mesh, t).map(|[x, y]| Vec3::new(x, y, 0.0));
        let edges = [(b - a).norm(), (c - b).norm(), (a - c).norm()];
        let longest = edges.into_iter().fold(0.0, f64::max);
        let height = (b - a).cross(&(c - a)).norm() / longest;
        let mean = edges.iter().sum::<f64>() / 3.0;
        assert!(
            mean <= length * (1.0 + 1e-9) || height <= 0.65 * length * (1.0 + 1e-9),
            "triangle {t:?}: mean edge {mean}, height {height} for {length}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn nested_loops_are_covered_exactly_once(
        shape in nested(),
        length in prop::option::of(0.3f64..3.0),
        scale in -30i32..=30,
    ) {
        prop_assume!(is_clean(&shape));
        let scale = 10f64.powi(scale);
        let shape = shape.map(|p| p.map(|x| x * scale));
        let length = length.map(|l| l * scale);
        let found = run(&shape, length)?;
        check_clean(&shape, &found);
        prop_assert_eq!(found.report.unconverged, 0);
        if let Some(length) = length {
            assert_no_triangle_is_too_large(&shape, &found, length);
        }
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

    #[test]
    fn edges_of_the_surface_are_not_duplicated(
        shape in nested(),
        length in prop::option::of(0.3f64..3.0),
        surface in random_edges(),
    ) {
        let has_edge = |a: u32, b: u32| surface.has_edge(a, b);
        let found = run_with_edges(&shape, length, has_edge)?;
        check_any(&shape, &found);
        check_no_duplicate_edges(&shape, &found, has_edge);
    }

    /// A single loop follows the listings: Algorithm A2's triangles, and the size of `fill`'s
    /// refinement up to ties, which the two decide in different coordinates.
    #[test]
    fn a_single_loop_follows_the_listings(
        radii in prop::collection::vec(0.5f64..1.0, 5..60),
        length in 0.1f64..0.5,
    ) {
        let mut shape = Shape::default();
        shape.add(star([0.0, 0.0], &radii, false));
        prop_assume!(is_clean(&shape));
        let rim: Vec<Vec3> = shape.points.iter().map(|&[x, y]| Vec3::new(x, y, 0.0)).collect();
        let sorted = |triangles: &[[u32; 3]]| {
            let rotations = |&[a, b, c]: &[u32; 3]| [[a, b, c], [b, c, a], [c, a, b]];
            let first = |t| rotations(t).into_iter().min().unwrap();
            let mut sorted: Vec<[u32; 3]> = triangles.iter().map(first).collect();
            sorted.sort_unstable();
            sorted
        };
        let ears = triangulate(&rim, Vec3::z(), &|_, _| false);
        let found = run(&shape, None)?;
        if found.report.clipped_corners == 0 {
            prop_assert_eq!(sorted(&found.triangles), sorted(&ears.triangles));
            let refine = RefineParams { rim_length: Some(length), ..RefineParams::default() };
            let patch = fill(&rim, Vec3::z(), &refine, |_, _| false)?;
            let found = run(&shape, Some(length))?;
            let [count, expected] = [&found.triangles, &patch.triangles].map(|t| t.len() as f64);
            let range = 0.9 * expected..=1.1 * expected;
            prop_assert!(range.contains(&count), "{count} for {expected}");
        }
    }
}

/// The third point lies slightly inside the line between its neighbors.
///
/// The sign of rounded differences gave a triangle of the three outside of the loop.
#[test]
fn a_nearly_straight_reflex_corner_has_no_triangle_outside() {
    let mut shape = Shape::default();
    shape.add([
        [14.2, 0.342_574_939_918_205_87],
        [13.213_610_505_942_622, 0.095_843_644_422_959_06],
        [13.352_364_711_816_579, 0.0],
        [13.365_923_962_510_722, -0.009_365_971_964_494_68],
        [13.643_464_519_888_521, 0.0],
    ]);
    let shape = shape.map(|p| p.map(|x| x * 1e24));
    let found = run(&shape, None).unwrap();
    check_clean(&shape, &found);
    assert_eq!(found.triangles.len(), 3, "{found:?}");
}

/// The second point lies slightly outside the line between its neighbors.
///
/// Its triangle has a positive area, which is 0 in rounded differences.
#[test]
fn a_nearly_straight_convex_corner_may_have_a_triangle() {
    let mut shape = Shape::default();
    shape.add([
        [14.333_489_218_866_685, -0.007_570_069_705_585_027_5],
        [14.336_909_732_137_35, 0.0],
        [14.537_144_793_068_807, 0.443_147_928_047_246_8],
        [14.156_397_162_547_405, 0.879_402_314_889_309_1],
    ]);
    let shape = shape.map(|p| p.map(|x| x * 1e3));
    let found = run(&shape, None).unwrap();
    check_clean(&shape, &found);
    assert_eq!(found.triangles.len(), 2, "{found:?}");
}

/// Two separate discs with different targets are refined to their own mean targets.
#[test]
fn each_part_has_its_own_mean_target() {
    let mut shape = Shape::default();
    shape.add(star([0.0, 0.0], &[1.0; 40], false));
    shape.add(star([3.0, 0.0], &[1.0; 40], false));
    let mut lengths = vec![0.2; shape.points.len()];
    let (fine, coarse) = (shape.loops[0].clone(), shape.loops[1].clone());
    for &v in &fine {
        lengths[v as usize] = if v % 2 == 0 { 0.06 } else { 0.1 };
    }
    let params = SectionMeshParams {
        size: SectionMeshSize::Local(&lengths),
        ..params(None)
    };
    let mut scratch = SectionMeshScratch::default();
    let found = triangulate_section(&shape.section(), &params, |_, _| false, &mut scratch).unwrap();
    check_clean(&shape, &found);
    let n = shape.points.len();
    let mut inner: BTreeMap<bool, usize> = BTreeMap::new();
    for point in &found.steiner_points {
        *inner.entry(point.position[0] > 1.5).or_default() += 1;
        let own = if point.position[0] > 1.5 {
            &coarse
        } else {
            &fine
        };
        assert!(point.parents.iter().all(|p| own.contains(p)), "{point:?}");
    }
    let alone = |points: &[u32], length: f64| {
        let mut disc = Shape::default();
        disc.add(points.iter().map(|&v| shape.points[v as usize]));
        run(&disc, Some(length)).unwrap().steiner_points.len()
    };
    assert_eq!(
        found.steiner_points.len(),
        inner.values().sum::<usize>(),
        "of {n}"
    );
    let mean = fine.iter().map(|&v| lengths[v as usize]).sum::<f64>() / fine.len() as f64;
    let close = |a: usize, b: usize| a.abs_diff(b) * 10 <= b;
    assert!(close(inner[&false], alone(&fine, mean)), "{inner:?}");
    assert!(close(inner[&true], alone(&coarse, 0.2)), "{inner:?}");
    assert!(inner[&false] > 3 * inner[&true], "{inner:?}");
}

#[test]
fn rounds_and_triangles_have_limits() {
    let mut shape = Shape::default();
    shape.add(star([0.0, 0.0], &[1.0; 40], false));
    let of = |max_rounds: u32, max_triangles: usize| {
        let params = SectionMeshParams {
            max_rounds,
            max_triangles,
            ..params(Some(0.02))
        };
        let mut scratch = SectionMeshScratch::default();
        triangulate_section(&shape.section(), &params, |_, _| false, &mut scratch)
    };
    let two = of(2, 4_000_000).unwrap();
    assert_eq!(
        (two.report.unconverged, two.triangles.len() < 400),
        (1, true)
    );
    let all = of(24, 4_000_000).unwrap();
    assert_eq!(all.report.unconverged, 0);
    assert!(all.triangles.len() > 5000, "{}", all.triangles.len());
    assert_eq!(
        of(24, 1000),
        Err(RefineError::TooManyTriangles { limit: 1000 })
    );
    // A mesh of a trillion triangles fails before it is made.
    let section = shape.section();
    let params = SectionMeshParams {
        max_triangles: 1000,
        ..params(Some(1e-6))
    };
    let found = triangulate_section(
        &section,
        &params,
        |_, _| false,
        &mut SectionMeshScratch::default(),
    );
    assert_eq!(found, Err(RefineError::TooManyTriangles { limit: 1000 }));
}
