//! The vertices that stand in for a removed vertex, whose motion it takes when an undo restores it.

use super::finish::Change;
use crate::delta::{TopologyDelta, VertexOrigin};
use crate::ids::VertexId;
use crate::surface::Surface;
use std::collections::VecDeque;

/// A vertex that an edit removed, and the origin with which it can be restored.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Restored {
    pub(super) vertex: VertexId,
    pub(super) origin: VertexOrigin,
    /// Position \[m\] and inverse mass \[1/kg\] at its removal.
    pub(super) at: [f32; 4],
    /// Positions of the origin's parents at that time \[m\].
    pub(super) parents_at: [[f32; 3]; 3],
}

impl Restored {
    /// Stores the positions of the vertex and its parents.
    pub(super) fn place_from(&mut self, surface: &Surface) {
        let place = |v: VertexId| {
            let [x, y, z, _] = surface.positions[v.index()];
            [x, y, z]
        };
        self.at = surface.positions[self.vertex.index()];
        self.parents_at = self.origin.weights().map(|(v, _)| place(v));
    }
}

/// Returns the vertices that `delta` removed, parents before children.
pub(super) fn restored(
    surface: &Surface,
    delta: &TopologyDelta,
    changes: &[Change],
) -> Vec<Restored> {
    let removed = &delta.vertices_removed;
    let (Some(&first), Some(&last)) = (removed.first(), removed.last()) else {
        return Vec::new();
    };
    // Most lookups fail, and most of those are outside the range.
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
    let mut order: Vec<(usize, VertexOrigin)> = Vec::with_capacity(removed.len());
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
    // The others take a neighbor that is restored before them as parent.
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
    let entry = |(i, origin): (usize, VertexOrigin)| {
        let mut entry = Restored {
            vertex: removed[i],
            origin,
            at: [0.0; 4],
            parents_at: [[0.0; 3]; 3],
        };
        entry.place_from(surface);
        entry
    };
    order.into_iter().map(entry).collect()
}

/// Returns the new vertices created from removed ones: removed index, vertex and weight.
///
/// The largest weight comes first.
fn children(
    delta: &TopologyDelta,
    number: impl Fn(VertexId) -> Option<usize>,
) -> Vec<(usize, VertexId, f32)> {
    let mut children = Vec::new();
    for added in &delta.vertices_added {
        // Few vertices have a removed parent.
        let parents = added.origin.parents();
        if parents.into_iter().all(|parent| number(parent).is_none()) {
            continue;
        }
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

/// Returns the removed vertices with their neighbors before the edit, ascending.
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

/// Returns an origin between the first three of `relatives`, if there are any.
fn between(relatives: &[(VertexId, f32)]) -> Option<VertexOrigin> {
    let &(first, _) = relatives.first()?;
    let relative = |i: usize| relatives.get(i).copied().unwrap_or((first, 0.0));
    Some(VertexOrigin::Restored {
        parents: [0, 1, 2].map(|i| relative(i).0),
        weights: [0, 1, 2].map(|i| relative(i).1),
    })
}

fn alone(parent: VertexId) -> VertexOrigin {
    VertexOrigin::Restored {
        parents: [parent; 3],
        weights: [1.0, 0.0, 0.0],
    }
}
