//! The loops of the rim as linked lists, and fans around their vertices.

use super::open::Sides;
use crate::intersection::trace::Trace;
use incise_mesh::{HalfEdge, Topology, VertexId};

/// Linked lists of the nodes of each loop. Merged nodes are removed.
#[derive(Debug, Clone, Default)]
pub(crate) struct Rim {
    pub(super) next: Vec<u32>,
    pub(super) prev: Vec<u32>,
    pub(super) is_removed: Vec<bool>,
    /// Number of nodes in each loop, and the loop of each node.
    pub(super) sizes: Vec<u32>,
    pub(super) loop_of: Vec<u32>,
    /// A remaining node of each loop.
    pub(super) first: Vec<u32>,
}

impl Rim {
    pub(super) fn reset(&mut self, trace: &Trace) {
        let count = trace.nodes.len();
        for array in [&mut self.next, &mut self.prev, &mut self.loop_of] {
            array.clear();
            array.resize(count, 0);
        }
        self.is_removed.clear();
        self.is_removed.resize(count, false);
        self.sizes.clear();
        self.first.clear();
        for (i, range) in (0..).zip(&trace.loops) {
            for node in range.clone() {
                let next = if node + 1 == range.end {
                    range.start
                } else {
                    node + 1
                };
                self.next[node as usize] = next;
                self.prev[next as usize] = node;
                self.loop_of[node as usize] = i;
            }
            self.sizes.push(range.end - range.start);
            self.first.push(range.start);
        }
    }

    /// Removes a node from its loop.
    pub(super) fn remove(&mut self, node: u32) {
        let (prev, next) = (self.prev[node as usize], self.next[node as usize]);
        self.next[prev as usize] = next;
        self.prev[next as usize] = prev;
        self.is_removed[node as usize] = true;
        let i = self.loop_of[node as usize] as usize;
        self.sizes[i] -= 1;
        if self.first[i] == node {
            self.first[i] = next;
        }
    }

    /// Iterates over the nodes of loop `i`, in order.
    pub(super) fn ring(&self, i: usize) -> impl Iterator<Item = u32> + '_ {
        let first = self.first[i];
        let mut at = Some(first);
        std::iter::from_fn(move || {
            let node = at?;
            let next = self.next[node as usize];
            at = (next != first).then_some(next);
            Some(node)
        })
    }

    /// Iterates over the half-edges that leave a node's vertex on a side, from boundary to
    /// boundary.
    pub(super) fn fan<'a>(
        &'a self,
        topology: &'a Topology,
        sides: &'a Sides,
        node: u32,
        side: usize,
    ) -> impl Iterator<Item = HalfEdge> + 'a {
        let start = if side == 0 {
            self.prev[node as usize]
        } else {
            node
        };
        let mut at = sides.rim[start as usize][side];
        std::iter::from_fn(move || {
            if at.is_null() {
                return None;
            }
            let current = at;
            at = topology.twin(current.prev());
            Some(current)
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
