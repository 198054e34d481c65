//! The exact method is invariant under scaling, translation and reordering of the body.

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, torus};
use incise_tests::{
    Blade, Body, any_body, assert_caps_cover_section, cases, cut_and_check, flat_blade,
};
use proptest::prelude::*;

fn params(snap: f64) -> CutParams {
    CutParams {
        snap,
        ..CutParams::default()
    }
}

/// Returns the body with mapped positions.
fn mapped(body: &Surface, map: impl Fn(Vec3) -> Vec3) -> Surface {
    let mut out = body.clone();
    for v in body.topology().vertices() {
        let [x, y, z] = to_f32(map(body.position(v)));
        out.positions_mut()[v.index()] = [x, y, z, body.positions()[v.index()][3]];
        out.rest_positions_mut()[v.index()] = [x, y, z];
    }
    out
}

/// Returns volume and number of triangles of every piece, sorted.
fn pieces(surface: &Surface) -> Vec<(f64, usize)> {
    let mut out: Vec<(f64, usize)> = (0..)
        .zip(surface.piece_volumes())
        .map(|(piece, volume)| (volume, surface.piece_triangles(piece)))
        .filter(|piece| piece.1 > 0)
        .collect();
    out.sort_by(|a, b| a.0.total_cmp(&b.0));
    out
}

/// Scaling by a power of two changes exponents only, so results are equal up to the scale.
#[test]
fn scaling_by_powers_of_two_scales_the_result() {
    let body = torus(0.4, 0.15, 24, 12);
    for snap in [0.0, 0.1] {
        let cut = |exponent: i32| {
            let scale = 2.0_f64.powi(exponent);
            let mut surface = mapped(&body, |p| p * scale);
            let sweep = Sweep::from_plane([0.3, 0.1, 1.0], 0.01 * scale, &surface.bounds());
            let mut cutter = Cutter::new(&surface);
            let sweep = sweep.expect("a plane");
            let cut = cut_and_check(&mut surface, &mut cutter, &sweep, &params(snap));
            let report = cut.expect("a full slice").report;
            let unscaled: Vec<Vec3> = (surface.topology().vertices())
                .map(|v| surface.position(v) / scale)
                .collect();
            (
                unscaled,
                surface.topology().clone(),
                (
                    report.hits,
                    report.loops,
                    report.snapped_vertices,
                    report.merged_points,
                ),
            )
        };
        let expected = cut(0);
        for exponent in [-60, -40, -20, -7, 7, 20, 40, 60] {
            assert!(
                cut(exponent) == expected,
                "2^{exponent} times the size, snap {snap}"
            );
        }
    }
}

proptest! {
    #![proptest_config(cases(50))]

    /// From a micrometer to a thousand kilometers, and up to 10,000 diagonals from the origin,
    /// where coordinates have only 10 bits left for the body.
    #[test]
    fn any_size_and_place(
        body in any_body(),
        blade in flat_blade(),
        exponent in -6.0..6.0_f64,
        offset in prop::array::uniform3(-1.0..1.0_f64),
        reach in prop_oneof![Just(0.0), Just(1.0), Just(100.0), Just(1e4)],
        snap in prop_oneof![Just(0.0), Just(0.1)],
    ) {
        let body = body.build();
        let shift = Vec3::from(offset) * (reach * body.bounds().diagonal());
        let mut surface = mapped(&body, |p| (p + shift) * 10.0_f64.powf(exponent));
        let Ok(sweep) = blade.sweep(&surface) else { return Ok(()) };
        let mut cutter = Cutter::new(&surface);
        let cut = cut_and_check(&mut surface, &mut cutter, &sweep, &params(snap));
        prop_assert!(cut.is_ok(), "{:?} was refused: {:?}", blade, cut.err());
    }

    /// The seed of a body determines the order of its vertices and triangles.
    #[test]
    fn any_order(
        body in any_body(),
        seeds in [1..10_000_u64, 1..10_000_u64],
        blade in flat_blade(),
    ) {
        // Noise depends on the seed as well.
        let body = Body { deformation: incise_tests::Deformation::None, ..body };
        let [first, second] = seeds.map(|seed| Body { seed, ..body }.build());
        let Blade::Plane(..) = blade else { return Ok(()) };
        let sweep = blade.sweep(&first).expect("a plane");
        let [mut a, mut b] = [first.clone(), second.clone()];
        for (whole, surface) in [(&first, &mut a), (&second, &mut b)] {
            let mut cutter = Cutter::new(whole);
            let cut = cut_and_check(surface, &mut cutter, &sweep, &params(0.0));
            let outcome = cut.expect("a full slice");
            if !outcome.is_miss() {
                assert_caps_cover_section(whole, surface, &sweep, &params(0.0), &outcome);
            }
        }
        let [a, b] = [pieces(&a), pieces(&b)];
        prop_assert_eq!(a.len(), b.len(), "the number of pieces depends on the order");
        for (a, b) in a.into_iter().zip(b) {
            prop_assert!((a.0 - b.0).abs() <= 1e-6, "{} or {} in a piece", a.0, b.0);
        }
    }
}
