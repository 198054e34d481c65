//! Follows a curve from mesh triangle to mesh triangle and from facet to facet.

use super::segment::{End, Segment};
use super::{Chord, Curve, Trace};
use crate::error::CutError;
use crate::intersection::facets::{Facets, NO_FACET};
use crate::intersection::node::{Node, On};
use incise_mesh::{HalfEdge, Surface, TriangleId, VertexId, index_u32};

/// Maximum displacement of an end away from mesh edges [motion of the sweep, and distance of the
/// curve's ends unless on a wall].
const MAX_END_MARGIN: f64 = 0.1;

/// The first segment of a curve, or the tip along which it begins.
#[derive(Debug, Clone, Copy)]
pub(super) enum Start {
    Segment(usize),
    /// The number of a part of the tip.
    Tip(usize),
}

/// The place at which a chord leaves its mesh triangle.
#[derive(Debug, Clone, Copy)]
enum Exit {
    /// Across a half-edge, in a facet.
    Mesh(HalfEdge, u32),
    /// At the beginning of this part of the tip, which the curve follows.
    Tip(usize),
    /// At the tip along which the curve began.
    Closed,
    /// At the sweep's boundary.
    End,
}

impl Trace {
    /// Follows a curve to its end, or a closed one once around.
    pub(super) fn follow(
        &mut self,
        surface: &Surface,
        facets: &Facets,
        start: Start,
        is_closed: bool,
    ) -> Result<(), CutError> {
        let first = index_u32(self.nodes.len());
        let first_chord = self.chords.len();
        let mut at = match start {
            Start::Segment(at) => {
                self.add_first_node(surface, facets, at, is_closed);
                at
            }
            Start::Tip(tip) => match self.follow_tip(surface, facets, tip) {
                Some(at) => at,
                None if is_closed && !facets.tip().parts[tip].is_ring() => {
                    let vertex = facets.tip().parts[tip].last();
                    let triangle = surface.topology().outgoing(vertex).triangle();
                    return Err(CutError::TipBlocked { triangle });
                }
                None => {
                    self.finish_curve(facets, first, is_closed);
                    return Ok(());
                }
            },
        };
        loop {
            let triangle = self.segments[at].triangle;
            // The node through which the curve came in was made before, or closes it.
            let from = index_u32(self.nodes.len()).wrapping_sub(1);
            let inner = index_u32(self.nodes.len());
            let exit = self.cross_triangle(surface, facets, at, start, first)?;
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
            let next = match exit {
                Exit::End | Exit::Closed => None,
                Exit::Tip(tip) => self.follow_tip(surface, facets, tip),
                Exit::Mesh(exit, facet) => {
                    let first = match start {
                        Start::Segment(first) if is_closed => Some(first),
                        _ => None,
                    };
                    self.across(surface, exit, facet, first)?
                }
            };
            match next {
                Some(next) => at = next,
                None => {
                    let closes = match exit {
                        Exit::Closed => true,
                        Exit::Mesh(exit, _) => !surface.topology().twin(exit).is_null(),
                        Exit::Tip(_) | Exit::End => false,
                    };
                    if closes != is_closed {
                        return Err(CutError::TipBlocked { triangle });
                    }
                    break;
                }
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

    /// Appends the node at which a curve begins, unless it is also the last one of a closed curve.
    fn add_first_node(&mut self, surface: &Surface, facets: &Facets, at: usize, is_closed: bool) {
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
            End::Mesh(entry) if !is_closed => {
                let node = Node::on_edge(surface, facets, entry, facet, true);
                self.nodes.push(node);
            }
            End::Mesh(_) | End::Tip(_) => {}
        }
    }

    /// Follows a curve from segment `at` to where it leaves the mesh triangle, from facet to facet.
    ///
    /// The curve began at `start` with node `first`.
    fn cross_triangle(
        &mut self,
        surface: &Surface,
        facets: &Facets,
        mut at: usize,
        start: Start,
        first: u32,
    ) -> Result<Exit, CutError> {
        loop {
            let segment = &mut self.segments[at];
            segment.is_seen = true;
            let Segment {
                triangle,
                facet,
                to,
                ..
            } = *segment;
            let edge = match to {
                End::Tip(vertex) => {
                    let tip = facets.tip().part_from(vertex);
                    let tip = tip.ok_or(CutError::TipBlocked { triangle })?;
                    let is_start = matches!(start, Start::Tip(start) if start == tip);
                    // Around the body and back, or along another part of the tip.
                    let exit = if is_start {
                        Exit::Closed
                    } else {
                        Exit::Tip(tip)
                    };
                    return Ok(exit);
                }
                End::Mesh(exit) => {
                    let node = Node::on_edge(surface, facets, exit, facet, false);
                    self.nodes.push(node);
                    return Ok(Exit::Mesh(exit, facet));
                }
                End::Sweep(edge) => edge,
            };
            let beyond = facets.beyond_edge(facet, edge);
            let node = Node::in_face(surface, facets, triangle, edge, beyond);
            if beyond == NO_FACET {
                let begins = index_u32(self.nodes.len()) == first + 1;
                if begins
                    && let Some(from) = self.nodes.last()
                    && matches!(from.on, On::Face { .. })
                {
                    let middle = Node::between(surface, triangle, from, &node);
                    self.nodes.push(middle);
                }
                self.nodes.push(node);
                return Ok(Exit::End);
            }
            self.nodes.push(node);
            at = (self.segment(triangle, beyond))
                .filter(|&next| self.follows(next, End::Sweep(edge)))
                .ok_or(CutError::TipBlocked { triangle })?;
        }
    }

    /// Returns the segment beyond a mesh edge; none at the surface's boundary, or back at the first
    /// segment of a closed curve.
    fn across(
        &self,
        surface: &Surface,
        exit: HalfEdge,
        facet: u32,
        first: Option<usize>,
    ) -> Result<Option<usize>, CutError> {
        let entry = surface.topology().twin(exit);
        if entry.is_null() {
            return Ok(None);
        }
        let triangle = entry.triangle();
        let next = self.segment(triangle, facet);
        let next = next.ok_or_else(|| missing_candidate(surface, triangle))?;
        if Some(next) == first {
            return Ok(None);
        }
        if self.follows(next, End::Mesh(entry)) {
            Ok(Some(next))
        } else {
            Err(CutError::TipBlocked { triangle })
        }
    }

    /// Returns whether a segment begins at `from`, and no curve has run along it.
    ///
    /// Always without a tip. The vertices of a tip are not moved like the rest of the sweep, so
    /// beside them the signs may fit no curve.
    fn follows(&self, next: usize, from: End) -> bool {
        let next = &self.segments[next];
        !next.is_seen && next.from == from
    }

    /// Appends the nodes along a tip. Returns the segment with which the curve leaves it.
    fn follow_tip(&mut self, surface: &Surface, facets: &Facets, tip: usize) -> Option<usize> {
        let part = &facets.tip().parts[tip];
        let last = End::Tip(part.last());
        let next = self.segments.iter().position(|s| s.from == last);
        let next = next.filter(|_| !part.is_ring());
        // The facets on the inner side of each edge, and the one in which the curve goes on.
        let mut facet = facets.before(part.corners[0]);
        let mut edges = part.edges();
        for &vertex in &part.vertices {
            facet = match (edges.next(), next) {
                (Some(edge), _) => facets.left_of(edge).unwrap_or(facet),
                (None, Some(next)) => self.segments[next].facet,
                (None, None) => facet,
            };
            self.nodes
                .push(Node::at_tip(surface, facets, vertex, facet));
        }
        next
    }

    /// Returns the segment in a mesh triangle and a facet.
    pub(super) fn segment(&self, triangle: TriangleId, facet: u32) -> Option<usize> {
        let key = |s: &Segment| (s.triangle, s.facet);
        self.segments
            .binary_search_by_key(&(triangle, facet), key)
            .ok()
    }

    /// Moves the ends of the open curve of the last nodes away from mesh edges.
    fn center_ends(&mut self, surface: &Surface, facets: &Facets, first: usize) {
        let last = self.nodes.len() - 1;
        let span = (self.nodes[last].position - self.nodes[first].position).norm();
        for (end, beside, is_last) in [(first, first + 1, false), (last, last - 1, true)] {
            let before = self.nodes[beside];
            let facet = self.nodes[end.min(beside)].facet;
            // Coincident walls may have curves of different lengths, whose ends must coincide.
            let span = if self.nodes[end].is_between_cut_vertices(surface) {
                f64::INFINITY
            } else {
                span
            };
            let reach = MAX_END_MARGIN * facets.motion(facet).min(span);
            self.nodes[end].center_end(surface, facets, &before, facet, reach, is_last);
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
            On::Tip(vertex) => facets.tip().is_joined(vertex),
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
                    On::Tip(vertex) => facets.tip().is_joined(vertex),
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
