//! Comparisons of lattices before and after edits.

use incise_lattice::{Lattice, LatticeChange, Moments, NO_COPY};
use incise_mesh::{Vec3, VertexId};
use std::collections::{BTreeMap, BTreeSet};

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
pub(super) fn check_equal(followed: &Lattice, built: &Lattice) {
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
pub(super) fn check_change(before: &Lattice, after: &Lattice, change: &LatticeChange) {
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
