//! Lattices that follow edits equal those built from nothing.

mod checks;

use super::{body, check, params, plane};
use checks::{check_change, check_equal};
use incise_cut::{CutParams, Cutter, Incision, Sweep};
use incise_lattice::{Lattice, LatticeChange};
use incise_mesh::{Surface, TopologyDelta, Undo};
use proptest::prelude::*;

/// An edit of a body.
#[derive(Debug, Clone)]
pub(super) enum Step {
    /// A cut along a plane, given by a normal and a distance from the origin \[m\].
    Plane([f64; 3], f64),
    /// An incision from above along a direction, in steps down to a height \[m\].
    Incision {
        angle: f64,
        offset: f64,
        depth: f64,
        steps: u8,
    },
    /// The undo of the last edit, if there is one.
    Undo,
}

pub(super) fn step() -> impl Strategy<Value = Step> {
    prop_oneof![
        3 => plane().prop_map(|(normal, distance)| Step::Plane(normal, distance)),
        3 => (0.0..6.3f64, -0.3..0.3f64, -0.45..0.4f64, 1u8..5).prop_map(
            |(angle, offset, depth, steps)| Step::Incision { angle, offset, depth, steps }
        ),
        1 => Just(Step::Undo),
    ]
}

/// Makes an edit. Returns its changes in order.
pub(super) fn edit(
    surface: &mut Surface,
    cutter: &mut Cutter,
    undos: &mut Vec<Undo>,
    step: &Step,
    mut follow: impl FnMut(&Surface, &TopologyDelta),
) {
    let params = CutParams::default();
    match *step {
        Step::Plane(normal, distance) => {
            let Ok(sweep) = Sweep::from_plane(normal, distance, &surface.bounds()) else {
                return;
            };
            if let Ok(outcome) = cutter.cut(surface, &sweep, &params) {
                follow(surface, &outcome.delta);
                undos.extend(outcome.undo);
            }
        }
        Step::Incision {
            angle,
            offset,
            depth,
            steps,
        } => {
            let mut incision = Incision::default();
            let (sin, cos) = angle.sin_cos();
            for i in 0..=steps {
                let part = f64::from(i) / f64::from(steps);
                let z = 0.7 + (depth - 0.7) * part;
                let edge = [-1.0, 1.0].map(|along: f64| {
                    let p = [along * cos - offset * sin, along * sin + offset * cos, z];
                    #[expect(clippy::cast_possible_truncation, reason = "a blade")]
                    p.map(|x| x as f32)
                });
                let outcome = cutter.advance(surface, &mut incision, &edge, &params);
                let Ok(outcome) = outcome else { continue };
                follow(surface, &outcome.delta);
                undos.extend(outcome.undo);
            }
        }
        Step::Undo => {
            if let Some(undo) = undos.pop()
                && let Ok(delta) = cutter.undo(surface, undo)
            {
                follow(surface, &delta);
            }
        }
    }
}

/// Makes edits that a lattice follows, and checks it after each. Returns the number of edits.
///
/// The body is bent by a displacement across per square of height \[1/m\].
fn check_steps(number: u8, size: f64, bend: f32, steps: &[Step]) -> usize {
    let mut surface = body(number);
    for p in surface.positions_mut() {
        p[0] += bend * p[2] * p[2];
    }
    let mut cutter = Cutter::new(&surface);
    let mut undos = Vec::new();
    let mut lattice = Lattice::build(&surface, &params(size)).unwrap();
    let mut change = LatticeChange::default();
    let mut count = 0;
    for step in steps {
        edit(
            &mut surface,
            &mut cutter,
            &mut undos,
            step,
            |surface, delta| {
                let before = lattice.clone();
                lattice.follow(surface, delta, &mut change);
                let built = Lattice::in_grid(surface, lattice.grid);
                check_equal(&lattice, &built);
                check(surface, &built);
                check_change(&before, &lattice, &change);
                // A new change has no memory of others.
                let mut again = before;
                again.follow(surface, delta, &mut LatticeChange::default());
                assert_eq!(again, lattice, "the same edit gives the same lattice");
                count += usize::from(!delta.is_empty());
            },
        );
    }
    count
}

