//! Invariants of hole filling over random holes and rims.

use super::punched::{
    area, check_manifold, collar, disc, fill_and_check, inner_loop, reread, without,
};
use incise_mesh::{Surface, TriangleId, cube_sphere, icosphere, torus};
use incise_refine::{HoleParams, RefinementLevel, fill_hole};
use proptest::prelude::*;

fn body(which: u8, scale: i32) -> Surface {
    let size = 10f64.powi(scale);
    match which {
        0 => icosphere(2, size),
        1 => cube_sphere(5, size),
        _ => torus(size, 0.4 * size, 16, 9),
    }
}

fn params(z: f64) -> HoleParams {
    HoleParams {
        level: RefinementLevel::Z(z),
        fair: true,
        ..HoleParams::default()
    }
}

fn any_discs() -> impl Strategy<Value = Vec<(prop::sample::Index, usize)>> {
    prop::collection::vec((any::<prop::sample::Index>(), 1usize..40), 1..6)
}

/// Removes discs, which may touch or overlap, from a body.
fn punched(body: &Surface, discs: &[(prop::sample::Index, usize)]) -> Option<Surface> {
    let topology = body.topology();
    let all: Vec<TriangleId> = topology.triangles().collect();
    let mut holes: Vec<TriangleId> = discs
        .iter()
        .flat_map(|(seed, count)| disc(topology, *seed.get(&all), *count))
        .collect();
    holes.sort_unstable();
    holes.dedup();
    (holes.len() < all.len()).then(|| reread(&without(body, &holes)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn every_hole_is_filled(
        which in 0u8..3,
        discs in any_discs(),
        z in 0.4f64..2.5,
        scale in prop_oneof![Just(0), Just(-15), Just(15), -6i32..6],
    ) {
        let open = punched(&body(which, scale), &discs);
        prop_assume!(open.is_some());
        fill_and_check(&open.unwrap(), &params(z));
    }

    /// Scaling by a power of two gives the same bits.
    #[test]
    fn results_are_scale_invariant(discs in any_discs(), power in -40i32..40) {
        let open = punched(&icosphere(2, 1.0), &discs);
        prop_assume!(open.is_some());
        let open = open.unwrap();
        let factor = 2f32.powi(power);
        let mut scaled = open.clone();
        for p in scaled.positions_mut() {
            p[..3].iter_mut().for_each(|x| *x *= factor);
        }
        scaled.rest_positions_mut().iter_mut().flatten().for_each(|x| *x *= factor);
        let flat = HoleParams { fair: false, ..params(1.0) };
        let (one, _) = fill_and_check(&open, &flat);
        let (other, _) = fill_and_check(&scaled, &flat);
        prop_assert_eq!(one.topology(), other.topology());
        for (p, q) in one.positions().iter().zip(other.positions()) {
            prop_assert_eq!([0, 1, 2].map(|k| p[k] * factor), [0, 1, 2].map(|k| q[k]));
        }
    }

    /// Rims may cross themselves, bend, and repeat positions.
    #[test]
    fn any_rim_gives_a_manifold(
        points in prop::collection::vec([-1.0f32..1.0, -1.0..1.0, -1.0..1.0], 3..40),
        z in 0.3f64..2.0,
    ) {
        let mut surface = collar(&points);
        let rim = inner_loop(&surface, points.len());
        let report = fill_hole(&mut surface, &rim, &params(z)).unwrap();
        prop_assert_eq!(surface.topology().boundary_loops().len(), 1, "the outer boundary");
        check_manifold(&surface);
        let hole = &report.holes[0];
        prop_assert_eq!(hole.triangles.len(), hole.rim_edges - 2 + 2 * hole.new_vertices);
    }

    /// Star-shaped, non-planar rims get no triangle without area.
    #[test]
    fn generic_rims_get_triangles_with_area(
        radii in prop::collection::vec((0.5f32..1.0, -0.5f32..0.5), 4..40),
        z in 0.5f64..2.0,
    ) {
        let n = radii.len() as f32;
        let rim: Vec<[f32; 3]> = radii.iter().enumerate().map(|(i, &(r, height))| {
            let a = i as f32 * std::f32::consts::TAU / n;
            [r * a.cos(), r * a.sin(), height]
        }).collect();
        let mut surface = collar(&rim);
        let boundary = inner_loop(&surface, rim.len());
        let report = fill_hole(&mut surface, &boundary, &params(z)).unwrap();
        for &t in &report.holes[0].triangles {
            prop_assert!(area(&surface, t) > 0.0, "{t}");
        }
    }
}
