//! The curves of the rim as linked lists, and fans around their vertices.

use super::open::Sides;
use crate::intersection::trace::Trace;
use incise_mesh::{HalfEdge, Topology, VertexId};
use std::ops::Range;

/// No node: beyond the ends of an open curve.
pub(super) const NO_NODE: u32 = u32::MAX;

/// Linked lists of the nodes of each curve. Merged nodes are removed.
#[derive(Debug, Clone, Default)]
pub(crate) struct Rim {
    pub(super) next: Vec<u32>,
    pub(super) prev: Vec<u32>,
    pub(super) is_removed: Vec<bool>,
    /// Number of nodes in each curve, and the curve of each node.
    pub(super) sizes: Vec<u32>,
    pub(super) curve_of: Vec<u32>,
    /// The first node of each open curve, a remaining node of each closed one.
    pub(super) first: Vec<u32>,
    /// Whether caps or walls close each curve.
    is_capped: Vec<bool>,
    /// Pairs of nodes that share a vertex on a side. Each has a part of its fan.
    pub(super) pinches: Vec<([u32; 2], usize)>,
}

impl Rim {
    pub(super) fn reset(&mut self, trace: &Trace) {
        let count = trace.nodes.len();
        for array in [&mut self.next, &mut self.prev, &mut self.curve_of] {
            array.clear();
            array.resize(count, NO_NODE);
        }
        self.is_removed.clear();
        self.is_removed.resize(count, false);
        self.sizes.clear();
        self.first.clear();
        self.is_capped.clear();
        self.pinches.clear();
        for (i, curve) in (0..).zip(&trace.curves) {
            let Range { start, end } = curve.nodes;
            for node in start..end {
                self.curve_of[node as usize] = i;
                let next = if node + 1 < end { node + 1 } else { start };
                if next != start || curve.is_closed {
                    self.next[node as usize] = next;
                    self.prev[next as usize] = node;
                }
            }
            self.sizes.push(end - start);
            self.first.push(start);
            self.is_capped.push(curve.is_capped);
        }
    }

    /// Returns whether an open curve ends at a node.
    pub(super) fn is_end(&self, node: u32) -> bool {
        self.prev[node as usize] == NO_NODE || self.next[node as usize] == NO_NODE
    }

    /// Returns whether the curve of a node is closed.
    pub(super) fn is_closed(&self, node: u32) -> bool {
        !self.is_end(self.first[self.curve_of[node as usize] as usize])
    }

    /// Returns whether caps or walls close the curve of a node.
    pub(super) fn is_capped(&self, node: u32) -> bool {
        self.is_capped[self.curve_of[node as usize] as usize]
    }

    /// Returns whether an open curve ends at a node or at one beside it.
    pub(super) fn is_near_end(&self, node: u32) -> bool {
        let [prev, next] = [&self.prev, &self.next].map(|list| list[node as usize]);
        [prev, node, next]
            .into_iter()
            .any(|node| node == NO_NODE || self.is_end(node))
    }

    /// Removes a node from its curve, not an end.
    pub(super) fn remove(&mut self, node: u32) {
        let (prev, next) = (self.prev[node as usize], self.next[node as usize]);
        self.next[prev as usize] = next;
        self.prev[next as usize] = prev;
        self.is_removed[node as usize] = true;
        let i = self.curve_of[node as usize] as usize;
        self.sizes[i] -= 1;
        if self.first[i] == node {
            self.first[i] = next;
        }
    }

    /// Iterates over the nodes of curve `i`, in order.
    pub(super) fn ring(&self, i: usize) -> impl Iterator<Item = u32> + '_ {
        let first = self.first[i];
        let mut at = Some(first);
        std::iter::from_fn(move || {
            let node = at?;
            let next = self.next[node as usize];
            at = (next != first && next != NO_NODE).then_some(next);
            Some(node)
        })
    }

    /// Iterates over the half-edges of a node's fan on a side, from boundary to boundary.
    ///
    /// Where a curve ends on the sweep's boundary, those of both sides count.
    pub(super) fn fan<'a>(
        &'a self,
        topology: &'a Topology,
        sides: &'a Sides,
        node: u32,
        side: usize,
    ) -> impl Iterator<Item = HalfEdge> + 'a {
        let (prev, next) = (self.prev[node as usize], self.next[node as usize]);
        let [below, above] = sides.vertices[node as usize];
        let mut at = match side {
            0 if prev != NO_NODE => sides.rim[prev as usize][0],
            1 if next != NO_NODE => sides.rim[node as usize][1],
            _ if below == above && prev == NO_NODE => sides.rim[node as usize][1],
            _ if below == above => sides.rim[prev as usize][0],
            // At the surface's boundary the rim's last half-edge runs to the vertex.
            0 => topology.first_in_fan(sides.rim[node as usize][0].next()),
            _ => topology.first_in_fan(sides.rim[prev as usize][1].next()),
        };
        std::iter::from_fn(move || {
            if at.is_null() {
                return None;
            }
            let current = at;
            at = topology.twin(current.prev());
            Some(current)
        })
    }

    /// Returns whether an edge of the surface joins a node's vertex to `others` on either side.
    pub(super) fn is_beside(
        &self,
        topology: &Topology,
        sides: &Sides,
        node: u32,
        others: [VertexId; 2],
    ) -> bool {
        (0..2).zip(others).any(|(side, other)| {
            let mut fan = self.fan(topology, sides, node, side);
            fan.any(|h| topology.target(h) == other || topology.origin(h.prev()) == other)
        })
    }

    /// Appends the neighbors of a node's vertex on a side.
    pub(super) fn neighbors(
        &self,
        topology: &Topology,
        sides: &Sides,
        node: u32,
        side: usize,
        out: &mut Vec<VertexId>,
    ) {
        let mut last = VertexId::NULL;
        for h in self.fan(topology, sides, node, side) {
            out.push(topology.target(h));
            last = topology.origin(h.prev());
        }
        out.push(last);
    }
}
