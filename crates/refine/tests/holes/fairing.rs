//! What fairing must do.

use crate::punched::{disc, distance_to_sphere, fill_and_check, without};
use incise_mesh::{Surface, TriangleId, Vec3, VertexId, icosphere};
use incise_refine::{Filled, HoleError, HoleParams, RefinementLevel};
use proptest::prelude::*;

fn params(fair: bool, z: f64) -> HoleParams {
    HoleParams {
        fair,
        level: RefinementLevel::Z(z),
        ..HoleParams::default()
    }
}

fn distance(open: &Surface, params: &HoleParams) -> f64 {
    let (surface, filled) = fill_and_check(open, params);
    let added: Vec<VertexId> = (filled.delta.vertices_added.iter())
        .map(|added| added.vertex)
        .collect();
    distance_to_sphere(&surface, &added, 1.0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Patches of spheres come nearer to the sphere, whatever the hole: a zigzag rim of a few edges is
    /// the worst.
    #[test]
    fn a_sphere_is_round_again(
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

fn fill_hole_only(open: &Surface, params: &HoleParams) -> (Surface, Filled) {
    let mut surface = open.clone();
    let params = HoleParams {
        max_edges: 40,
        ..*params
    };
    let filled = incise_refine::fill_holes(&mut surface, &params).unwrap();
    assert_eq!(filled.left_open, 1, "the sheet's outside");
    assert_eq!(filled.holes.len(), 1, "and the hole in it");
    (surface, filled)
}

#[test]
fn a_plane_hole_stays_plane() {
    let open = sheet_with_hole(|x, y| 0.25 * x - 0.5 * y);
    let (surface, filled) = fill_hole_only(&open, &params(true, 1.0));
    assert!(filled.holes[0].faired && filled.holes[0].planar);
    for added in &filled.delta.vertices_added {
        let p = surface.position(added.vertex);
        assert!((p.z - 0.25 * p.x + 0.5 * p.y).abs() < 1e-6, "{p}");
    }
}

/// A bowl goes on through the hole.
#[test]
fn a_bowl_goes_on() {
    let bowl = |x: f64, y: f64| (x - 0.4) * (x - 0.4) + 0.7 * (y - 0.5) * (y - 0.5);
    #[expect(clippy::cast_possible_truncation, reason = "a test's coordinates")]
    let open = sheet_with_hole(|x, y| bowl(f64::from(x), f64::from(y)) as f32);
    let off = |params: &HoleParams| {
        let (surface, filled) = fill_hole_only(&open, params);
        let points = filled
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

/// The end of a tube is an end, not a bulge.
#[test]
fn a_steep_end_stays_plane() {
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
    let (surface, filled) = fill_and_check(&tube, &params(true, 1.0));
    assert_eq!(filled.holes.len(), 2);
    assert!(filled.holes.iter().all(|hole| hole.planar && !hole.faired));
    let polygon = 0.5 * f64::from(n) * (std::f64::consts::TAU / f64::from(n)).sin();
    assert!(
        (surface.volume() - 1.25 * polygon).abs() < 1e-6,
        "{}",
        surface.volume()
    );
}

/// A body at rest stays at rest: its patch is as smooth in its rest shape.
#[test]
fn rest_positions_are_faired_alike() {
    let body = icosphere(3, 1.0);
    let open = without(&body, &disc(body.topology(), TriangleId(31), 120));
    let (surface, filled) = fill_and_check(&open, &params(true, 0.7));
    assert!(filled.holes[0].inserted > 20);
    for added in &filled.delta.vertices_added {
        let v = added.vertex.index();
        assert_eq!(surface.positions[v][..3], surface.rest[v]);
    }
}

/// On average four times nearer to the sphere than without.
#[test]
fn spheres_are_round_on_average() {
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

/// Fairing does not take minutes: what is too fine for it is refused, and not made first, so that no limit of triangles
/// is met before. Without fairing the same is made.
#[test]
fn too_fine_a_patch_is_refused() {
    let body = icosphere(3, 1.0);
    let open = without(&body, &disc(body.topology(), TriangleId(31), 300));
    for z in [0.1, 1e-3, 1e-9] {
        let mut surface = open.clone();
        let error = incise_refine::fill_holes(&mut surface, &params(true, z)).unwrap_err();
        assert!(
            matches!(error, HoleError::TooFineToFair { limit: 10_000, .. }),
            "{error}"
        );
        assert_eq!(surface, open, "nothing is left of the attempt");
    }
    let mut surface = open.clone();
    let filled = incise_refine::fill_holes(&mut surface, &params(false, 0.1)).unwrap();
    assert!(filled.holes[0].inserted > 10_000, "it was too fine");
    let few = HoleParams {
        max_triangles: 1000,
        ..params(true, 0.1)
    };
    let error = incise_refine::fill_holes(&mut open.clone(), &few).unwrap_err();
    assert_eq!(error, HoleError::TooManyTriangles { limit: 1000 });
}
