//! Parts of the tip that a sweep continues.

use crate::intersection::facets::{Facets, Weld};
use incise_mesh::{HalfEdge, VertexId, index_u32};

/// A part of the tip that the sweep continues: corners of the sweep joined by edges of the surface,
/// or a single one in a sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Tip {
    pub(super) first: u32,
    pub(super) last: u32,
}

impl Tip {
    /// Returns whether the tip has edges, at which the walls of a body meet.
    pub(super) fn is_joined(self) -> bool {
        self.first < self.last
    }

    /// Returns the first tip whose corners are `corner` or later.
    pub(super) fn from_corner(facets: &Facets, corner: u32) -> Option<Self> {
        let Weld {
            vertices,
            half_edges,
        } = facets.weld();
        let mut corners = vertices.iter().enumerate().skip(corner as usize);
        let first = corners.find(|(_, vertex)| !vertex.is_null())?.0;
        let joined = half_edges.iter().skip(first).take_while(|h| !h.is_null());
        let (first, last) = (index_u32(first), index_u32(first + joined.count()));
        Some(Self { first, last })
    }

    /// Returns the tip that begins at a vertex.
    pub(super) fn from_vertex(facets: &Facets, vertex: VertexId) -> Option<Self> {
        let corner = facets.weld().vertices.iter().position(|&v| v == vertex)?;
        let before = corner.checked_sub(1).map(|i| facets.weld().half_edges[i]);
        let is_first = before.is_none_or(HalfEdge::is_null);
        Self::from_corner(facets, index_u32(corner)).filter(|_| is_first)
    }
}
