//! Walks around vertices.

use super::Topology;
use crate::ids::{HalfEdge, VertexId};

impl Topology {
    /// The half-edges that leave `v`, counterclockwise. At a boundary vertex the walk begins at the
    /// boundary; at a vertex where several fans meet it covers the fan of `outgoing(v)`.
    pub fn outgoing_fan(&self, v: VertexId) -> impl Iterator<Item = HalfEdge> + '_ {
        let start = self.fan_start(v);
        let mut at = start;
        std::iter::from_fn(move || {
            if at.is_null() {
                return None;
            }
            let current = at;
            at = self.twin(current.prev());
            if at == start {
                at = HalfEdge::NULL;
            }
            Some(current)
        })
    }

    /// The half-edge from `a` to `b`, if a triangle of `a`'s fan has it. O(valence).
    #[must_use]
    #[inline]
    pub fn find_half_edge(&self, a: VertexId, b: VertexId) -> Option<HalfEdge> {
        self.outgoing_fan(a).find(|&h| self.target(h) == b)
    }

    /// Whether `a` and `b` are joined by an edge of `a`'s fan, in either direction. O(valence).
    #[must_use]
    #[inline]
    pub fn are_adjacent(&self, a: VertexId, b: VertexId) -> bool {
        self.outgoing_fan(a)
            .any(|h| self.target(h) == b || self.origin(h.prev()) == b)
    }

    /// Whether every edge has two triangles.
    #[must_use]
    #[inline]
    pub fn is_closed(&self) -> bool {
        self.triangles()
            .flat_map(|t| t.half_edges())
            .all(|h| !self.twin(h).is_null())
    }

    fn fan_start(&self, v: VertexId) -> HalfEdge {
        let first = self.outgoing(v);
        if first.is_null() {
            return first;
        }
        let mut at = first;
        loop {
            let twin = self.twin(at);
            if twin.is_null() {
                return at;
            }
            at = twin.next();
            if at == first {
                return first;
            }
        }
    }
}
