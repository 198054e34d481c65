//! The paper's method on random bodies, sweeps and levels: results are closed manifolds.

use incise_cut::{CutOutcome, Cutter};
use incise_mesh::Surface;
use incise_mesh::geometry::{Vec3, area_vector};
use incise_paper::{PaperError, PaperParams};
use incise_refine::RefinementLevel;
use incise_tests::{
    Blade, Body, any_blade, any_body, any_level, assert_closed_manifold, cases,
    euler_characteristics, flat_blade, large_body, paper_cut_and_check, self_intersecting_body,
};
use proptest::prelude::*;

fn params(level: RefinementLevel) -> PaperParams {
    PaperParams {
        level,
        ..PaperParams::default()
    }
}

/// Cuts repeatedly. Full planes must cut unless the cross-section has a hole.
fn cut_in_turn(body: &Body, blades: &[(Blade, RefinementLevel)]) {
    let mut surface = body.build();
    assert_closed_manifold(&surface);
    let genus_0 = euler_characteristics(&surface).values().all(|&x| x == 2);
    let mut cutter = Cutter::new(&surface);
    for (blade, level) in blades {
        let Ok(sweep) = blade.sweep(&surface) else {
            continue;
        };
        let result = paper_cut_and_check(&mut surface, &mut cutter, &sweep, &params(*level));
        match result {
            Ok(outcome) => {
                assert!(outcome.delta.pieces_removed.is_empty(), "a piece vanished");
            }
            Err(error) => assert!(
                is_allowed(error, blade),
                "{blade:?} was refused although it is a full slice: {error}"
            ),
        }
    }
    if genus_0 {
        for (piece, euler) in euler_characteristics(&surface) {
            assert_eq!(euler, 2, "piece {piece} of a ball is a ball");
        }
    }
}

/// Sizes of the removed triangles of a cut, for bounds of displacement.
struct RemovedSizes {
    /// Mean edge length of the removed triangles \[m\].
    mean_edge: f64,
    /// Their longest edge \[m\].
    longest_edge: f64,
    /// Their area \[m^2\].
    strip: f64,
    /// Half of the area of both caps \[m^2\].
    section: f64,
}

impl RemovedSizes {
    fn of(before: &Surface, after: &Surface, outcome: &CutOutcome) -> Self {
        let area = |p: [Vec3; 3]| area_vector(p).norm() / 2.0;
        let caps = outcome.cap.iter();
        let mut out = Self {
            mean_edge: 0.0,
            longest_edge: 0.0,
            strip: 0.0,
            section: caps
                .map(|&t| area(after.triangle_positions(t)))
                .sum::<f64>()
                / 2.0,
        };
        let removed = &outcome.delta.triangles_removed;
        for (_, corners) in removed {
            let [a, b, c] = corners.map(|v| before.position(v));
            for edge in [b - a, c - b, a - c] {
                out.mean_edge += edge.norm() / (3 * removed.len()) as f64;
                out.longest_edge = out.longest_edge.max(edge.norm());
            }
            out.strip += area([a, b, c]);
        }
        out
    }
}

fn is_allowed(error: PaperError, blade: &Blade) -> bool {
    match error {
        PaperError::NestedSection { .. } => true,
        PaperError::PartialCut { .. } => !blade.is_full_plane(),
        PaperError::SideConflict { .. } => matches!(blade, Blade::Bent(..) | Blade::Short(..)),
        _ => false,
    }
}

proptest! {
    #![proptest_config(cases(250))]

    #[test]
    fn one_plane(body in any_body(), blade in flat_blade(), level in any_level()) {
        cut_in_turn(&body, &[(blade, level)]);
    }
}

proptest! {
    #![proptest_config(cases(125))]

    #[test]
    fn sweeps_in_turn(
        body in any_body(),
        blades in prop::collection::vec((any_blade(), any_level()), 2..=6),
    ) {
        cut_in_turn(&body, &blades);
    }

    /// Removed triangles and their replacements are within one edge length of the plane.
    ///
    /// The volume that changes sides is bounded by that distance times the areas of section and
    /// removed triangles.
    #[test]
    fn a_plane_changes_nothing_beyond_one_edge_length(
        body in large_body(),
        blade in flat_blade(),
        level in any_level(),
    ) {
        let before = body.build();
        let mut surface = before.clone();
        let mut cutter = Cutter::new(&before);
        let Ok(sweep) = blade.sweep(&surface) else { return Ok(()) };
        let done = paper_cut_and_check(&mut surface, &mut cutter, &sweep, &params(level));
        let Ok(outcome) = done else { return Ok(()) };
        let replaced = RemovedSizes::of(&before, &surface, &outcome);
        let (origin, normal) = sweep.plane();
        for added in &outcome.delta.vertices_added {
            let height = normal.dot(&(surface.position(added.vertex) - origin)).abs();
            prop_assert!(
                height <= replaced.longest_edge,
                "{} is {height} from the plane, the longest edge is {}",
                added.vertex,
                replaced.longest_edge
            );
        }
        let moved = (surface.volume() - before.volume()).abs();
        let bound = replaced.mean_edge * (replaced.section + replaced.strip);
        // Coordinates are rounded to 24 bits.
        prop_assert!(moved <= bound + 1e-6 * before.volume(), "{moved} is more than {bound}");
    }

    #[test]
    fn sweeps_through_self_intersecting_bodies(
        body in self_intersecting_body(),
        blades in prop::collection::vec((any_blade(), any_level()), 1..=4),
    ) {
        cut_in_turn(&body, &blades);
    }
}
