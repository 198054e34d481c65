//! Lattices that follow edits equal those built from nothing.

use super::{body, check, params, plane};
use incise_cut::{CutParams, Cutter, Incision, Sweep};
use incise_lattice::{Lattice, LatticeChange, Moments, NO_COPY};
use incise_mesh::{Surface, TopologyDelta, Undo, Vec3, VertexId};
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// An edit of a body.
#[derive(Debug, Clone)]
enum Step {
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

fn step() -> impl Strategy<Value = Step> {
    prop_oneof![
        3 => plane().prop_map(|(normal, distance)| Step::Plane(normal, distance)),
        3 => (0.0..6.3f64, -0.3..0.3f64, -0.45..0.4f64, 1u8..5).prop_map(
            |(angle, offset, depth, steps)| Step::Incision { angle, offset, depth, steps }
        ),
        1 => Just(Step::Undo),
    ]
}

/// Makes an edit. Returns its changes in order.
fn edit(
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

/// Cell, vertices and measures of a copy, which do not depend on its number.
type Key = (u32, Vec<usize>, [u64; 4]);

/// Returns copies in an order that does not depend on their numbers.
fn copies_in_order(lattice: &Lattice) -> Vec<(Key, usize)> {
    let mut vertices = BTreeMap::<usize, Vec<usize>>::new();
    for (slot, &copy) in lattice.vertex_copies.iter().enumerate() {
        if copy != NO_COPY {
            vertices.entry(copy as usize).or_default().push(slot);
        }
    }
    let copies = lattice
        .cells
        .iter()
        .enumerate()
        .filter(|own| *own.1 != NO_COPY);
    let keyed = copies.map(|(copy, &cell)| {
        let own = vertices.remove(&copy).unwrap_or_default();
        let Moments {
            fraction, center, ..
        } = lattice.moments[copy];
        let [x, y, z] = center;
        ((cell, own, [fraction, x, y, z].map(f64::to_bits)), copy)
    });
    let mut keyed: Vec<_> = keyed.collect();
    keyed.sort();
    keyed
}

/// Checks that lattices are equal up to numbers of copies and nodes.
fn check_equal(followed: &Lattice, built: &Lattice) {
    let [ours, theirs] = [followed, built].map(copies_in_order);
    for (a, b) in ours.iter().zip(&theirs) {
        assert_eq!(a.0, b.0, "copies");
    }
    assert_eq!(ours.len(), theirs.len(), "numbers of copies");
    // Copies without volume and vertices may be alike. They follow once others have given nodes.
    let [mut alone, mut alike] = [Vec::new(), Vec::new()];
    for group in (0..ours.len())
        .collect::<Vec<_>>()
        .chunk_by(|&i, &j| ours[i].0 == ours[j].0)
    {
        if group.len() == 1 {
            &mut alone
        } else {
            &mut alike
        }
        .push(group.to_vec());
    }
    let mut nodes = [BTreeMap::new(), BTreeMap::new()];
    let mut copies = BTreeMap::new();
    for group in alone.into_iter().chain(alike) {
        let mut others = group.clone();
        for i in group {
            let own = &followed.nodes[ours[i].1];
            let is_match = |&j: &usize| {
                let pairs = own.iter().zip(&built.nodes[theirs[j].1]);
                pairs.into_iter().all(|(a, b)| {
                    nodes[0].get(a).unwrap_or(b) == b && nodes[1].get(b).unwrap_or(a) == a
                })
            };
            let found = others.iter().position(is_match);
            let j = others.remove(found.expect("copies share nodes in the same way"));
            let [a, b] = [ours[i].1, theirs[j].1];
            copies.insert(a, b);
            for (&a, &b) in own.iter().zip(&built.nodes[b]) {
                nodes[0].insert(a, b);
                nodes[1].insert(b, a);
            }
            let [m, n] = [&followed.moments[a], &built.moments[b]];
            for k in 0..3 {
                assert!((m.spread[k] - n.spread[k]).abs() < 1e-12, "{m:?} {n:?}");
            }
        }
    }
    let size = followed.grid.cell_size();
    for (&a, &b) in &nodes[0] {
        let [i, j] = [a, b].map(|node| node as usize);
        assert!(followed.is_node(a), "node {a}");
        assert_eq!(
            followed.node_positions[i], built.node_positions[j],
            "node {a}"
        );
        let error = followed.node_volumes[i] - built.node_volumes[j];
        assert!(error.abs() < 1e-12 * size.powi(3), "node {a}: {error}");
    }
    let used = (0..)
        .zip(&followed.node_positions)
        .filter(|own| followed.is_node(own.0));
    assert_eq!(used.count(), nodes[0].len(), "free nodes");
    assert_eq!(
        followed.vertex_copies.len(),
        built.vertex_copies.len(),
        "vertex slots"
    );
    assert_eq!(followed.vertex_weights, built.vertex_weights, "weights");
    for (slot, (&a, &b)) in followed
        .vertex_copies
        .iter()
        .zip(&built.vertex_copies)
        .enumerate()
    {
        let copy = copies.get(&(a as usize)).copied();
        let expected = (b != NO_COPY).then_some(b as usize);
        assert_eq!(copy, expected, "vertex {slot}");
    }
}

/// Checks that a change lists all differences of lattices before and after it.
fn check_change(before: &Lattice, after: &Lattice, change: &LatticeChange) {
    let removed: BTreeSet<u32> = change.copies_removed.iter().map(|own| own.copy).collect();
    let added: BTreeSet<u32> = change.copies_added.iter().map(|own| own.copy).collect();
    let changed: BTreeSet<u32> = change.copies_changed.iter().map(|own| own.copy).collect();
    for own in change.copies_removed.iter().chain(&change.copies_changed) {
        assert_eq!(
            own.nodes, before.nodes[own.copy as usize],
            "copy {}",
            own.copy
        );
        assert_eq!(
            own.moments, before.moments[own.copy as usize],
            "copy {}",
            own.copy
        );
    }
    for (copy, i) in (0..).zip(0..after.cells.len()) {
        let is_known = [
            removed.contains(&copy),
            added.contains(&copy),
            changed.contains(&copy),
        ];
        let expected = match [before.is_copy(copy), after.is_copy(copy)] {
            [true, true] => {
                assert_eq!(before.cells[i], after.cells[i], "copy {copy}");
                let differs =
                    before.nodes[i] != after.nodes[i] || before.moments[i] != after.moments[i];
                [false, false, differs]
            }
            [had, has] => [had, has, false],
        };
        assert_eq!(is_known, expected, "copy {copy}");
    }
    for added in &change.copies_added {
        if added.parent != NO_COPY {
            assert!(
                before.is_copy(added.parent),
                "parent of copy {}",
                added.copy
            );
        }
    }
    let removed: BTreeSet<u32> = change.nodes_removed.iter().copied().collect();
    let changed: BTreeSet<u32> = change.nodes_changed.iter().copied().collect();
    let added: BTreeSet<u32> = change.nodes_added.iter().map(|own| own.node).collect();
    for (node, i) in (0..).zip(0..after.node_positions.len()) {
        let is_known = [
            removed.contains(&node),
            added.contains(&node),
            changed.contains(&node),
        ];
        let expected = match [before.is_node(node), after.is_node(node)] {
            [true, true] => {
                assert_eq!(
                    before.node_positions[i], after.node_positions[i],
                    "node {node}"
                );
                let differs = before.node_volumes[i] != after.node_volumes[i];
                [false, false, differs]
            }
            [had, has] => [had, has, false],
        };
        assert_eq!(is_known, expected, "node {node}");
    }
    let size = after.grid.cell_size();
    for added in &change.nodes_added {
        let sources = change.sources(added);
        if sources.is_empty() {
            continue;
        }
        let mut place = Vec3::zeros();
        for source in sources {
            assert!(before.is_node(source.node), "source of node {}", added.node);
            place += Vec3::from(before.node_positions[source.node as usize]) * source.weight;
        }
        let off = place - Vec3::from(after.node_positions[added.node as usize]);
        assert!(off.norm() < 1e-12 * size, "node {}: {off:?}", added.node);
    }
    let changed: BTreeSet<VertexId> = change.vertices_changed.iter().copied().collect();
    for slot in 0..after.vertex_copies.len() {
        if after.vertex_copies[slot] == NO_COPY {
            continue;
        }
        let is_same = before.vertex_copies.get(slot) == Some(&after.vertex_copies[slot])
            && before.vertex_weights[slot] == after.vertex_weights[slot];
        let v = VertexId(u32::try_from(slot).unwrap());
        assert_eq!(changed.contains(&v), !is_same, "{v}");
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
