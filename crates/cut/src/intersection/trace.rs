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

mod queries;
mod segment;
mod tip;

use super::facets::{Facets, NO_FACET};
use super::node::{Node, On};
use super::touch::Touch;
use crate::error::CutError;
use incise_mesh::{HalfEdge, Surface, TriangleId, VertexId, index_u32};
use segment::{End, Segment, meet};
use std::ops::Range;
use tip::Tip;

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
        let tips = facets.tip().half_edges.iter().filter(|h| !h.is_null());
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
        for tip in Tip::all(facets) {
            let vertex = tip.vertex(facets, tip.first);
            let is_reached = |node: &Node| node.on == On::Tip(vertex);
            if self.nodes.iter().any(is_reached) {
                continue;
            }
            let at_tip = End::Tip(vertex);
            if tip.is_joined() {
                let is_closed = self.segments.iter().any(|s| s.to == at_tip);
                self.follow(surface, facets, Start::Tip(tip), is_closed)?;
                continue;
            }
            let own = |s: &&Segment| s.from == at_tip || s.to == at_tip;
            let mut own = self.segments.iter().filter(own);
            match [own.next().copied(), own.next().copied()] {
                [Some(first), None] if first.from == at_tip => {
                    self.follow(surface, facets, Start::Tip(tip), false)?;
                }
                [_, None] => {}
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

    fn segment(&self, triangle: TriangleId, facet: u32) -> Option<usize> {
        let key = |s: &Segment| (s.triangle, s.facet);
        self.segments
            .binary_search_by_key(&(triangle, facet), key)
            .ok()
    }

    /// Appends the nodes along a tip. Returns the segment with which the curve leaves it.
    fn follow_tip(&mut self, surface: &Surface, facets: &Facets, tip: Tip) -> Option<usize> {
        let last = tip.vertex(facets, tip.last);
        let next = self.segments.iter().position(|s| s.from == End::Tip(last));
        for corner in tip.first..=tip.last {
            // The facet on the inner side of the edge to the next corner.
            let facet = match next {
                Some(next) if corner == tip.last => self.segments[next].facet,
                _ => 2 * corner.min(tip.last.saturating_sub(1)),
            };
            let vertex = tip.vertex(facets, corner);
            self.nodes.push(Node::at_tip(surface, vertex, facet));
        }
        next
    }

    /// Follows a curve to its end, or a closed one once around.
    fn follow(
        &mut self,
        surface: &Surface,
        facets: &Facets,
        start: Start,
        is_closed: bool,
    ) -> Result<(), CutError> {
        let first = index_u32(self.nodes.len());
        let first_chord = self.chords.len();
        let mut at = match start {
            Start::Segment(at) => at,
            Start::Tip(tip) => match self.follow_tip(surface, facets, tip) {
                Some(at) => at,
                None => {
                    self.finish_curve(facets, first, is_closed);
                    return Ok(());
                }
            },
        };
        let Segment {
            triangle,
            facet,
            from,
            ..
        } = self.segments[at];
        match from {
            End::Sweep(edge) => {
                let node = Node::in_face(surface, facets, triangle, edge, facet);
                self.nodes.push(node);
            }
            End::Mesh(entry) if !is_closed && matches!(start, Start::Segment(_)) => {
                let node = Node::on_edge(surface, facets, entry, facet, true);
                self.nodes.push(node);
            }
            End::Mesh(_) | End::Tip(_) => {}
        }
        loop {
            let triangle = self.segments[at].triangle;
            // The node through which the curve came in was made before, or closes it.
            let from = index_u32(self.nodes.len()).wrapping_sub(1);
            let inner = index_u32(self.nodes.len());
            let exit = loop {
                let segment = &mut self.segments[at];
                segment.is_seen = true;
                let facet = segment.facet;
                match segment.to {
                    End::Tip(vertex) => {
                        let tip = Tip::from_vertex(facets, vertex)
                            .ok_or(CutError::TipBlocked { triangle })?;
                        if let Start::Tip(start) = start
                            && start.first == tip.first
                        {
                            // Around the body and back.
                            break Exit::Closed;
                        }
                        break Exit::Tip(tip);
                    }
                    End::Mesh(exit) => {
                        let node = Node::on_edge(surface, facets, exit, facet, false);
                        self.nodes.push(node);
                        break Exit::Mesh(exit, facet);
                    }
                    End::Sweep(edge) => {
                        let beyond = facets.beyond_edge(facet, edge);
                        let node = Node::in_face(surface, facets, triangle, edge, beyond);
                        if beyond == NO_FACET {
                            let begins = index_u32(self.nodes.len()) == first + 1;
                            let from = self.nodes[first as usize];
                            if begins && matches!(from.on, On::Face { .. }) {
                                let middle = Node::between(surface, triangle, &from, &node);
                                self.nodes.push(middle);
                            }
                            self.nodes.push(node);
                            break Exit::End;
                        }
                        self.nodes.push(node);
                        at = (self.segment(triangle, beyond))
                            .ok_or(CutError::TipBlocked { triangle })?;
                    }
                }
            };
            let count = index_u32(self.nodes.len());
            // The first node of a tip is added after this chord.
            let (end, to) = match exit {
                Exit::Mesh(..) | Exit::End => (count - 1, count - 1),
                Exit::Tip(_) => (count, count),
                Exit::Closed => (count, first),
            };
            self.chords.push(Chord {
                triangle,
                from,
                inner: inner..end,
                to,
            });
            let (exit, facet) = match exit {
                Exit::End | Exit::Closed => break,
                Exit::Tip(tip) => match self.follow_tip(surface, facets, tip) {
                    Some(next) => {
                        at = next;
                        continue;
                    }
                    None => break,
                },
                Exit::Mesh(exit, facet) => (exit, facet),
            };
            let entry = surface.topology().twin(exit);
            if entry.is_null() {
                break;
            }
            let across = entry.triangle();
            at = (self.segment(across, facet)).ok_or_else(|| missing_candidate(surface, across))?;
            if self.segments[at].is_seen {
                break;
            }
        }
        if !is_closed {
            self.center_ends(surface, facets, first as usize);
        }
        if self.is_touch(surface, facets, first, first_chord, is_closed) {
            self.nodes.truncate(first as usize);
            self.chords.truncate(first_chord);
            return Ok(());
        }
        if is_closed && matches!(start, Start::Segment(_)) {
            self.chords[first_chord].from = index_u32(self.nodes.len()) - 1;
        }
        self.finish_curve(facets, first, is_closed);
        Ok(())
    }

    /// Moves the ends of the open curve of the last nodes away from mesh edges.
    fn center_ends(&mut self, surface: &Surface, facets: &Facets, first: usize) {
        let last = self.nodes.len() - 1;
        for (end, beside, is_last) in [(first, first + 1, false), (last, last - 1, true)] {
            let before = self.nodes[beside];
            let facet = self.nodes[end.min(beside)].facet;
            self.nodes[end].center_end(surface, facets, &before, facet, is_last);
        }
    }

    /// Returns whether the curve of the last nodes and chords only touches the surface.
    fn is_touch(
        &mut self,
        surface: &Surface,
        facets: &Facets,
        first: u32,
        first_chord: usize,
        is_closed: bool,
    ) -> bool {
        let nodes = &self.nodes[first as usize..];
        let is_joined = |node: &Node| match node.on {
            On::Tip(vertex) => Tip::from_vertex(facets, vertex).is_none_or(Tip::is_joined),
            _ => false,
        };
        if nodes.iter().any(is_joined) {
            return false;
        }
        let mut ends = [nodes.first(), nodes.last()].into_iter().flatten();
        if is_closed || ends.all(|node| !matches!(node.on, On::Face { .. })) {
            return self.touch.is_touch(surface, facets, nodes);
        }
        let chords = &self.chords[first_chord..];
        let touch = &mut self.touch;
        (chords.iter()).all(|chord| touch.is_touch_in(surface, facets, chord.triangle))
    }

    /// Adds the curve of all nodes from `first` on.
    fn finish_curve(&mut self, facets: &Facets, first: u32, is_closed: bool) {
        let end = index_u32(self.nodes.len());
        if !is_closed {
            for node in [first, end - 1] {
                let node = &mut self.nodes[node as usize];
                node.is_end = match node.on {
                    On::Edge { .. } => false,
                    On::Face { .. } => true,
                    On::Tip(vertex) => Tip::from_vertex(facets, vertex).is_none_or(Tip::is_joined),
                };
            }
        }
        self.curves.push(Curve {
            nodes: first..end,
            is_closed,
            is_capped: true,
        });
    }
}

/// The first segment of a curve, or the tip along which it begins.
#[derive(Debug, Clone, Copy)]
enum Start {
    Segment(usize),
    Tip(Tip),
}

/// The place at which a chord leaves its mesh triangle.
#[derive(Debug, Clone, Copy)]
enum Exit {
    /// Across a half-edge, in a facet.
    Mesh(HalfEdge, u32),
    /// At an end of a tip, which the curve follows.
    Tip(Tip),
    /// At the tip along which the curve began.
    Closed,
    /// At the sweep's boundary.
    End,
}

/// Returns why a triangle that a curve enters is no candidate.
///
/// It has a coordinate that is not finite, or its box is out of date.
fn missing_candidate(surface: &Surface, triangle: TriangleId) -> CutError {
    let mut corners = surface.topology().triangle(triangle).into_iter();
    let is_broken = |&v: &VertexId| !surface.position(v).iter().all(|x| x.is_finite());
    match corners.find(is_broken) {
        Some(vertex) => CutError::VertexNotFinite { vertex },
        None => CutError::StaleBvh,
    }
}
