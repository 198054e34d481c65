//! Cuts along a sweep that cut the body before: they change nothing.

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{Surface, Vec3};
use incise_models::{Model, build_model};
use incise_refine::{RefineParams, RefinementLevel};
use incise_tests::{any_blade, any_body, assert_same_bits, cases, cut_and_check};
use proptest::prelude::*;

fn params(snap: f64, remesh: f64, level: RefinementLevel) -> CutParams {
    CutParams {
        snap,
        remesh,
        refine: RefineParams {
            level,
            ..RefineParams::default()
        },
        ..CutParams::default()
    }
}

/// Returns the plane of a direction at a part of the diagonal from the center.
fn plane(surface: &Surface, normal: Vec3, part: f64) -> Sweep {
    let bounds = surface.bounds();
    let d = normal.dot(&bounds.center()) + part * bounds.diagonal() * normal.norm();
    Sweep::from_plane(normal.into(), d, &bounds).expect("a plane")
}

/// Asserts that a sweep changes nothing.
fn assert_miss(surface: &mut Surface, cutter: &mut Cutter, sweep: &Sweep, params: &CutParams) {
    let before = surface.topology().triangle_count();
    let outcome = cutter.cut(surface, sweep, params);
    let outcome = outcome.expect("a cut along a cap is no error");
    assert!(
        outcome.is_miss(),
        "{before} triangles became {} by {:?} with {params:?}",
        surface.topology().triangle_count(),
        sweep.points()
    );
}

/// Cuts a model along each plane and again: the same plane `times` times, turned by 1e-6 and moved
/// by 1e-7 of the size, as a whole and each piece by itself.
fn cut_again(model: Model, times: usize, params: &CutParams) {
    let whole = build_model(model);
    for (normal, part) in [
        ([0.1, 1.0, 0.2], 0.02),
        ([1.0, -0.3, 0.4], -0.05),
        ([0.2, 0.3, -1.0], 0.01),
    ] {
        let normal = Vec3::from(normal);
        let mut surface = whole.clone();
        let mut cutter = Cutter::new(&surface);
        let sweep = plane(&surface, normal, part);
        let cut = cut_and_check(&mut surface, &mut cutter, &sweep, params);
        let is_miss = cut.expect("a full slice").is_miss();
        assert!(!is_miss, "the plane crosses the model");
        let turned = |x, y, z| plane(&whole, normal + Vec3::new(x, y, z) * normal.norm(), part);
        let again = [
            turned(1e-6, 0.0, 0.0),
            turned(0.0, 0.0, -1e-6),
            turned(-7e-7, 0.0, 7e-7),
            plane(&whole, normal, part + 1e-7),
            plane(&whole, normal, part - 1e-7),
        ];
        let sweeps: Vec<Sweep> = [vec![sweep; times - 1], again.into()].concat();
        for sweep in &sweeps {
            assert_miss(&mut surface, &mut cutter, sweep, params);
        }
        for (_, mut piece) in surface.extract_pieces() {
            let mut cutter = Cutter::new(&piece);
            for sweep in &sweeps {
                assert_miss(&mut piece, &mut cutter, sweep, params);
            }
        }
    }
}

#[test]
fn five_cuts_along_a_plane_are_one() {
    let original = RefinementLevel::Original;
    for model in [
        Model::Sphere20,
        Model::Sphere80,
        Model::Sphere768,
        Model::Bunny,
        Model::Octopus,
        Model::Banana,
    ] {
        for params in [
            params(0.1, 0.0, original),
            params(0.0, 0.0, original),
            params(0.1, 0.2, original),
            params(0.1, 0.0, RefinementLevel::Finer2),
            // Caps without points of their own.
            params(0.1, 0.0, RefinementLevel::Z(1e3)),
        ] {
            cut_again(model, 5, &params);
        }
    }
}

#[test]
fn a_hundred_cuts_along_a_plane_are_one() {
    let params = params(0.1, 0.2, RefinementLevel::Original);
    for model in [Model::Bunny, Model::Octopus, Model::Banana] {
        cut_again(model, 100, &params);
    }
}

proptest! {
    #![proptest_config(cases(150))]

    /// A second cut along any sweep that cut a body changes nothing.
    #[test]
    fn a_second_cut_changes_nothing(
        body in any_body(),
        blade in any_blade(),
        snap in prop_oneof![Just(0.0), Just(0.1)],
        remesh in prop_oneof![Just(0.0), Just(0.2)],
    ) {
        let mut surface = body.build();
        let Ok(sweep) = blade.sweep(&surface) else { return Ok(()) };
        let params = params(snap, remesh, RefinementLevel::Original);
        let mut cutter = Cutter::new(&surface);
        if cutter.cut(&mut surface, &sweep, &params).is_err() {
            return Ok(());
        }
        let before = surface.clone();
        let outcome = cutter.cut(&mut surface, &sweep, &params);
        prop_assert!(outcome.is_ok_and(|outcome| outcome.is_miss()), "{blade:?} cuts again");
        assert_same_bits(&before, &surface);
    }
}
