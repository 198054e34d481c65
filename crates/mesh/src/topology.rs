//! Connectivity of a triangle surface as a corner table.
//!
//! Three arrays are stored; everything else is arithmetic:
//!
//! - `origin[h]`: the vertex at the origin of half-edge `h`; null in a free triangle slot.
//! - `twin[h]`: the opposite half-edge; null on a boundary or in a free slot.
//! - `outgoing[v]`: one outgoing half-edge of `v`; null for an unused vertex.
//!
//! Half-edge `h = 3t + i` belongs to triangle `t = h / 3`; `next` and `prev` stay inside the
//! triangle.
//!
//! Invariants, checked by [`Topology::validate`]: `twin` is an involution between half-edges of
//! opposite direction; the three vertices of a triangle differ; `outgoing[v]` starts at `v`; free
//! slots are null and listed once.

mod build;
mod edit;
mod loops;
mod traverse;
mod validate;

#[cfg(feature = "io")]
pub(crate) use build::sort_by_edge;

use crate::ids::{HalfEdge, TriangleId, VertexId};

/// The error of triangles that do not form an oriented manifold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TopologyError {
    /// A triangle uses a vertex twice.
    #[error("triangle {triangle} uses vertex {vertex} twice; remove it")]
    RepeatedVertex {
        /// The triangle.
        triangle: TriangleId,
        /// The repeated vertex.
        vertex: VertexId,
    },
    /// A triangle uses a vertex that does not exist.
    #[error("triangle {triangle} uses vertex {vertex}; there are {vertices} vertices")]
    VertexOutOfRange {
        /// The triangle.
        triangle: TriangleId,
        /// The vertex.
        vertex: VertexId,
        /// Number of vertices.
        vertices: usize,
    },
    /// More than two triangles share an edge.
    #[error("the edge {a}-{b} has more than two triangles; separate or remove the extra ones")]
    NonManifoldEdge {
        /// One end of the edge.
        a: VertexId,
        /// The other end.
        b: VertexId,
    },
    /// Two adjacent triangles have opposite orientations.
    #[error("triangles {first} and {second} have opposite orientations; flip one")]
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
#[non_exhaustive]
pub struct InvalidTopology {
    /// The broken rule.
    pub rule: &'static str,
    /// A half-edge at which the rule is broken, or null.
    pub half_edge: HalfEdge,
    /// A vertex at which the rule is broken, or null.
    pub vertex: VertexId,
}

/// The connectivity of a triangle surface, as a corner table.
///
/// The documentation of its module describes the arrays.
#[derive(Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

/// Copies an array with its capacity.
#[inline]
pub(crate) fn copy<T: Copy>(array: &Vec<T>) -> Vec<T> {
    let mut out = Vec::with_capacity(array.capacity());
    out.extend_from_slice(array);
    out
}

impl Topology {
    /// Reserves memory for additional vertices and triangles.
    pub(crate) fn reserve(&mut self, vertices: usize, triangles: usize) {
        self.origin.reserve(3 * triangles);
        self.twin.reserve(3 * triangles);
        self.outgoing.reserve(vertices);
    }

    /// Returns the number of vertex slots, used and free: the length of every vertex array.
    #[must_use]
    #[inline]
    pub fn vertex_slots(&self) -> usize {
        self.outgoing.len()
    }

    /// Returns the number of triangle slots, used and free.
    #[must_use]
    #[inline]
    pub fn triangle_slots(&self) -> usize {
        self.origin.len() / 3
    }

    /// Returns the number of vertices, without free slots.
    #[must_use]
    #[inline]
    pub fn vertex_count(&self) -> usize {
        self.outgoing.len() - self.free_vertices.len()
    }

    /// Returns the number of triangles, without free slots.
    #[must_use]
    #[inline]
    pub fn triangle_count(&self) -> usize {
        self.triangle_slots() - self.free_triangles.len()
    }

    /// Returns whether the slot holds a triangle.
    #[must_use]
    #[inline]
    pub fn is_triangle(&self, t: TriangleId) -> bool {
        self.origin.get(3 * t.index()).is_some_and(|v| !v.is_null())
    }

    /// Returns the origin of `h`; null in a free slot.
    #[must_use]
    #[inline]
    pub fn origin(&self, h: HalfEdge) -> VertexId {
        self.origin[h.index()]
    }

    /// Returns the target of `h`.
    #[must_use]
    #[inline]
    pub fn target(&self, h: HalfEdge) -> VertexId {
        self.origin[h.next().index()]
    }

    /// Returns the opposite half-edge; null on a boundary.
    #[must_use]
    #[inline]
    pub fn twin(&self, h: HalfEdge) -> HalfEdge {
        self.twin[h.index()]
    }

    /// Returns one outgoing half-edge of `v`; null for an unused vertex or one without a slot.
    #[must_use]
    #[inline]
    pub fn outgoing(&self, v: VertexId) -> HalfEdge {
        let h = self.outgoing.get(v.index());
        h.copied().unwrap_or(HalfEdge::NULL)
    }

    /// Returns the triangle's vertices, counterclockwise seen from outside.
    #[must_use]
    #[inline]
    pub fn triangle(&self, t: TriangleId) -> [VertexId; 3] {
        let i = 3 * t.index();
        [self.origin[i], self.origin[i + 1], self.origin[i + 2]]
    }

    /// Returns the vertices of all triangles, null in free slots.
    pub(crate) fn all_corners(&self) -> &[[VertexId; 3]] {
        self.origin.as_chunks().0
    }

    /// Iterates over the triangles, in slot order.
    pub fn triangles(&self) -> impl Iterator<Item = TriangleId> + '_ {
        (0..self.triangle_slots())
            .map(TriangleId::from_index)
            .filter(|&t| self.is_triangle(t))
    }

    /// Iterates over the vertices that triangles use, in slot order.
    pub fn vertices(&self) -> impl Iterator<Item = VertexId> + '_ {
        (0..self.vertex_slots())
            .map(VertexId::from_index)
            .filter(|&v| !self.outgoing(v).is_null())
    }

    /// Iterates over the edges: the half-edge with the smaller id of each, in slot order.
    pub fn edges(&self) -> impl Iterator<Item = HalfEdge> + '_ {
        self.triangles()
            .flat_map(TriangleId::half_edges)
            .filter(|&h| {
                let twin = self.twin(h);
                twin.is_null() || h < twin
            })
    }

    /// Returns the corner array, three vertices for each triangle slot, as renderers upload it.
    #[must_use]
    #[inline]
    pub fn corners(&self) -> &[VertexId] {
        &self.origin
    }
}
