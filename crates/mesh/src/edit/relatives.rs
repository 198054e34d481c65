//! Who moves in the place of a removed vertex, should it come back.

use super::finish::Change;
use crate::delta::{Origin, TopologyDelta};
use crate::ids::VertexId;
use crate::surface::Surface;
use std::collections::VecDeque;

/// A vertex that an edit removed: how it can come back.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Restored {
    pub(super) vertex: VertexId,
    pub(super) origin: Origin,
    /// Position \[m\] and inverse mass \[1/kg\] when it went.
    pub(super) at: [f32; 4],
    /// Where the origin's parents were then \[m\].
    pub(super) parents_at: [[f32; 3]; 3],
}

/// The vertices that `delta` removed, parents before children.
pub(super) fn restored(
    surface: &Surface,
    delta: &TopologyDelta,
    changes: &[Change],
) -> Vec<Restored> {
    let removed = &delta.vertices_removed;
    let (Some(&first), Some(&last)) = (removed.first(), removed.last()) else {
        return Vec::new();
    };
    // Most are asked for in vain, and most of these lie outside the range.
    let number = |v: VertexId| {
        let is_near = first <= v && v <= last;
        is_near.then(|| removed.binary_search(&v).ok()).flatten()
    };
    let children = children(delta, number);
    let neighbors = neighbors(changes, number);
    let of = |list: &[(usize, VertexId)], i: usize| {
        let (first, last) = (
            list.partition_point(|entry| entry.0 < i),
            list.partition_point(|entry| entry.0 <= i),
        );
        first..last
    };
    let mut order: Vec<(usize, Origin)> = Vec::with_capacity(removed.len());
    let mut known = vec![false; removed.len()];
    for i in 0..removed.len() {
        let own = children.partition_point(|c| c.0 < i)..children.partition_point(|c| c.0 <= i);
        let own: Vec<(VertexId, f32)> = children[own].iter().map(|c| (c.1, c.2)).collect();
        let alive: Vec<(VertexId, f32)> = neighbors[of(&neighbors, i)]
            .iter()
            .filter(|&&(_, v)| number(v).is_none())
            .map(|&(_, v)| (v, 1.0))
            .collect();
        let relatives = if own.is_empty() { alive } else { own };
        if let Some(origin) = between(&relatives) {
            known[i] = true;
            order.push((i, origin));
        }
    }
    // The others follow a neighbor that comes back before them.
    let mut queue: VecDeque<usize> = order.iter().map(|entry| entry.0).collect();
    let mut next = 0;
    loop {
        while let Some(i) = queue.pop_front() {
            for &(_, v) in &neighbors[of(&neighbors, i)] {
                if let Some(j) = number(v).filter(|&j| !known[j]) {
                    known[j] = true;
                    order.push((j, alone(removed[i])));
                    queue.push_back(j);
                }
            }
        }
        while next < removed.len() && known[next] {
            next += 1;
        }
        if next == removed.len() {
            break;
        }
        known[next] = true;
        order.push((next, alone(removed[next])));
        queue.push_back(next);
    }
    let place = |v: VertexId| {
        let [x, y, z, _] = surface.positions[v.index()];
        [x, y, z]
    };
    let entry = |(i, origin): (usize, Origin)| Restored {
        vertex: removed[i],
        origin,
        at: surface.positions[removed[i].index()],
        parents_at: origin.weights().map(|(v, _)| place(v)),
    };
    order.into_iter().map(entry).collect()
}

/// New vertices that were made from removed ones: the removed one's number, the new one and its
/// share, the largest share first.
fn children(
    delta: &TopologyDelta,
    number: impl Fn(VertexId) -> Option<usize>,
) -> Vec<(usize, VertexId, f32)> {
    let mut children = Vec::new();
    for added in &delta.vertices_added {
        for (parent, weight) in added.origin.weights() {
            if let Some(i) = number(parent).filter(|_| weight > 0.0) {
                #[expect(clippy::cast_possible_truncation, reason = "rounded once to storage")]
                children.push((i, added.vertex, weight as f32));
            }
        }
    }
    children.sort_by(|a, b| a.0.cmp(&b.0).then(b.2.total_cmp(&a.2)));
    children
}

/// Removed vertices with their neighbors before the edit, ascending.
fn neighbors(
    changes: &[Change],
    number: impl Fn(VertexId) -> Option<usize>,
) -> Vec<(usize, VertexId)> {
    let mut neighbors = Vec::new();
    for [a, b, c] in changes.iter().map(|change| change.before) {
        for (v, others) in [(a, [b, c]), (b, [c, a]), (c, [a, b])] {
            if let Some(i) = number(v) {
                neighbors.extend(others.map(|other| (i, other)));
            }
        }
    }
    neighbors.sort_unstable();
    neighbors.dedup();
    neighbors
}

/// An origin between the first three of `relatives`, if there are any.
fn between(relatives: &[(VertexId, f32)]) -> Option<Origin> {
    let &(first, _) = relatives.first()?;
    let relative = |i: usize| relatives.get(i).copied().unwrap_or((first, 0.0));
    Some(Origin::Restored {
        parents: [0, 1, 2].map(|i| relative(i).0),
        weights: [0, 1, 2].map(|i| relative(i).1),
    })
}

fn alone(parent: VertexId) -> Origin {
    Origin::Restored {
        parents: [parent; 3],
        weights: [1.0, 0.0, 0.0],
    }
}
