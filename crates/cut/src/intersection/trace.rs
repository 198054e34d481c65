//! Intersection curves of a sweep and a surface, followed from triangle to triangle.
//!
//! Nodes of a curve lie where a mesh edge crosses a sweep triangle and where a sweep edge pierces a
//! mesh triangle. A mesh triangle and a sweep triangle share two nodes or none, so the next node is
//! unique. A curve closes, or it ends in a mesh triangle that the sweep's boundary pierces. A curve
//! that cuts off nothing but vertices on the sweep is dropped, see [`super::touch`].

use super::node::Node;
use super::signs::Signs;
use super::touch::Touch;
use crate::error::CutError;
use incise_mesh::{HalfEdge, Surface, TriangleId, Vec3, VertexId, index_u32};
use std::ops::Range;

/// The place at which a segment of a curve enters or leaves a mesh triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    /// Across the edge of this half-edge of the mesh triangle.
    Edge(HalfEdge),
    /// Onto the other sweep triangle.
    Crease,
    /// Nowhere: the sweep ends here.
    Boundary,
}

/// The segment of a curve in one mesh triangle and one sweep triangle.
///
/// The inside of the body is on its left, seen against the sweep triangle's normal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Segment {
    from: End,
    to: End,
}

/// A mesh triangle that the sweep intersects.
#[derive(Debug, Clone, Copy)]
struct Meeting {
    triangle: TriangleId,
    /// By sweep triangle.
    segments: [Option<Segment>; 2],
}

/// The part of a curve across one mesh triangle, from edge to edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Chord {
    pub(crate) triangle: TriangleId,
    /// The node where it enters, across an edge that falls there.
    pub(crate) from: u32,
    /// The node on the crease, if it changes from one sweep triangle to the other.
    pub(crate) crease: Option<u32>,
    /// The node where it leaves, across an edge that rises there.
    pub(crate) to: u32,
}

/// The intersection curves of a cut. Kept between cuts for its memory.
#[derive(Debug, Clone, Default)]
pub(crate) struct Trace {
    meetings: Vec<Meeting>,
    /// By meeting, whether a curve has run along the segment.
    seen: Vec<[bool; 2]>,
    /// All nodes, those of a curve one after the other.
    pub(crate) nodes: Vec<Node>,
    /// The nodes of each closed curve.
    pub(crate) loops: Vec<Range<u32>>,
    /// Sorted by triangle; of two in a triangle, in the order in which curves were found.
    pub(crate) chords: Vec<Chord>,
    /// A mesh triangle that the sweep's boundary pierces: the end of a curve that does not close.
    pub(crate) open_end: Option<TriangleId>,
    touch: Touch,
}

impl Trace {
    /// Returns the number of mesh triangles that the curves cross.
    pub(crate) fn hits(&self) -> usize {
        let hits = self.chords.chunk_by(|a, b| a.triangle == b.triangle);
        hits.count()
    }

    /// Returns the mean edge length around the nodes \[m\].
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 nodes")]
    pub(crate) fn mean_local(&self) -> f64 {
        let sum: f64 = self.nodes.iter().map(|node| node.local).sum();
        sum / self.nodes.len() as f64
    }

    /// Finds all curves through `candidates`, which is sorted.
    ///
    /// # Errors
    /// [`CutError::VertexNotFinite`], [`CutError::OpenSurface`] where a curve leaves the surface,
    /// and [`CutError::StaleBvh`] where it leaves the candidates.
    pub(crate) fn find(
        &mut self,
        surface: &Surface,
        signs: &Signs,
        candidates: &mut Vec<TriangleId>,
    ) -> Result<(), CutError> {
        self.nodes.clear();
        self.loops.clear();
        self.chords.clear();
        self.open_end = None;
        candidates.sort_unstable();
        self.meetings.clear();
        for &triangle in &*candidates {
            let segments = meet(surface, signs, triangle)?;
            if segments != [None; 2] {
                self.meetings.push(Meeting { triangle, segments });
            }
        }
        self.seen.clear();
        self.seen.resize(self.meetings.len(), [false; 2]);
        let hit = self.meetings.iter().map(|meeting| meeting.triangle);
        self.touch.start(surface, signs, hit);
        self.find_open_end(surface, signs)?;
        if self.open_end.is_some() {
            return Ok(());
        }
        for start in 0..self.meetings.len() {
            for plane in 0..2 {
                if self.meetings[start].segments[plane].is_some() && !self.seen[start][plane] {
                    self.follow(surface, signs, start, plane)?;
                }
            }
        }
        // Stable, so that the order of a triangle's chords is that of the curves.
        self.chords.sort_by_key(|chord| chord.triangle);
        Ok(())
    }

