//! Parts of the tip that a sweep continues.

use crate::intersection::facets::{ContinuedTip, Facets};
use incise_mesh::{VertexId, index_u32};

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

    /// Returns the vertex at a corner of the tip.
    pub(super) fn vertex(self, facets: &Facets, corner: u32) -> VertexId {
        let [ends, begins] = facets.vertices_at(corner);
        if corner == self.last && self.is_joined() {
            ends
        } else {
            begins
        }
    }

    /// Iterates over all parts of the tip.
    pub(super) fn all(facets: &Facets) -> impl Iterator<Item = Self> + '_ {
        let ContinuedTip {
            vertices,
            half_edges,
            ..
        } = facets.tip();
        let is_joined = |i: usize| half_edges.get(i).is_some_and(|h| !h.is_null());
        let passes = move |i: usize| {
            let [ends, begins] = vertices[i];
            ends == begins && i > 0 && is_joined(i - 1) && is_joined(i)
        };
        let begins = move |&i: &usize| {
            let [ends, begins] = vertices[i];
            let is_end = i > 0 && is_joined(i - 1) && ends == begins;
            !begins.is_null() && !is_end
        };
        (0..vertices.len()).filter(begins).map(move |first| {
            let mut last = first;
            while is_joined(last) && (last == first || passes(last)) {
                last += 1;
            }
            let (first, last) = (index_u32(first), index_u32(last));
            Self { first, last }
        })
    }

    /// Returns the part of the tip that begins at a vertex.
    pub(super) fn from_vertex(facets: &Facets, vertex: VertexId) -> Option<Self> {
        Self::all(facets).find(|tip| tip.vertex(facets, tip.first) == vertex)
    }
}
