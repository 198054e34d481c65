//! Intersection curves of a sweep and a surface, followed from triangle to triangle.
//!
//! Nodes of a curve lie where a mesh edge crosses a facet of the sweep and where a sweep edge
//! pierces a mesh triangle. A mesh triangle and a facet share two nodes or none, so the next node
//! is unique. A curve closes, or it ends in mesh triangles that the sweep's boundary pierces or at
//! the surface's boundary. One that cuts off nothing but vertices on the sweep is dropped, see
//! [`super::touch`].
//!
//! Where the sweep continues an incision, a curve that reaches one end of the tip follows the tip
//! to its other end and goes on from there. In a sheet the tip is one vertex, where a curve begins
//! or ends.

mod follow;
mod queries;
mod segment;

use super::facets::Facets;
use super::node::{Node, On};
use super::touch::Touch;
use crate::error::CutError;
use follow::Start;
use incise_mesh::{HalfEdge, Surface, TriangleId, VertexId};
pub(crate) use queries::Outside;
use segment::{End, Segment, meet};
use std::ops::Range;

/// The part of a curve across one mesh triangle: between edges, or from or to an end of the curve.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Chord {
    pub(crate) triangle: TriangleId,
    /// The node where it enters, across an edge that falls there, or the curve's first node.
    pub(crate) from: u32,
    /// The nodes inside the triangle, where it changes from one facet to another.
    pub(crate) inner: Range<u32>,
    /// The node where it leaves, across an edge that rises there, or the curve's last node.
    pub(crate) to: u32,
}

impl Chord {
    /// Iterates over its nodes, in order.
    pub(crate) fn nodes(&self) -> impl DoubleEndedIterator<Item = u32> + Clone + use<> {
        let inner = self.inner.clone();
        [self.from].into_iter().chain(inner).chain([self.to])
    }
}

/// An intersection curve.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Curve {
    pub(crate) nodes: Range<u32>,
    /// Whether the first node follows the last one. Else each end is on the sweep's boundary, on
    /// the surface's boundary, or at a tip.
    pub(crate) is_closed: bool,
    /// Whether the section that it bounds is closed by caps or walls.
    pub(crate) is_capped: bool,
}

/// The intersection curves of a cut. Kept between cuts for its memory.
#[derive(Debug, Clone, Default)]
pub(crate) struct Trace {
    /// Sorted by triangle, then by facet.
    segments: Vec<Segment>,
    /// All nodes, those of a curve one after the other.
    pub(crate) nodes: Vec<Node>,
    /// Open curves, then closed ones.
    pub(crate) curves: Vec<Curve>,
    /// Sorted by triangle; of two in a triangle, in the order in which curves were found.
    pub(crate) chords: Vec<Chord>,
    touch: Touch,
}

impl Trace {
    /// Finds all curves through `candidates`, which is sorted.
    ///
    /// # Errors
    /// [`CutError::VertexNotFinite`], [`CutError::StaleBvh`] where a curve leaves the candidates,
    /// and [`CutError::TipBlocked`] where the sweep meets the walls at the tip.
    pub(crate) fn find(
        &mut self,
        surface: &Surface,
        facets: &Facets,
        candidates: &mut Vec<TriangleId>,
    ) -> Result<(), CutError> {
        self.nodes.clear();
        self.curves.clear();
        self.chords.clear();
        candidates.sort_unstable();
        self.segments.clear();
        for &triangle in &*candidates {
            meet(surface, facets, triangle, &mut self.segments)?;
        }
        let hits = self.segments.chunk_by(|a, b| a.triangle == b.triangle);
        let hits = hits.map(|own| own[0].triangle);
        self.touch.start(surface, facets, hits);
        let is_start = |segment: &Segment| match segment.from {
            End::Mesh(entry) => surface.topology().twin(entry).is_null(),
            End::Tip(_) => false,
            End::Sweep(edge) => !facets.edges()[edge as usize].is_crease(),
        };
        for start in 0..self.segments.len() {
            if is_start(&self.segments[start]) {
                self.follow(surface, facets, Start::Segment(start), false)?;
            }
        }
        self.follow_tips(surface, facets)?;
        for start in 0..self.segments.len() {
            if !self.segments[start].is_seen {
                let start = self.first_of_chord(facets, start)?;
                self.follow(surface, facets, Start::Segment(start), true)?;
            }
        }
        // Stable, so that the order of a triangle's chords is that of the curves.
        self.chords.sort_by_key(|chord| chord.triangle);
        let tips = facets.tip().parts.iter().flat_map(|part| &part.half_edges);
        let walls = tips.flat_map(|&h| [h, surface.topology().twin(h)].map(HalfEdge::triangle));
        for triangle in walls {
            if self
                .chords
                .binary_search_by_key(&triangle, |c| c.triangle)
                .is_ok()
            {
                return Err(CutError::TipBlocked { triangle });
            }
        }
        Ok(())
    }

