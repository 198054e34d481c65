//! The paper's refinement of sections: the same contract as any cover, and the patches of its listings.

use crate::properties::{is_clean, nested, star};
use crate::sections::{Shape, check_any, check_clean, corners, index};
use incise_mesh::Vec3;
use incise_refine::{
    Cover, CoverParams, CoverScratch, CoverSize, RefineError, RefineMethod, RefineParams, cover,
    fill, triangulate,
};
use proptest::prelude::*;
use std::collections::BTreeMap;

fn params<'a>(length: Option<f64>) -> CoverParams<'a> {
    CoverParams {
        method: RefineMethod::Paper,
        size: length.map_or(CoverSize::Any, CoverSize::Uniform),
        ..CoverParams::default()
    }
}

fn run_joined(
    shape: &Shape,
    length: Option<f64>,
    crease: bool,
    joined: impl Fn(u32, u32) -> bool,
) -> Result<Cover, RefineError> {
    let section = shape.section(crease);
    let mut scratch = CoverScratch::default();
    cover(&section, &params(length), joined, &mut scratch)
}

fn run(shape: &Shape, length: Option<f64>, crease: bool) -> Result<Cover, RefineError> {
    run_joined(shape, length, crease, |_, _| false)
}

/// Algorithm 4 ends where no triangle has a mean edge above the target, but for flat ones: the smallest height
/// below 0.65 targets.
fn assert_no_triangle_is_too_large(shape: &Shape, cover: &Cover, length: f64) {
    for &t in &cover.triangles {
        let [a, b, c] = corners(shape, cover, t).map(|[x, y]| Vec3::new(x, y, 0.0));
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
    fn nested_rings_are_covered_exactly(shape in nested(), length in prop::option::of(0.3f64..3.0), crease: bool, scale in -30i32..=30) {
        prop_assume!(is_clean(&shape));
        let scale = 10f64.powi(scale);
        let shape = shape.map(|p| p.map(|x| x * scale));
        let length = length.map(|l| l * scale);
        let found = run(&shape, length, crease)?;
        check_clean(&shape, &found, crease);
        prop_assert_eq!(found.report.unfinished, 0);
        if let Some(length) = length {
            assert_no_triangle_is_too_large(&shape, &found, length);
        }
    }

    #[test]
    fn anything_is_covered(loops in prop::collection::vec(prop::collection::vec([-1.0f64..1.0, -1.0..1.0], 3..24), 1..5), length in prop::option::of(0.05f64..1.0), crease: bool) {
        let mut shape = Shape::default();
        for ring in loops {
            shape.add(ring);
        }
        check_any(&shape, &run(&shape, length, crease)?);
    }

    /// Few places: duplicates, spikes, touching edges and loops of no area everywhere.
    #[test]
    fn loops_on_a_coarse_grid_are_covered(loops in prop::collection::vec(prop::collection::vec([-2i32..3, -2i32..3], 3..16), 1..6), length in prop::option::of(0.05f64..1.0), crease: bool) {
        let mut shape = Shape::default();
        for ring in loops {
            shape.add(ring.into_iter().map(|p| p.map(f64::from)));
        }
        check_any(&shape, &run(&shape, length, crease)?);
    }

    #[test]
    fn edges_of_the_surface_are_not_made_again(shape in nested(), length in prop::option::of(0.3f64..3.0), crease: bool, salt: u32, share in 1u32..4) {
        let joined = |a: u32, b: u32| a.min(b).wrapping_mul(0x9e37_79b9).wrapping_add(a.max(b) ^ salt).wrapping_mul(0x85eb_ca6b) >> 30 < share;
        let found = run_joined(&shape, length, crease, joined)?;
        check_any(&shape, &found);
        let n = index(shape.points.len());
        let mut rim = std::collections::HashSet::new();
        for ring in &shape.loops {
            for i in 0..ring.len() {
                rim.insert([ring[i], ring[(i + 1) % ring.len()]]);
            }
        }
        for &[a, b, c] in &found.triangles {
            for [v, w] in [[a, b], [b, c], [c, a]] {
                prop_assert!(v >= n || w >= n || rim.contains(&[v, w]) || rim.contains(&[w, v]) || !joined(v, w), "{v} {w}");
            }
        }
    }

    /// One ring is what the listings are about: Algorithm A2's triangles, and as many after refinement as `fill`
    /// makes (up to ties, which the two decide in coordinates that are not the same).
    #[test]
    fn one_ring_is_filled_as_the_paper_fills_it(radii in prop::collection::vec(0.5f64..1.0, 5..60), length in 0.1f64..0.5) {
        let mut shape = Shape::default();
        shape.add(star([0.0, 0.0], &radii, false));
        prop_assume!(is_clean(&shape));
        let rim: Vec<Vec3> = shape.points.iter().map(|&[x, y]| Vec3::new(x, y, 0.0)).collect();
        let sorted = |triangles: &[[u32; 3]]| {
            let mut sorted: Vec<[u32; 3]> = triangles.iter().map(|&[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap()).collect();
            sorted.sort_unstable();
            sorted
        };
        let ears = triangulate(&rim, Vec3::z(), &|_, _| false);
        let found = run(&shape, None, false)?;
        if found.report.clipped == 0 {
            prop_assert_eq!(sorted(&found.triangles), sorted(&ears.triangles));
            let refine = RefineParams { rim_length: Some(length), ..RefineParams::default() };
            let patch = fill(&rim, Vec3::z(), &refine, |_, _| false)?;
            let found = run(&shape, Some(length), false)?;
            let [few, many] = [0.9, 1.1].map(|share| share * patch.triangles.len() as f64);
            prop_assert!((few..=many).contains(&(found.triangles.len() as f64)), "{} for {}", found.triangles.len(), patch.triangles.len());
        }
    }
}

/// The third point lies next to nothing beside the line between its neighbors, on the inner side: a triangle of the
/// three was made where that side was asked of rounded differences.
#[test]
fn a_corner_next_to_straight_has_no_triangle_outside() {
    let mut shape = Shape::default();
    shape.add([
        [14.2, 0.342_574_939_918_205_87],
        [13.213_610_505_942_622, 0.095_843_644_422_959_06],
        [13.352_364_711_816_579, 0.0],
        [13.365_923_962_510_722, -0.009_365_971_964_494_68],
        [13.643_464_519_888_521, 0.0],
    ]);
    let shape = shape.map(|p| p.map(|x| x * 1e24));
    let found = run(&shape, None, false).unwrap();
    check_clean(&shape, &found, false);
    assert_eq!(found.triangles.len(), 3, "{found:?}");
}

/// The second point lies next to nothing outside the line between its neighbors: its triangle has a positive area, that of
/// rounded differences is 0.
#[test]
fn a_corner_next_to_straight_may_have_a_triangle_inside() {
    let mut shape = Shape::default();
    shape.add([
        [14.333_489_218_866_685, -0.007_570_069_705_585_027_5],
        [14.336_909_732_137_35, 0.0],
        [14.537_144_793_068_807, 0.443_147_928_047_246_8],
        [14.156_397_162_547_405, 0.879_402_314_889_309_1],
    ]);
    let shape = shape.map(|p| p.map(|x| x * 1e3));
    let found = run(&shape, None, false).unwrap();
    check_clean(&shape, &found, false);
    assert_eq!(found.triangles.len(), 2, "{found:?}");
}

/// Two discs beside each other with different targets get their own; a nested pair shares the mean.
#[test]
fn each_part_has_the_mean_of_its_own_targets() {
    let mut shape = Shape::default();
    shape.add(star([0.0, 0.0], &[1.0; 40], false));
    shape.add(star([3.0, 0.0], &[1.0; 40], false));
    let mut lengths = vec![0.2; shape.points.len()];
    let (fine, coarse) = (shape.loops[0].clone(), shape.loops[1].clone());
    for &v in &fine {
        lengths[v as usize] = if v % 2 == 0 { 0.06 } else { 0.1 };
    }
    let params = CoverParams {
        size: CoverSize::Local(&lengths),
        ..params(None)
    };
    let mut scratch = CoverScratch::default();
    let found = cover(&shape.section(false), &params, |_, _| false, &mut scratch).unwrap();
    check_clean(&shape, &found, false);
    let n = shape.points.len();
    let mut inner: BTreeMap<bool, usize> = BTreeMap::new();
    for point in &found.inner {
        *inner.entry(point.at[0] > 1.5).or_default() += 1;
        let own = if point.at[0] > 1.5 { &coarse } else { &fine };
        assert!(point.parents.iter().all(|p| own.contains(p)), "{point:?}");
    }
    let alone = |ring: &[u32], length: f64| {
        let mut disc = Shape::default();
        disc.add(ring.iter().map(|&v| shape.points[v as usize]));
        run(&disc, Some(length), false).unwrap().inner.len()
    };
    assert_eq!(found.inner.len(), inner.values().sum::<usize>(), "of {n}");
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
        let params = CoverParams {
            max_rounds,
            max_triangles,
            ..params(Some(0.02))
        };
        let mut scratch = CoverScratch::default();
        cover(&shape.section(false), &params, |_, _| false, &mut scratch)
    };
    let two = of(2, 4_000_000).unwrap();
    assert_eq!(
        (two.report.unfinished, two.triangles.len() < 400),
        (1, true)
    );
    let all = of(24, 4_000_000).unwrap();
    assert_eq!(all.report.unfinished, 0);
    assert!(all.triangles.len() > 5000, "{}", all.triangles.len());
    assert_eq!(
        of(24, 1000),
        Err(RefineError::TooManyTriangles { limit: 1000 })
    );
    // A crease as long as a million targets.
    let section = shape.section(true);
    let params = CoverParams {
        max_triangles: 1000,
        ..params(Some(1e-6))
    };
    let found = cover(
        &section,
        &params,
        |_, _| false,
        &mut CoverScratch::default(),
    );
    assert_eq!(found, Err(RefineError::TooManyTriangles { limit: 1000 }));
}
