//! [`ContinuedTip`]: where a sweep opens the surface by identity instead of cutting it.

use crate::sizing::RestShape;
use incise_mesh::{HalfEdge, Vec3, VertexId};

/// The tip of an incision that a sweep continues.
///
/// Corners of the sweep lie exactly on vertices of the surface. There the surface is not cut by
/// predicates but opened by identity.
#[derive(Debug, Clone, Default)]
pub(crate) struct ContinuedTip {
    pub(crate) parts: Vec<TipPart>,
    /// The current points in the present shape \[m\], if the sweep is in the rest shape.
    pub(crate) present: Vec<Vec3>,
}

/// A part of the tip: a chain of surface edges along the sweep's boundary, at which two walls meet.
///
/// In a sheet it is a single vertex. The sweep is on its left.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct TipPart {
    /// The corners of the sweep. Current points follow all previous ones.
    pub(crate) corners: Vec<u32>,
    /// The vertices at the corners.
    pub(crate) vertices: Vec<VertexId>,
    /// The half-edge from each vertex to the next one; in a ring also from the last to the first.
    pub(crate) half_edges: Vec<HalfEdge>,
}

impl ContinuedTip {
    /// Returns whether the sweep is in the rest shape of the body.
    pub(crate) fn is_in_rest_shape(&self) -> bool {
        !self.present.is_empty()
    }

    /// Returns the shape in which rest positions are.
    pub(crate) fn rest_shape(&self) -> RestShape {
        if self.is_in_rest_shape() {
            RestShape::Present
        } else {
            RestShape::Rest
        }
    }

    /// Returns the part that begins at a vertex.
    pub(crate) fn part_from(&self, vertex: VertexId) -> Option<usize> {
        let mut parts = self.parts.iter();
        parts.position(|part| part.vertices[0] == vertex)
    }

    /// Returns whether a corner of the sweep is on the tip.
    pub(crate) fn has_corner(&self, corner: u32) -> bool {
        self.parts.iter().any(|part| part.corners.contains(&corner))
    }

    /// Returns whether a part of the tip with edges has a vertex, at which both walls meet.
    pub(crate) fn is_joined(&self, vertex: VertexId) -> bool {
        let mut joined = self.parts.iter().filter(|part| part.is_joined());
        joined.any(|part| part.vertices.contains(&vertex))
    }
}

impl TipPart {
    /// Makes a part of one corner.
    pub(crate) fn of(corner: u32, vertex: VertexId) -> Self {
        Self {
            corners: vec![corner],
            vertices: vec![vertex],
            half_edges: Vec::new(),
        }
    }

    /// Adds a corner at the end, to which an edge of the surface runs.
    pub(crate) fn push(&mut self, half_edge: HalfEdge, corner: u32, vertex: VertexId) {
        self.half_edges.push(half_edge);
        self.corners.push(corner);
        self.vertices.push(vertex);
    }

    /// Returns whether the part has edges, at which the walls of a body meet.
    pub(crate) fn is_joined(&self) -> bool {
        !self.half_edges.is_empty()
    }

    /// Returns whether the part is closed.
    pub(crate) fn is_ring(&self) -> bool {
        self.half_edges.len() == self.vertices.len()
    }

    /// Returns the vertex at the end.
    pub(crate) fn last(&self) -> VertexId {
        self.vertices[self.vertices.len() - 1]
    }

    /// Iterates over the corners at the ends of each edge.
    pub(crate) fn edges(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let n = self.corners.len();
        let count = self.half_edges.len();
        (0..count).map(move |i| [self.corners[i], self.corners[(i + 1) % n]])
    }

    /// Returns the corners before and after the one at place `i`, if edges lead there.
    pub(crate) fn neighbors(&self, i: usize) -> [Option<u32>; 2] {
        let n = self.corners.len();
        let before = (i > 0 || self.is_ring()).then(|| self.corners[(i + n - 1) % n]);
        let after = (i < self.half_edges.len()).then(|| self.corners[(i + 1) % n]);
        [before, after]
    }

    /// Appends a part, joined by a half-edge, or at the common vertex if that is null.
    pub(crate) fn append(&mut self, half_edge: HalfEdge, other: &Self) {
        let is_same = half_edge.is_null();
        self.half_edges.extend((!is_same).then_some(half_edge));
        self.half_edges.extend_from_slice(&other.half_edges);
        self.corners
            .extend_from_slice(&other.corners[usize::from(is_same)..]);
        self.vertices
            .extend_from_slice(&other.vertices[usize::from(is_same)..]);
    }
}
