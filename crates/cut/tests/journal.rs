//! Cuts on record are done again to the same bits, and undone ones can be.

use incise_cut::{CutError, CutMethod, CutParams, Cutter, Journal, ReplayError, Sweep};
use incise_mesh::{Surface, UndoError, icosphere};
use incise_refine::{RefineMethod, RefineParams, RefinementLevel};
use proptest::prelude::*;

fn bits<const N: usize>(values: &[[f32; N]]) -> Vec<[u32; N]> {
    values.iter().map(|v| v.map(f32::to_bits)).collect()
}

/// All of two surfaces is the same, free slots included.
fn assert_same_bits(a: &Surface, b: &Surface) {
    assert!(a == b, "the surfaces differ");
    assert!(bits(&a.positions) == bits(&b.positions), "positions differ");
    assert!(bits(&a.rest) == bits(&b.rest), "rest positions differ");
    assert_eq!(a.fingerprint(), b.fingerprint(), "the histories differ");
}

fn levels() -> impl Strategy<Value = RefinementLevel> {
    let five = (0..5_usize).prop_map(|i| RefinementLevel::FIVE[i]);
    prop_oneof![five, (0.4..2.0).prop_map(RefinementLevel::Z)]
}

/// A plane near the middle of a ball, and how to cut along it.
fn cuts() -> impl Strategy<Value = ([f64; 3], f64, CutParams)> {
    let method = prop_oneof![3 => Just(CutMethod::Exact), 1 => Just(CutMethod::Rebuild)];
    let normal = [-1.0..1.0_f64, -1.0..1.0_f64, 0.1..1.0_f64];
    let refinement = prop_oneof![Just(RefineMethod::Delaunay), Just(RefineMethod::Paper)];
    let remesh = prop_oneof![Just(0.0), 0.0..0.3_f64];
    let shape = (0.0..0.3_f64, remesh);
    let params = (method, refinement, levels(), shape, any::<u32>());
    let params = params.prop_map(
        |(method, refinement, level, (snap, remesh), cap_material)| CutParams {
            method,
            refine: RefineParams {
                method: refinement,
                level,
                ..RefineParams::default()
            },
            snap,
            remesh,
            cap_material,
            ..CutParams::default()
        },
    );
    (normal, -0.6..0.6_f64, params)
}

/// Cuts a ball and keeps the journal; returns it before and after.
fn cut_ball(cuts: &[([f64; 3], f64, CutParams)]) -> (Surface, Surface, Journal) {
    let before = icosphere(2, 1.0);
    let mut body = before.clone();
    let mut cutter = Cutter::new(&body);
    let mut journal = Journal::new(&body);
    for (normal, d, params) in cuts {
        let sweep = Sweep::across_box(*normal, *d, &body.bounds()).unwrap();
        // The paper's method refuses some cuts, which are not on record then.
        drop(journal.cut(&mut cutter, &mut body, &sweep, params));
    }
    (before, body, journal)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn a_journal_is_replayed_to_the_same_bits(cuts in prop::collection::vec(cuts(), 0..5)) {
        let (before, body, journal) = cut_ball(&cuts);
        let text = serde_json::to_string(&journal).unwrap();
        let read: Journal = serde_json::from_str(&text).unwrap();
        prop_assert_eq!(&read, &journal);
        let mut again = before;
        let outcomes = read.replay(&mut again).unwrap();
        prop_assert_eq!(outcomes.len(), journal.cuts().len());
        assert_same_bits(&again, &body);
    }

    #[test]
    fn cuts_are_undone_and_done_again(cuts in prop::collection::vec(cuts(), 1..5)) {
        let before = icosphere(2, 1.0);
        let mut body = before.clone();
        let mut cutter = Cutter::new(&body);
        let mut journal = Journal::new(&body);
        let mut done = Vec::new();
        for (normal, d, params) in &cuts {
            let sweep = Sweep::across_box(*normal, *d, &body.bounds()).unwrap();
            let was = body.clone();
            let Ok(outcome) = journal.cut(&mut cutter, &mut body, &sweep, params) else {
                prop_assert_eq!(params.method, CutMethod::Rebuild, "the exact method refused");
                continue;
            };
            prop_assert_eq!(outcome.undo.is_none(), outcome.delta.is_empty());
            done.extend(outcome.undo.map(|undo| (was, undo)));
        }
        let after = body.clone();
        let whole = journal.clone();
        while let Some((was, undo)) = done.pop() {
            if let Some((_, earlier)) = done.last() {
                prop_assert_eq!(earlier.clone().revert(&mut body), Err(UndoError::Stale));
            }
            cutter.undo(&mut body, undo).unwrap();
            cutter.bvh().validate(&body).unwrap();
            prop_assert!(journal.forget_last().is_some());
            assert_same_bits(&body, &was);
        }
        prop_assert_eq!(journal.forget_last(), None);
        whole.replay(&mut body).unwrap();
        assert_same_bits(&body, &after);
    }
}

#[test]
fn a_replay_that_differs_is_refused() {
    let plane = |d| ([0.3, 0.2, 1.0], d, CutParams::default());
    let (before, _, journal) = cut_ball(&[plane(0.1), plane(-0.4)]);
    assert_eq!(journal.cuts().len(), 2);

    let mut other = icosphere(1, 1.0);
    assert_eq!(journal.replay(&mut other), Err(ReplayError::OtherSurface));
    assert_same_bits(&other, &icosphere(1, 1.0));

    let mut moved = before.clone();
    for position in &mut moved.positions {
        position[2] *= 1.5;
    }
    let error = journal.replay(&mut moved);
    assert_eq!(error, Err(ReplayError::OtherOutcome { cut: 0 }));

    let mut journal = Journal::new(&before);
    let sweep = Sweep::across_box([0.3, 0.2, 1.0], 0.1, &before.bounds()).unwrap();
    let params = CutParams {
        snap: 0.5,
        ..CutParams::default()
    };
    journal.record(&before, &sweep, &params);
    let error = CutError::SnapOutOfRange { snap: 0.5 };
    let refused = ReplayError::Refused { cut: 0, error };
    assert_eq!(journal.replay(&mut before.clone()), Err(refused));
}

#[test]
fn a_journal_that_was_tampered_with_is_not_read() {
    let (_, _, journal) = cut_ball(&[([0.3, 0.2, 1.0], 0.1, CutParams::default())]);
    let mut value = serde_json::to_value(&journal).unwrap();
    value["entries"][0]["corners"][0][0] = f32::NAN.to_bits().into();
    let read: Result<Journal, _> = serde_json::from_value(value);
    let message = read.unwrap_err().to_string();
    assert!(
        message.contains("corner 0 of the sweep is not finite"),
        "{message}"
    );
}
