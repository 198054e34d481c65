//! Validation of the corner table.

use super::{InvalidTopology, Topology};
use crate::ids::{HalfEdge, VertexId};

impl Topology {
    /// Checks every invariant of the arrays. O(n).
    ///
    /// # Errors
    /// The first broken rule and its place.
    pub fn validate(&self) -> Result<(), InvalidTopology> {
        let broken = |rule, half_edge, vertex| {
            Err(InvalidTopology {
                rule,
                half_edge,
                vertex,
            })
        };
        if self.twin.len() != self.origin.len() || !self.origin.len().is_multiple_of(3) {
            return broken(
                "arrays have matching lengths",
                HalfEdge::NULL,
                VertexId::NULL,
            );
        }
        for h in (0..self.origin.len()).map(HalfEdge::from_index) {
            let (v, twin) = (self.origin(h), self.twin(h));
            let corners = self.triangle(h.triangle());
            if corners.iter().any(|c| c.is_null()) != corners.iter().all(|c| c.is_null()) {
                return broken("a slot is free as a whole", h, v);
            }
            if v.is_null() {
                if !twin.is_null() {
                    return broken("a free slot has no neighbors", h, v);
                }
                continue;
            }
            if v.index() >= self.outgoing.len() || v == self.target(h) {
                return broken("corners are distinct vertices", h, v);
            }
            if !twin.is_null() && twin.index() >= self.twin.len() {
                return broken("twins are half-edges", h, v);
            }
            if !twin.is_null()
                && (self.twin(twin) != h
                    || self.origin(twin) != self.target(h)
                    || self.target(twin) != v)
            {
                return broken("twins run against each other", h, v);
            }
            if self.outgoing(v).is_null() {
                return broken("a used vertex has an outgoing half-edge", h, v);
            }
        }
        for v in self.vertices() {
            let h = self.outgoing(v);
            if h.index() >= self.origin.len() || self.origin(h) != v {
                return broken("outgoing leaves its vertex", h, v);
            }
        }
        let mut free: Vec<_> = self.free_triangles.clone();
        free.sort_unstable();
        free.dedup();
        let empty = self.triangle_slots() - self.triangles().count();
        if free.len() != self.free_triangles.len()
            || free.len() != empty
            || free.iter().any(|&t| self.is_triangle(t))
        {
            return broken(
                "free triangles are listed once",
                HalfEdge::NULL,
                VertexId::NULL,
            );
        }
        let mut free = self.free_vertices.clone();
        free.sort_unstable();
        free.dedup();
        if free.len() != self.free_vertices.len()
            || free.iter().any(|&v| !self.outgoing(v).is_null())
        {
            return broken(
                "free vertices are listed once",
                HalfEdge::NULL,
                VertexId::NULL,
            );
        }
        Ok(())
    }
}
