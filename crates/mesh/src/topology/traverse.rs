//! Traversal of the elements around a vertex.

use super::Topology;
use crate::ids::{HalfEdge, VertexId};

impl Topology {
    /// Iterates over the outgoing half-edges of `v`, counterclockwise.
    ///
    /// At a boundary vertex the iteration starts at the boundary. If `v` has several fans, only
    /// that of `outgoing(v)` is visited.
    pub fn outgoing_fan(&self, v: VertexId) -> impl Iterator<Item = HalfEdge> + '_ {
        let first = self.outgoing(v);
        let start = if first.is_null() {
            first
        } else {
            self.first_in_fan(first)
        };
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

    /// Returns the half-edge from `a` to `b`, if it is in `a`'s fan. O(valence).
    #[must_use]
    #[inline]
    pub fn find_half_edge(&self, a: VertexId, b: VertexId) -> Option<HalfEdge> {
        self.outgoing_fan(a).find(|&h| self.target(h) == b)
    }

    /// Returns whether `a` and `b` share an edge of `a`'s fan. O(valence).
    #[must_use]
    #[inline]
    pub fn are_adjacent(&self, a: VertexId, b: VertexId) -> bool {
        self.outgoing_fan(a)
            .any(|h| self.target(h) == b || self.origin(h.prev()) == b)
    }

    /// Returns whether every edge has two triangles.
    #[must_use]
    #[inline]
    pub fn is_closed(&self) -> bool {
        self.triangles()
            .flat_map(|t| t.half_edges())
            .all(|h| !self.twin(h).is_null())
    }

    /// Returns the first half-edge of the fan of `h`: at the boundary, or `h` in a closed fan.
    ///
    /// Valid also during an edit, unlike [`Self::outgoing_fan`].
    #[must_use]
    pub fn first_in_fan(&self, h: HalfEdge) -> HalfEdge {
        let mut at = h;
        loop {
            let twin = self.twin(at);
            if twin.is_null() {
                return at;
            }
            at = twin.next();
            if at == h {
                return h;
            }
        }
    }
}
