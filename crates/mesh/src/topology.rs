//! Connectivity as a corner table.
//!
//! Three arrays are stored and the rest is arithmetic:
//!
//! - `origin[h]`: the vertex at the corner that half-edge `h` leaves; null in a free triangle slot.
//! - `twin[h]`: the half-edge on the other side of the same edge; null on a boundary or in a free slot.
//! - `outgoing[v]`: one half-edge that leaves `v`; null for a vertex that no triangle uses.
//!
//! Half-edge `h = 3t + i` belongs to triangle `t = h / 3`; `next` and `prev` stay inside the triangle.
//!
//! Invariants, checked by [`Topology::validate`]: `twin` is an involution between half-edges of
//! opposite direction; the three vertices of a triangle differ; `outgoing[v]` leaves `v`; free slots
//! are null throughout and listed once.

mod build;
mod edit;
mod loops;
mod traverse;
mod validate;

use crate::ids::{HalfEdge, TriangleId, VertexId};

/// Why triangles do not make a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TopologyError {
    /// A triangle names a vertex twice.
    #[error("triangle {triangle} uses vertex {vertex} twice; remove it")]
    RepeatedVertex {
        /// The triangle.
        triangle: TriangleId,
        /// The repeated vertex.
        vertex: VertexId,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} uses vertex {vertex}, but there are only {vertices} vertices")]
    VertexOutOfRange {
        /// The triangle.
        triangle: TriangleId,
        /// The vertex.
        vertex: VertexId,
        /// How many vertices there are.
        vertices: usize,
    },
    /// More than two triangles meet in an edge.
    #[error("more than two triangles meet in the edge {a}-{b}; split it or remove the extra ones")]
    NonManifoldEdge {
        /// One end.
        a: VertexId,
        /// The other end.
        b: VertexId,
    },
    /// Two triangles run along their common edge in the same direction.
    #[error("triangles {first} and {second} are wound against each other; flip one")]
    InconsistentWinding {
        /// One triangle.
        first: TriangleId,
        /// The other.
        second: TriangleId,
    },
}

/// A broken invariant of a [`Topology`], found by [`Topology::validate`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{rule} does not hold at {half_edge}, {vertex}")]
pub struct InvalidTopology {
    /// The broken rule.
    pub rule: &'static str,
    /// Where, or null.
    pub half_edge: HalfEdge,
    /// Where, or null.
    pub vertex: VertexId,
}

/// Who is whose neighbor: the connectivity of a triangle surface. See the module's first lines for the arrays.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Topology {
    pub(crate) origin: Vec<VertexId>,
    pub(crate) twin: Vec<HalfEdge>,
    pub(crate) outgoing: Vec<HalfEdge>,
    pub(crate) free_triangles: Vec<TriangleId>,
    pub(crate) free_vertices: Vec<VertexId>,
}

impl Clone for Topology {
    fn clone(&self) -> Self {
        Self {
            origin: copy(&self.origin),
            twin: copy(&self.twin),
            outgoing: copy(&self.outgoing),
            free_triangles: copy(&self.free_triangles),
            free_vertices: copy(&self.free_vertices),
        }
    }
}

/// A copy with as much room to grow as the original.
#[inline]
pub(crate) fn copy<T: Copy>(array: &Vec<T>) -> Vec<T> {
    let mut out = Vec::with_capacity(array.capacity());
    out.extend_from_slice(array);
    out
}

impl Topology {
    /// Makes room for so many vertices and triangles more.
    pub(crate) fn reserve(&mut self, vertices: usize, triangles: usize) {
        self.origin.reserve(3 * triangles);
        self.twin.reserve(3 * triangles);
        self.outgoing.reserve(vertices);
    }

    /// Slots for vertices, used and free: the length of every vertex array.
    #[must_use]
    #[inline]
    pub fn vertex_slots(&self) -> usize {
        self.outgoing.len()
    }

    /// Slots for triangles, used and free.
    #[must_use]
    #[inline]
    pub fn triangle_slots(&self) -> usize {
        self.origin.len() / 3
    }

    /// Vertices that are not free.
    #[must_use]
    #[inline]
    pub fn vertex_count(&self) -> usize {
        self.outgoing.len() - self.free_vertices.len()
    }

    /// Triangles that are not free.
    #[must_use]
    #[inline]
    pub fn triangle_count(&self) -> usize {
        self.triangle_slots() - self.free_triangles.len()
    }

    /// Whether the slot holds a triangle.
    #[must_use]
    #[inline]
    pub fn is_triangle(&self, t: TriangleId) -> bool {
        self.origin.get(3 * t.index()).is_some_and(|v| !v.is_null())
    }

    /// The vertex that `h` leaves; null in a free slot.
    #[must_use]
    #[inline]
    pub fn origin(&self, h: HalfEdge) -> VertexId {
        self.origin[h.index()]
    }

    /// The vertex that `h` runs to.
    #[must_use]
    #[inline]
    pub fn target(&self, h: HalfEdge) -> VertexId {
        self.origin[h.next().index()]
    }

    /// The half-edge across the edge; null on a boundary.
    #[must_use]
    #[inline]
    pub fn twin(&self, h: HalfEdge) -> HalfEdge {
        self.twin[h.index()]
    }

    /// One half-edge that leaves `v`; null when no triangle uses `v`. That may be a vertex of an
    /// undone edit, whose slot is no more.
    #[must_use]
    #[inline]
    pub fn outgoing(&self, v: VertexId) -> HalfEdge {
        let h = self.outgoing.get(v.index());
        h.copied().unwrap_or(HalfEdge::NULL)
    }

    /// The triangle's vertices, counterclockwise seen from outside.
    #[must_use]
    #[inline]
    pub fn triangle(&self, t: TriangleId) -> [VertexId; 3] {
        let i = 3 * t.index();
        [self.origin[i], self.origin[i + 1], self.origin[i + 2]]
    }

    /// The triangles, in slot order.
    pub fn triangles(&self) -> impl Iterator<Item = TriangleId> + '_ {
        (0..self.triangle_slots())
            .map(TriangleId::from_index)
            .filter(|&t| self.is_triangle(t))
    }

    /// The vertices that some triangle uses, in slot order.
    pub fn vertices(&self) -> impl Iterator<Item = VertexId> + '_ {
        (0..self.vertex_slots())
            .map(VertexId::from_index)
            .filter(|&v| !self.outgoing(v).is_null())
    }

    /// One half-edge of every edge: the one with the smaller id, in slot order.
    pub fn edges(&self) -> impl Iterator<Item = HalfEdge> + '_ {
        self.triangles()
            .flat_map(TriangleId::half_edges)
            .filter(|&h| {
                let twin = self.twin(h);
                twin.is_null() || h < twin
            })
    }

    /// The raw corner array, three vertices a triangle slot: what a renderer uploads.
    #[must_use]
    #[inline]
    pub fn corners(&self) -> &[VertexId] {
        &self.origin
    }
}