#[test]
fn an_incision_and_its_undo_are_followed() {
    let incision = Step::Incision {
        angle: 0.3,
        offset: 0.05,
        depth: -0.2,
        steps: 4,
    };
    let mut steps = vec![incision, Step::Plane([1.0, 0.2, 0.1], 0.05)];
    steps.extend([Step::Undo, Step::Undo, Step::Undo, Step::Undo, Step::Undo]);
    for number in 0..3 {
        let count = check_steps(number, 0.11, 0.0, &steps);
        assert!(count > 6, "body {number}: {count} edits");
    }
}

#[test]
fn copies_away_from_a_cut_keep_their_numbers() {
    let mut surface = body(0);
    let mut cutter = Cutter::new(&surface);
    let mut lattice = Lattice::build(&surface, &params(0.08)).unwrap();
    let before = lattice.clone();
    let mut change = LatticeChange::default();
    let plane = Step::Plane([1.0, 0.0, 0.0], 0.01);
    edit(
        &mut surface,
        &mut cutter,
        &mut Vec::new(),
        &plane,
        |surface, delta| {
            lattice.follow(surface, delta, &mut change);
        },
    );
    assert!(!change.copies_added.is_empty());
    let is_far = |copy: usize| {
        let cell = before.grid.cell(before.cells[copy]);
        let center = before.grid.corner(cell, 0)[0] + 0.04;
        (center - 0.01).abs() > 3.0 * 0.08
    };
    let far: Vec<usize> = (0..before.cells.len())
        .filter(|&copy| is_far(copy))
        .collect();
    assert!(far.len() > before.cells.len() / 4, "{} copies", far.len());
    for copy in far {
        assert_eq!(before.cells[copy], lattice.cells[copy], "copy {copy}");
        assert_eq!(before.nodes[copy], lattice.nodes[copy], "copy {copy}");
        assert_eq!(before.moments[copy], lattice.moments[copy], "copy {copy}");
    }
}

#[test]
fn freed_numbers_are_used_again() {
    let mut surface = body(2);
    let mut cutter = Cutter::new(&surface);
    let mut undos = Vec::new();
    let mut lattice = Lattice::build(&surface, &params(0.12)).unwrap();
    let mut change = LatticeChange::default();
    let mut slots = Vec::new();
    for _ in 0..6 {
        for step in [Step::Plane([0.2, 0.1, 1.0], 0.05), Step::Undo] {
            edit(
                &mut surface,
                &mut cutter,
                &mut undos,
                &step,
                |surface, delta| {
                    lattice.follow(surface, delta, &mut change);
                },
            );
        }
        slots.push([lattice.cells.len(), lattice.node_positions.len()]);
    }
    assert_eq!(slots[2], slots[5], "{slots:?}");
}

proptest! {
    /// Followed lattices equal those built from nothing after any cuts, incisions and undos, also
    /// of bodies that are bent when they are cut.
    #[test]
    fn followed_lattices_equal_built_ones(
        number in 0u8..4,
        size in 0.06..0.5f64,
        bend in prop_oneof![Just(0.0), 0.0..1.0f32],
        steps in prop::collection::vec(step(), 1..6),
    ) {
        check_steps(number, size, bend, &steps);
    }

    /// A lattice that misses edits is wrong, but it does not panic.
    #[test]
    fn missed_edits_do_not_panic(
        number in 0u8..4,
        size in 0.1..0.5f64,
        steps in prop::collection::vec((step(), any::<bool>()), 1..8),
    ) {
        let mut surface = body(number);
        let mut cutter = Cutter::new(&surface);
        let mut undos = Vec::new();
        let mut lattice = Lattice::build(&surface, &params(size)).unwrap();
        let mut change = LatticeChange::default();
        for (step, is_missed) in &steps {
            edit(&mut surface, &mut cutter, &mut undos, step, |surface, delta| {
                if !is_missed {
                    lattice.follow(surface, delta, &mut change);
                }
            });
        }
    }
}