    /// Follows the curves that begin at the end of a tip.
    ///
    /// A curve that returns to the tip is closed. A curve that starts inside the body or at the tip
    /// of a sheet is open.
    fn follow_tips(&mut self, surface: &Surface, facets: &Facets) -> Result<(), CutError> {
        let parts = || facets.tip().parts.iter().enumerate();
        for (i, part) in parts().filter(|(_, part)| part.is_joined()) {
            let is_reached = self.is_reached(part.vertices[0]);
            if !is_reached && !part.is_ring() && !self.is_arrival(part.vertices[0]) {
                self.follow(surface, facets, Start::Tip(i), false)?;
            }
        }
        for (i, part) in parts() {
            let vertex = part.vertices[0];
            if self.is_reached(vertex) {
                continue;
            }
            if part.is_joined() {
                self.follow(surface, facets, Start::Tip(i), true)?;
                continue;
            }
            let at_tip = End::Tip(vertex);
            let own = |s: &&Segment| s.from == at_tip || s.to == at_tip;
            let mut own = self.segments.iter().filter(own);
            match [own.next().copied(), own.next().copied()] {
                [Some(first), None] if first.from == at_tip => {
                    self.follow(surface, facets, Start::Tip(i), false)?;
                }
                [Some(_), None] => {}
                // The sweep leaves the sheet beside the tip, so that a bridge would be left.
                [None, _] => {
                    let triangle = surface.topology().outgoing(vertex).triangle();
                    return Err(CutError::TipBlocked { triangle });
                }
                [_, Some(Segment { triangle, .. })] => {
                    return Err(CutError::TipBlocked { triangle });
                }
            }
        }
        let is_left =
            |s: &&Segment| !s.is_seen && [s.from, s.to].iter().any(|e| matches!(e, End::Tip(_)));
        match self.segments.iter().find(is_left) {
            Some(segment) => Err(CutError::TipBlocked {
                triangle: segment.triangle,
            }),
            None => Ok(()),
        }
    }

    /// Returns whether a curve has reached a vertex of the tip.
    fn is_reached(&self, vertex: VertexId) -> bool {
        self.nodes.iter().any(|node| node.on == On::Tip(vertex))
    }

    /// Returns whether a segment ends at a vertex of the tip.
    fn is_arrival(&self, vertex: VertexId) -> bool {
        self.segments.iter().any(|s| s.to == End::Tip(vertex))
    }

    /// Returns the segment with which the chord of a closed curve enters its mesh triangle.
    fn first_of_chord(&self, facets: &Facets, mut at: usize) -> Result<usize, CutError> {
        while let End::Sweep(edge) = self.segments[at].from {
            let Segment {
                triangle, facet, ..
            } = self.segments[at];
            at = (self.segment(triangle, facets.beyond_edge(facet, edge)))
                .ok_or(CutError::TipBlocked { triangle })?;
        }
        Ok(at)
    }
}
