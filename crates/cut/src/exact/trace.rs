//! Where the sweep meets the surface: curves from triangle to triangle.
//!
//! A curve's nodes are where a mesh edge passes a sweep triangle and where a sweep edge pierces a mesh
//! triangle. A mesh triangle and a sweep triangle share two nodes or none, so nodes follow each other
//! without a choice. A curve closes, or it ends in a mesh triangle that the sweep's boundary pierces. One
//! behind which all lies exactly on the sweep, as where a body stands on the plane, only touches ([`super::touch`]).

use super::node::Node;
use super::signs::Signs;
use super::touch::Touch;
use super::unfold::Unfold;
use crate::error::CutError;
use incise_mesh::{HalfEdge, Surface, TriangleId, Vec3, VertexId};
use std::ops::Range;

/// Where a sweep triangle's part of a curve enters or leaves a mesh triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    /// Across the edge of this half-edge of the mesh triangle.
    Edge(HalfEdge),
    /// Onto the other sweep triangle.
    Crease,
    /// Nowhere: the sweep ends here.
    Boundary,
}

/// The part of a curve in one mesh triangle and one sweep triangle. It runs from `from` to `to` with
/// the body's inside on its left, seen against the sweep triangle's normal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Segment {
    from: End,
    to: End,
}

/// A mesh triangle that the sweep meets.
#[derive(Debug, Clone, Copy)]
struct Meeting {
    triangle: TriangleId,
    /// By sweep triangle.
    segments: [Option<Segment>; 2],
}

/// A part of a curve across one mesh triangle, from its edge to its edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Chord {
    pub(super) triangle: TriangleId,
    /// The node where it enters, across an edge that falls there.
    pub(super) from: u32,
    /// The node on the crease, if it changes from one sweep triangle to the other.
    pub(super) crease: Option<u32>,
    /// The node where it leaves, across an edge that rises there.
    pub(super) to: u32,
}

/// What the sweep meets. Kept by the cutter so that its memory serves the next cut.
#[derive(Debug, Clone, Default)]
pub(crate) struct Trace {
    meetings: Vec<Meeting>,
    /// By meeting, whether a curve has run along the segment.
    seen: Vec<[bool; 2]>,
    /// All nodes, those of a curve one after the other.
    pub(super) nodes: Vec<Node>,
    /// The nodes of each closed curve.
    pub(super) loops: Vec<Range<u32>>,
    /// Sorted by triangle; of two in a triangle, in the order in which curves were found.
    pub(super) chords: Vec<Chord>,
    /// A mesh triangle that the sweep's boundary pierces: the end of a curve that does not close.
    pub(super) open_end: Option<TriangleId>,
    touch: Touch,
}

impl Trace {
    /// How many mesh triangles the curves cross.
    pub(super) fn hits(&self) -> usize {
        let hits = self.chords.chunk_by(|a, b| a.triangle == b.triangle);
        hits.count()
    }

    /// The mean length of the edges around the nodes \[m\].
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 nodes")]
    pub(super) fn mean_local(&self) -> f64 {
        let sum: f64 = self.nodes.iter().map(|node| node.local).sum();
        sum / self.nodes.len() as f64
    }

    /// The area that the closed curves enclose, less that of holes \[m^2\], and their length \[m\].
    pub(super) fn section_size(&self, unfold: &Unfold) -> (f64, f64) {
        let (mut doubled, mut length) = (0.0, 0.0);
        for curve in &self.loops {
            let nodes = &self.nodes[curve.start as usize..curve.end as usize];
            let outline = || nodes.iter().map(|node| unfold.flatten(node));
            for ([ax, ay], [bx, by]) in outline().zip(outline().cycle().skip(1)) {
                doubled += ax * by - ay * bx;
                length += (bx - ax).hypot(by - ay);
            }
        }
        (f64::abs(doubled) / 2.0, length)
    }

    /// Finds all curves through `candidates`, which is sorted.
    ///
    /// # Errors
    /// [`CutError::VertexNotFinite`], [`CutError::OpenSurface`] where a curve leaves the surface, and
    /// [`CutError::StaleSearchTree`] where it leaves the candidates.
    pub(super) fn find(
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
        self.find_open_end();
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

    fn find_open_end(&mut self) {
        let ends = |segment: Option<Segment>| {
            segment.is_some_and(|s| s.from == End::Boundary || s.to == End::Boundary)
        };
        let open = self.meetings.iter();
        let mut open = open.filter(|m| m.segments.into_iter().any(ends));
        self.open_end = open.next().map(|m| m.triangle);
    }

    /// Runs once around a closed curve.
    fn follow(
        &mut self,
        surface: &Surface,
        signs: &Signs,
        start: usize,
        start_plane: usize,
    ) -> Result<(), CutError> {
        let topology = surface.topology();
        let first = id(self.nodes.len());
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
                // The node across the edge through which the curve came in was made before, or closes it.
                from: id(self.nodes.len()).wrapping_sub(1),
                crease: None,
                to: id(self.nodes.len()),
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
            at = found.map_err(|_| not_offered(surface, across))?;
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
        let last = id(self.nodes.len()) - 1;
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

/// The parts of curves in one mesh triangle, by sweep triangle.
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

/// Why the search tree did not offer a triangle that a curve enters: no box holds a point that is not
/// finite, and none is where it should be in a tree that was not told of motion.
fn not_offered(surface: &Surface, triangle: TriangleId) -> CutError {
    let mut corners = surface.topology().triangle(triangle).into_iter();
    let is_broken = |&v: &VertexId| !surface.position(v).iter().all(|x| x.is_finite());
    match corners.find(is_broken) {
        Some(vertex) => CutError::VertexNotFinite { vertex },
        None => CutError::StaleSearchTree { triangle },
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
    // On the outer side of one sweep edge as a whole: the common case of a triangle beyond the sweep.
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

fn id(i: usize) -> u32 {
    u32::try_from(i).expect("there are fewer nodes than edges and triangles")
}
