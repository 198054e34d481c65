//! Patches of rims that rounding could fold, and limits of the refinement.

use incise_mesh::Vec3;
use incise_paper::{PaperParams, fill, triangulate};
use incise_refine::RefineError;

fn rim(points: &[[f64; 2]], scale: f64) -> Vec<Vec3> {
    let point = |&[x, y]: &[f64; 2]| Vec3::new(x, y, 0.0) * scale;
    points.iter().map(point).collect()
}

/// Asserts that the triangles of a rim turn left and have its area.
fn assert_covered(rim: &[Vec3]) {
    let patch = triangulate(rim, Vec3::z(), &|_, _| false);
    assert_eq!(patch.triangles.len(), rim.len() - 2, "no center is added");
    let area = |[a, b, c]: [Vec3; 3]| (b - a).cross(&(c - a)).z;
    let triangles = patch.triangles.iter();
    let areas: Vec<f64> = triangles
        .map(|t| area(t.map(|v| rim[v as usize])))
        .collect();
    assert!(areas.iter().all(|&a| a >= 0.0), "{areas:?}");
    let ears = rim
        .windows(2)
        .skip(1)
        .map(|pair| area([rim[0], pair[0], pair[1]]));
    let (sum, expected): (f64, f64) = (areas.iter().sum(), ears.sum());
    assert!(
        (sum - expected).abs() < 1e-12 * expected,
        "{sum} for {expected}"
    );
}

/// The third point lies slightly inside the line between its neighbors.
///
/// The sign of rounded differences gave a triangle of the three outside of the loop.
#[test]
fn a_nearly_straight_reflex_corner_has_no_triangle_outside() {
    let points = [
        [14.2, 0.342_574_939_918_205_87],
        [13.213_610_505_942_622, 0.095_843_644_422_959_06],
        [13.352_364_711_816_579, 0.0],
        [13.365_923_962_510_722, -0.009_365_971_964_494_68],
        [13.643_464_519_888_521, 0.0],
    ];
    assert_covered(&rim(&points, 1e24));
}

/// The second point lies slightly outside the line between its neighbors.
///
/// Its triangle has a positive area, which is 0 in rounded differences.
#[test]
fn a_nearly_straight_convex_corner_may_have_a_triangle() {
    let points = [
        [14.333_489_218_866_685, -0.007_570_069_705_585_027_5],
        [14.336_909_732_137_35, 0.0],
        [14.537_144_793_068_807, 0.443_147_928_047_246_8],
        [14.156_397_162_547_405, 0.879_402_314_889_309_1],
    ];
    assert_covered(&rim(&points, 1e3));
}

#[test]
fn rounds_and_triangles_have_limits() {
    let angles = (0..40).map(|i| f64::from(i) * std::f64::consts::TAU / 40.0);
    let rim: Vec<Vec3> = angles.map(|a| Vec3::new(a.cos(), a.sin(), 0.0)).collect();
    let of = |rim_length: f64, max_rounds: u32, max_triangles: usize| {
        let params = PaperParams {
            rim_length: Some(rim_length),
            max_rounds,
            max_triangles,
            ..PaperParams::default()
        };
        fill(&rim, Vec3::z(), &params, |_, _| false)
    };
    let two = of(0.02, 2, 4_000_000).unwrap();
    assert_eq!((two.report.rounds, two.report.converged), (2, false));
    assert!(two.triangles.len() < 400);
    let all = of(0.02, 24, 4_000_000).unwrap();
    assert!(all.report.converged && all.triangles.len() > 5000);
    let too_many = Err(RefineError::TooManyTriangles { limit: 1000 }.into());
    assert_eq!(of(0.02, 24, 1000), too_many);
    // A mesh of a trillion triangles fails before it is made.
    assert_eq!(of(1e-6, 24, 1000), too_many);
}
