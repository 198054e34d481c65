//! Fairing of patches: distance to known shapes, planar patches, limits.

use super::punched::{disc, distance_to_sphere, fill_and_check, without};
use incise_mesh::{Surface, TriangleId, Vec3, VertexId, icosphere};
use incise_refine::{FillReport, HoleError, HoleParams, RefinementLevel};
use proptest::prelude::*;

fn params(fair: bool, z: f64) -> HoleParams {
    HoleParams {
        fair,
        level: RefinementLevel::Z(z),
        ..HoleParams::default()
    }
}

fn distance(open: &Surface, params: &HoleParams) -> f64 {
    let (surface, report) = fill_and_check(open, params);
    let added: Vec<VertexId> = (report.delta.vertices_added.iter())
        .map(|added| added.vertex)
        .collect();
    distance_to_sphere(&surface, &added, 1.0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Fairing reduces a patch's distance to the sphere; short zigzag rims are the worst case.
    #[test]
    fn fairing_approaches_the_sphere(
        seed in 0u32..1280,
        count in 20usize..250,
        z in 0.5f64..1.5,
    ) {
        let body = icosphere(3, 1.0);
        let open = without(&body, &disc(body.topology(), TriangleId(seed), count));
        let (flat, fair) = (distance(&open, &params(false, z)), distance(&open, &params(true, z)));
        prop_assert!(fair < 0.6 * flat, "{fair} and {flat}");
    }
}

fn sheet_with_hole(height: impl Fn(f32, f32) -> f32) -> Surface {
    let n = 16u16;
    let at = |x: u16, y: u16| u32::from(y * (n + 1) + x);
    let points: Vec<[f32; 3]> = (0..=n)
        .flat_map(|y| (0..=n).map(move |x| (f32::from(x) / 16.0, f32::from(y) / 16.0)))
        .map(|(x, y)| [x, y, height(x, y)])
        .collect();
    let is_hole = |x: u16, y: u16| (5..11).contains(&x) && (4..10).contains(&y);
    let squares = (0..n).flat_map(|y| (0..n).map(move |x| (x, y)));
    let triangles: Vec<[u32; 3]> = squares
        .filter(|&(x, y)| !is_hole(x, y))
        .flat_map(|(x, y)| {
            let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let mut surface = Surface::from_triangles(&points, &triangles).unwrap();
    let unused: Vec<_> = (0..surface.topology().vertex_slots())
        .map(VertexId::from_index)
        .filter(|&v| surface.topology().outgoing(v).is_null())
        .collect();
    surface.remove_vertices(&unused);
    surface
}

fn fill_hole_only(open: &Surface, params: &HoleParams) -> (Surface, FillReport) {
    let mut surface = open.clone();
    let params = HoleParams {
        max_rim_edges: 40,
        ..*params
    };
    let report = incise_refine::fill_holes(&mut surface, &params).unwrap();
    assert_eq!(report.left_open, 1, "the sheet's outer boundary");
    assert_eq!(report.holes.len(), 1, "the hole");
    (surface, report)
}

#[test]
fn a_planar_hole_stays_planar() {
    let open = sheet_with_hole(|x, y| 0.25 * x - 0.5 * y);
    let (surface, report) = fill_hole_only(&open, &params(true, 1.0));
    assert!(report.holes[0].faired && report.holes[0].planar);
    for added in &report.delta.vertices_added {
        let p = surface.position(added.vertex);
        assert!((p.z - 0.25 * p.x + 0.5 * p.y).abs() < 1e-6, "{p}");
    }
}

#[test]
fn fairing_continues_a_paraboloid() {
    let bowl = |x: f64, y: f64| (x - 0.4) * (x - 0.4) + 0.7 * (y - 0.5) * (y - 0.5);
    #[expect(clippy::cast_possible_truncation, reason = "a test's coordinates")]
    let open = sheet_with_hole(|x, y| bowl(f64::from(x), f64::from(y)) as f32);
    let off = |params: &HoleParams| {
        let (surface, report) = fill_hole_only(&open, params);
        let points = report
            .delta
            .vertices_added
            .iter()
            .map(|a| surface.position(a.vertex));
        points
            .map(|p: Vec3| (p.z - bowl(p.x, p.y)).abs())
            .fold(0.0, f64::max)
    };
    let (flat, fair) = (off(&params(false, 1.0)), off(&params(true, 1.0)));
    assert!(fair < 0.5 * flat, "{fair} and {flat}");
}

/// The planar ends of a tube are steep and must not bulge.
#[test]
fn the_end_of_a_tube_stays_planar() {
    let (n, rings) = (24u16, 6u16);
    let points: Vec<[f32; 3]> = (0..rings)
        .flat_map(|z| (0..n).map(move |i| (f32::from(i) / f32::from(n) * std::f32::consts::TAU, z)))
        .map(|(a, z)| [a.cos(), a.sin(), 0.25 * f32::from(z)])
        .collect();
    let at = |i: u16, z: u16| u32::from(z * n + i % n);
    let squares = (0..rings - 1).flat_map(|z| (0..n).map(move |i| (i, z)));
    let triangles: Vec<[u32; 3]> = squares
        .flat_map(|(i, z)| {
            let [a, b, c, d] = [at(i, z), at(i + 1, z), at(i + 1, z + 1), at(i, z + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let tube = Surface::from_triangles(&points, &triangles).unwrap();
    let (surface, report) = fill_and_check(&tube, &params(true, 1.0));
    assert_eq!(report.holes.len(), 2);
    assert!(report.holes.iter().all(|hole| hole.planar && !hole.faired));
    let polygon = 0.5 * f64::from(n) * (std::f64::consts::TAU / f64::from(n)).sin();
    assert!(
        (surface.volume() - 1.25 * polygon).abs() < 1e-6,
        "{}",
        surface.volume()
    );
}

/// In a body at rest, faired positions equal faired rest positions.
#[test]
fn rest_positions_are_faired_too() {
    let body = icosphere(3, 1.0);
    let open = without(&body, &disc(body.topology(), TriangleId(31), 120));
    let (surface, report) = fill_and_check(&open, &params(true, 0.7));
    assert!(report.holes[0].new_vertices > 20);
    for added in &report.delta.vertices_added {
        let v = added.vertex.index();
        assert_eq!(surface.positions()[v][..3], surface.rest_positions()[v]);
    }
}

/// On average, fairing reduces the distance to the sphere four times.
#[test]
fn fairing_reduces_the_mean_distance() {
    let (mut sum, mut count) = (0.0, 0.0);
    for (seed, triangles) in (0..1280)
        .step_by(61)
        .zip([20, 40, 80, 160, 250].iter().cycle())
    {
        let body = icosphere(3, 1.0);
        let open = without(&body, &disc(body.topology(), TriangleId(seed), *triangles));
        let flat = distance(&open, &params(false, 1.0));
        sum += distance(&open, &params(true, 1.0)) / flat;
        count += 1.0;
    }
    assert!(sum / count < 0.25, "{}", sum / count);
}

/// A patch that is too fine for fairing is rejected before the triangle limit is reached.
///
/// The same patch is possible without fairing.
#[test]
fn patches_too_fine_to_fair_are_errors() {
    let body = icosphere(3, 1.0);
    let open = without(&body, &disc(body.topology(), TriangleId(31), 300));
    for z in [0.1, 1e-3, 1e-9] {
        let mut surface = open.clone();
        let error = incise_refine::fill_holes(&mut surface, &params(true, z)).unwrap_err();
        assert!(
            matches!(error, HoleError::TooFineToFair { limit: 10_000, .. }),
            "{error}"
        );
        assert_eq!(surface, open, "the surface is unchanged");
    }
    let mut surface = open.clone();
    let report = incise_refine::fill_holes(&mut surface, &params(false, 0.1)).unwrap();
    assert!(
        report.holes[0].new_vertices > 10_000,
        "above the limit of fairing"
    );
    let few = HoleParams {
        max_triangles: 1000,
        ..params(true, 0.1)
    };
    let error = incise_refine::fill_holes(&mut open.clone(), &few).unwrap_err();
    assert_eq!(error, HoleError::TooManyTriangles { limit: 1000 });
}
