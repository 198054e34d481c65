//! Invariants of the exact method on random bodies, sweeps, levels and snapping distances.

use incise_cut::{CutError, CutParams, Cutter, Sweep};
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3};
use incise_refine::{RefineParams, RefinementLevel};
use incise_tests::{
    Blade, Body, Deformation, any_blade, any_body, any_level, assert_caps_cover_section,
    assert_closed_manifold, cases, cut_and_check, euler_characteristics, flat_blade,
    self_intersecting_body,
};
use proptest::prelude::*;

fn params(level: RefinementLevel, snap: f64) -> CutParams {
    CutParams {
        snap,
        refine: RefineParams {
            level,
            ..RefineParams::default()
        },
        ..CutParams::default()
    }
}

fn any_snap() -> impl Strategy<Value = f64> {
    prop_oneof![2 => Just(0.0), 2 => Just(0.1), 1 => 0.0..0.5_f64]
}

/// Returns sweeps with arbitrary corners: thin, folded, or ending inside the body.
fn any_sweep() -> impl Strategy<Value = [[f64; 3]; 4]> {
    let reach = prop_oneof![Just(1.0), Just(3.0), Just(20.0)];
    let corners = prop::array::uniform4(prop::array::uniform3(-1.0..1.0_f64));
    (reach, corners).prop_map(|(reach, corners)| corners.map(|c| c.map(|x| reach * x)))
}

fn sweep_around(corners: [[f64; 3]; 4], surface: &Surface) -> Result<Sweep, CutError> {
    let bounds = surface.bounds();
    let at = |c: [f64; 3]| to_f32(bounds.center() + Vec3::from(c) * bounds.diagonal());
    let [a, b, c, d] = corners.map(at);
    Sweep::new([a, b], [d, c])
}

/// Cuts repeatedly; only sweeps that end inside the body may fail.
fn cut_in_turn(body: &Body, blades: &[(Blade, RefinementLevel, f64)]) {
    let mut surface = body.build();
    assert_closed_manifold(&surface);
    let genus_0 = euler_characteristics(&surface).values().all(|&x| x == 2);
    let mut cutter = Cutter::new(&surface);
    for (blade, level, snap) in blades {
        let Ok(sweep) = blade.sweep(&surface) else {
            continue;
        };
        let params = params(*level, *snap);
        match cut_and_check(&mut surface, &mut cutter, &sweep, &params) {
            Ok(_) => {}
            Err(CutError::PartialCut { .. }) if !blade.is_full_plane() => {}
            Err(error) => panic!("{blade:?} was refused: {error}"),
        }
    }
    if genus_0 && blades.iter().all(|b| b.0.is_full_plane()) && blades.len() == 1 {
        for (piece, euler) in euler_characteristics(&surface) {
            assert!(euler <= 2, "piece {piece} has the characteristic {euler}");
        }
    }
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn one_plane(
        body in any_body(),
        blade in flat_blade(),
        level in any_level(),
        snap in any_snap(),
    ) {
        cut_in_turn(&body, &[(blade, level, snap)]);
    }

    #[test]
    fn caps_cover_the_section_once(
        body in any_body(),
        blade in flat_blade(),
        level in any_level(),
    ) {
        let before = body.build();
        let mut surface = before.clone();
        let Ok(sweep) = blade.sweep(&surface) else { return Ok(()) };
        let params = params(level, 0.0);
        let cut = cut_and_check(&mut surface, &mut Cutter::new(&before), &sweep, &params);
        let outcome = cut.expect("a full slice cuts");
        // Waves and lattice rounding may fold coarse bodies.
        let is_embedded = body.is_fine() || matches!(body.deformation, Deformation::None);
        if !outcome.is_miss() && body.lattice.is_none() && is_embedded {
            assert_caps_cover_section(&before, &surface, &sweep, &params, &outcome);
        }
    }

    #[test]
    fn planes_through_self_intersecting_bodies(
        body in self_intersecting_body(),
        blades in prop::collection::vec((any_blade(), any_level(), any_snap()), 1..=4),
    ) {
        cut_in_turn(&body, &blades);
    }

    #[test]
    fn sweeps_with_random_corners(
        body in prop_oneof![2 => any_body().boxed(), 1 => self_intersecting_body().boxed()],
        sweeps in prop::collection::vec((any_sweep(), any_snap()), 1..=4),
    ) {
        let mut surface = body.build();
        let mut cutter = Cutter::new(&surface);
        for (corners, snap) in sweeps {
            let Ok(sweep) = sweep_around(corners, &surface) else { continue };
            let params = params(RefinementLevel::Original, snap);
            match cut_and_check(&mut surface, &mut cutter, &sweep, &params) {
                Ok(_) | Err(CutError::PartialCut { .. }) => {}
                Err(error) => panic!("{sweep:?} was refused: {error}"),
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(100))]

    #[test]
    fn sweeps_in_turn(
        body in any_body(),
        blades in prop::collection::vec((any_blade(), any_level(), any_snap()), 2..=6),
    ) {
        cut_in_turn(&body, &blades);
    }
}