    /// Finds a curve that ends on the sweep's boundary, and marks those that only touch as seen.
    fn find_open_end(&mut self, surface: &Surface, signs: &Signs) -> Result<(), CutError> {
        for start in 0..self.meetings.len() {
            for plane in 0..2 {
                let segment = self.meetings[start].segments[plane];
                if segment.is_some_and(|s| s.from == End::Boundary)
                    && !self.is_open_touch(surface, signs, start, plane)?
                {
                    self.open_end = Some(self.meetings[start].triangle);
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    /// Follows a curve from boundary to boundary; returns whether it only touches the surface.
    fn is_open_touch(
        &mut self,
        surface: &Surface,
        signs: &Signs,
        start: usize,
        start_plane: usize,
    ) -> Result<bool, CutError> {
        let (mut at, mut plane) = (start, start_plane);
        loop {
            let triangle = self.meetings[at].triangle;
            if !self.touch.is_touch_in(surface, signs, triangle) {
                return Ok(false);
            }
            match self.take(at, plane).to {
                End::Boundary => return Ok(true),
                End::Crease => plane = 1 - plane,
                End::Edge(exit) => {
                    let entry = surface.topology().twin(exit);
                    if entry.is_null() {
                        return Err(CutError::OpenSurface { triangle });
                    }
                    let across = entry.triangle();
                    let found = (self.meetings).binary_search_by_key(&across, |m| m.triangle);
                    at = found.map_err(|_| missing_candidate(surface, across))?;
                }
            }
        }
    }

    /// Follows a closed curve once around.
    fn follow(
        &mut self,
        surface: &Surface,
        signs: &Signs,
        start: usize,
        start_plane: usize,
    ) -> Result<(), CutError> {
        let topology = surface.topology();
        let first = index_u32(self.nodes.len());
        let first_chord = self.chords.len();
        // A curve that begins on the crease begins in the middle of a chord: go back to its edge.
        let (mut at, mut plane) = (start, start_plane);
        if self.segment(at, plane).from == End::Crease {
            plane = 1 - plane;
        }
        loop {
            let triangle = self.meetings[at].triangle;
            let mut segment = self.take(at, plane);
            let mut chord = Chord {
                triangle,
                // The node across the edge through which the curve came in was made before, or
                // closes it.
                from: index_u32(self.nodes.len()).wrapping_sub(1),
                crease: None,
                to: index_u32(self.nodes.len()),
            };
            if segment.to == End::Crease {
                chord.crease = Some(chord.to);
                chord.to += 1;
                self.nodes.push(Node::on_crease(surface, signs, triangle));
                plane = 1 - plane;
                segment = self.take(at, plane);
            }
            let End::Edge(exit) = segment.to else {
                unreachable!("a curve that ends was found before, and the crease is crossed once");
            };
            self.nodes.push(Node::on_edge(surface, signs, exit, plane));
            self.chords.push(chord);
            let entry = topology.twin(exit);
            if entry.is_null() {
                return Err(CutError::OpenSurface { triangle });
            }
            let across = entry.triangle();
            let found = self.meetings.binary_search_by_key(&across, |m| m.triangle);
            at = found.map_err(|_| missing_candidate(surface, across))?;
            if self.seen[at][plane] {
                break;
            }
        }
        let nodes = &self.nodes[first as usize..];
        if self.touch.is_touch(surface, signs, nodes) {
            self.nodes.truncate(first as usize);
            self.chords.truncate(first_chord);
            return Ok(());
        }
        let last = index_u32(self.nodes.len()) - 1;
        self.chords[first_chord].from = last;
        self.loops.push(first..last + 1);
        Ok(())
    }

    fn segment(&self, at: usize, plane: usize) -> Segment {
        self.meetings[at].segments[plane].expect("a curve goes on in the sweep triangle it is in")
    }

    fn take(&mut self, at: usize, plane: usize) -> Segment {
        self.seen[at][plane] = true;
        self.segment(at, plane)
    }
}

/// Returns the segments of curves in one mesh triangle, by sweep triangle.
fn meet(
    surface: &Surface,
    signs: &Signs,
    triangle: TriangleId,
) -> Result<[Option<Segment>; 2], CutError> {
    let vertices = surface.topology().triangle(triangle);
    let corners = vertices.map(|v| surface.position(v));
    for (v, p) in vertices.into_iter().zip(&corners) {
        if !p.iter().all(|x| x.is_finite()) {
            return Err(CutError::VertexNotFinite { vertex: v });
        }
    }
    Ok([0, 1].map(|i| meet_one(signs, i, triangle, &corners)))
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

fn meet_one(signs: &Signs, i: usize, triangle: TriangleId, corners: &[Vec3; 3]) -> Option<Segment> {
    if !signs.exists(i) {
        return None;
    }
    let above = corners.map(|p| signs.is_above(i, p));
    // Of the three edges one falls and one rises, unless all corners are on one side.
    let rises = (0..3).find(|&k| !above[k] && above[(k + 1) % 3])?;
    let falls = (0..3).find(|&k| above[k] && !above[(k + 1) % 3])?;
    let inside = |k: usize| {
        let (p, q) = (corners[k], corners[(k + 1) % 3]);
        signs.inside(i, p, q, above[(k + 1) % 3])
    };
    let (entry, exit) = (inside(falls), inside(rises));
    let mut out = [(entry, falls), (exit, rises)].map(|(inside, k)| {
        let h = triangle.half_edges()[k];
        (inside == [true; 3]).then_some(End::Edge(h))
    });
    if let [Some(from), Some(to)] = out {
        return Some(Segment { from, to });
    }
    // On the outer side of one sweep edge as a whole: the common case of a triangle beyond the
    // sweep.
    if (0..3).any(|side| !entry[side] && !exit[side]) {
        return None;
    }
    // Clipped by the sweep edges that it passes. Going in where the entry is beyond the sweep edge.
    for side in (0..3).filter(|&side| entry[side] != exit[side]) {
        if signs.pierces(i, side, *corners) {
            let is_crease = side == 0 && signs.has_crease();
            let end = if is_crease {
                End::Crease
            } else {
                End::Boundary
            };
            out[usize::from(entry[side])] = Some(end);
        }
    }
    match out {
        [Some(from), Some(to)] => Some(Segment { from, to }),
        _ => None,
    }
}
