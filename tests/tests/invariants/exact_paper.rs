//! The exact method with the paper's refinement of caps: all invariants of an exact cut hold.

use incise_cut::{CutError, CutMethod, CutOutcome, CutParams, Cutter, ExactParams, Sweep};
use incise_mesh::{Surface, icosphere, torus};
use incise_models::{Model, build_model};
use incise_refine::{RefineMethod, RefineParams, RefinementLevel};
use incise_tests::{
    any_blade, any_body, any_level, assert_caps_cover_section, cases, cut_and_check,
    euler_characteristics, exact_params, self_intersecting_body, shells,
};
use proptest::prelude::*;

fn params(method: RefineMethod, level: RefinementLevel, snap: f64) -> CutParams {
    CutParams {
        method: CutMethod::Exact(ExactParams {
            snap,
            ..ExactParams::default()
        }),
        refine: RefineParams {
            method,
            level,
            ..RefineParams::default()
        },
        ..CutParams::default()
    }
}

/// Cuts a copy along a plane and asserts all invariants and the rim edges of the default method.
fn slice(body: &Surface, normal: [f64; 3], d: f64, params: &CutParams) -> (Surface, CutOutcome) {
    let sweep = Sweep::from_plane(normal, d, &body.bounds()).expect("a plane");
    let cut = |params: &CutParams| {
        let mut surface = body.clone();
        let outcome = cut_and_check(&mut surface, &mut Cutter::new(body), &sweep, params);
        (surface, outcome.expect("a full slice cuts"))
    };
    let (surface, outcome) = cut(params);
    assert!(outcome.report.refined, "the rounds were enough");
    if exact_params(params).snap == 0.0 {
        assert_caps_cover_section(body, &surface, &sweep, params, &outcome);
    }
    let mut default = *params;
    default.refine.method = RefineMethod::Delaunay;
    let (expected, expected_outcome) = cut(&default);
    assert_eq!(
        rim(&surface, &outcome),
        rim(&expected, &expected_outcome),
        "the rim is another one"
    );
    (surface, outcome)
}

/// Returns the edges between caps and other triangles as bits.
fn rim(surface: &Surface, outcome: &CutOutcome) -> Vec<[[u32; 4]; 2]> {
    let topology = surface.topology();
    let is_cap = |h: incise_mesh::HalfEdge| outcome.cap.contains(&h.triangle());
    let own = outcome.cap.iter().flat_map(|t| t.half_edges());
    let at_rim = own.filter(|&h| !is_cap(topology.twin(h)));
    let mut edges: Vec<_> = at_rim
        .map(|h| {
            [topology.origin(h), topology.target(h)]
                .map(|v| surface.positions()[v.index()].map(f32::to_bits))
        })
        .collect();
    edges.sort_unstable();
    edges
}

#[test]
fn built_in_bodies_are_cut_at_every_level() {
    let bodies = [
        (icosphere(3, 0.5), [0.3, 1.0, 0.2], 0.03, 1),
        // A plane across the torus's hole gives two discs, one along it a disc with a hole.
        (torus(0.4, 0.15, 32, 16), [1.0, 0.1, 0.05], 0.01, 2),
        (build_model(Model::Bunny), [0.2, 1.0, 0.1], 0.02, 1),
    ];
    for (body, normal, d, loops) in &bodies {
        for snap in [0.0, 0.1] {
            let mut last = 0;
            for level in RefinementLevel::FIVE {
                let params = params(RefineMethod::Paper, level, snap);
                let (_, outcome) = slice(body, *normal, *d, &params);
                assert_eq!(outcome.report.loops, *loops, "loops");
                assert!(outcome.cap.len() >= last, "{level} is no coarser");
                last = outcome.cap.len();
            }
        }
    }
}

/// The plane of a torus gives a section with one hole, a plane through nested shells many.
#[test]
fn nested_sections_are_refined_too() {
    let flat = torus(0.4, 0.15, 32, 16);
    let normals: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut nested = 0;
    for normal in normals {
        let params = params(RefineMethod::Paper, RefinementLevel::Finer1_5, 0.0);
        let normal = normal.map(|x| x + 0.013);
        let (surface, outcome) = slice(&flat, normal, 0.002, &params);
        let handles: i64 = euler_characteristics(&surface)
            .values()
            .map(|x| 2 - x)
            .sum();
        // Across, a torus becomes two pieces of genus 0; along, two of genus 1.
        if handles == 4 {
            nested += 1;
            let points = outcome.delta.vertices_added.iter();
            let inner =
                points.filter(|v| matches!(v.origin, incise_mesh::VertexOrigin::OnCap { .. }));
            assert!(inner.count() > 100, "the ring is refined");
        }
    }
    assert_eq!(nested, 1, "one plane cuts the torus along");
    let body = shells(3);
    for snap in [0.0, 0.1] {
        let params = params(RefineMethod::Paper, RefinementLevel::Original, snap);
        let (_, outcome) = slice(&body, [0.1, 1.0, 0.3], 0.01, &params);
        assert!(outcome.report.loops > 2, "{} loops", outcome.report.loops);
    }
}

fn any_snap() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), Just(0.1), 0.0..0.5_f64]
}

proptest! {
    #![proptest_config(cases(50))]

    #[test]
    fn invariants_hold_for_random_bodies_and_sweeps(
        body in prop_oneof![3 => any_body().boxed(), 1 => self_intersecting_body().boxed()],
        blades in prop::collection::vec((any_blade(), any_level(), any_snap()), 1..=3),
    ) {
        let mut surface = body.build();
        let mut cutter = Cutter::new(&surface);
        for (blade, level, snap) in blades {
            let Ok(sweep) = blade.sweep(&surface) else { continue };
            let params = params(RefineMethod::Paper, level, snap);
            match cut_and_check(&mut surface, &mut cutter, &sweep, &params) {
                Ok(_) => {}
                Err(CutError::PartialCut { .. }) if !blade.is_full_plane() => {}
                Err(error) => panic!("{blade:?} was refused: {error}"),
            }
        }
    }
}
