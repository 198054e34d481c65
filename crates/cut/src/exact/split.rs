//! Splits a hit triangle along the chords that cross it.

use crate::intersection::node::{Node, On};
use crate::intersection::trace::Chord;
use incise_mesh::geometry::{area_vector, corner_angles};
use incise_mesh::{HalfEdge, Vec3};

/// A corner of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Corner {
    /// Corner 0, 1 or 2 of the hit triangle.
    Old(usize),
    /// A node, on this side: 0 below the sweep, 1 above it.
    Node { node: u32, side: usize },
}

/// The role of an edge of a new triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum EdgeRole {
    /// Part number `part` of edge `edge` of the hit triangle, counted along it.
    Outer { edge: usize, part: usize },
    /// The rim's edge that begins at `node`, on this side.
    Rim { node: u32, side: usize },
    /// Shared with edge `edge` of the part `other` of the same hit triangle.
    Inner { other: usize, edge: usize },
}

/// A new triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Part {
    pub(super) corners: [Corner; 3],
    /// Edge i runs from corner i to the next.
    pub(super) edges: [EdgeRole; 3],
}

/// The parts of one hit triangle, with scratch memory.
#[derive(Debug, Clone, Default)]
pub(crate) struct Splitter {
    boundary: Vec<Mark>,
    polygon: Vec<(Corner, EdgeRole)>,
    /// Indices into the polygon that no ear has taken.
    ring: Vec<usize>,
    /// New triangles by their corners in the polygon.
    ears: Vec<[usize; 3]>,
    pub(super) parts: Vec<Part>,
}

/// A corner of the hit triangle or a node on its boundary.
#[derive(Debug, Clone, Copy)]
struct Mark {
    corner: Option<usize>,
    /// For a node, the chord and whether the chord ends here.
    chord: usize,
    ends: bool,
    /// The part of the boundary behind it.
    follows: EdgeRole,
    used: bool,
}

impl Splitter {
    /// Splits a hit triangle along `chords`. `beyond` are the neighbors' half-edges, `is_valley` is
    /// as in [`crate::intersection::signs::Signs`].
    pub(super) fn split(
        &mut self,
        corners: [Vec3; 3],
        beyond: [HalfEdge; 3],
        nodes: &[Node],
        is_valley: bool,
        chords: &[Chord],
    ) {
        self.mark(beyond, nodes, is_valley, chords);
        self.parts.clear();
        for start in 0..self.boundary.len() {
            if !self.boundary[start].used {
                self.walk(start, chords);
                self.triangulate(nodes, &corners);
            }
        }
    }

    /// Puts the nodes on the boundary in order.
    fn mark(&mut self, beyond: [HalfEdge; 3], nodes: &[Node], is_valley: bool, chords: &[Chord]) {
        self.boundary.clear();
        for (edge, h) in chords[0].triangle.half_edges().into_iter().enumerate() {
            let mark = |corner, chord, ends, part| Mark {
                corner,
                chord,
                ends,
                follows: EdgeRole::Outer { edge, part },
                used: false,
            };
            self.boundary.push(mark(Some(edge), 0, false, 0));
            let on_edge = |node: u32, expected: HalfEdge| match nodes[node as usize].on {
                On::Edge { exit, plane, .. } => (exit == expected).then_some(plane),
                On::Face { .. } => None,
            };
            let mut found = [None; 2];
            for (i, chord) in chords.iter().enumerate() {
                if let Some(plane) = on_edge(chord.from, beyond[edge]) {
                    found[plane] = Some((i, false));
                }
                if let Some(plane) = on_edge(chord.to, h) {
                    found[plane] = Some((i, true));
                }
            }
            // The second sweep triangle is on one side of the first one's plane as a whole, so the
            // side to which the edge passes that plane tells which node comes first.
            if let [Some((_, rises)), Some(_)] = found
                && rises != is_valley
            {
                found.swap(0, 1);
            }
            for (part, (chord, ends)) in found.into_iter().flatten().enumerate() {
                self.boundary.push(mark(None, chord, ends, part + 1));
            }
        }
    }

    /// Collects the polygon on the left of the boundary from `start` on.
    fn walk(&mut self, start: usize, chords: &[Chord]) {
        let count = self.boundary.len();
        self.polygon.clear();
        let mut at = start;
        loop {
            let mark = &mut self.boundary[at];
            mark.used = true;
            let follows = mark.follows;
            if let Some(corner) = mark.corner {
                self.polygon.push((Corner::Old(corner), follows));
            }
            at = (at + 1) % count;
            let mark = self.boundary[at];
            if mark.corner.is_none() {
                // A chord that ends here rises: the part before it is below the sweep.
                let chord = chords[mark.chord];
                let side = usize::from(!mark.ends);
                let node = |node| Corner::Node { node, side };
                let rim = |node| EdgeRole::Rim { node, side };
                let (first, last) = if mark.ends {
                    (chord.to, chord.from)
                } else {
                    (chord.from, chord.to)
                };
                // The rim's edges are named by the node that comes first along the curve.
                let middle = chord.crease.unwrap_or(chord.from);
                let roles = if mark.ends {
                    [rim(middle), rim(chord.from)]
                } else {
                    [rim(chord.from), rim(middle)]
                };
                self.polygon.push((node(first), roles[0]));
                if let Some(crease) = chord.crease {
                    self.polygon.push((node(crease), roles[1]));
                }
                at = self.partner(mark.chord, mark.ends);
                let follows = self.boundary[at].follows;
                self.polygon.push((node(last), follows));
            }
            if at == start {
                break;
            }
        }
    }

    fn partner(&self, chord: usize, ends: bool) -> usize {
        let is_partner = |m: &Mark| m.corner.is_none() && m.chord == chord && m.ends != ends;
        (self.boundary.iter().position(is_partner)).expect("a chord has two ends on the boundary")
    }

    /// Cuts the polygon into triangles.
    fn triangulate(&mut self, nodes: &[Node], corners: &[Vec3; 3]) {
        let polygon = &self.polygon;
        let count = polygon.len();
        let at = |i: usize| match polygon[i].0 {
            Corner::Old(k) => corners[k],
            Corner::Node { node, .. } => nodes[node as usize].position,
        };
        self.ears.clear();
        let is_crease = |&(corner, _): &(Corner, EdgeRole)| match corner {
            Corner::Old(_) => false,
            Corner::Node { node, .. } => matches!(nodes[node as usize].on, On::Face { .. }),
        };
        if let Some(apex) = polygon.iter().position(is_crease) {
            // From the notch's tip the whole part is seen.
            let fan = (1..count - 1).map(|i| [apex, (apex + i) % count, (apex + i + 1) % count]);
            self.ears.extend(fan);
        } else if count == 4 {
            let first = is_joinable(polygon, nodes, 0, 2);
            let second = is_joinable(polygon, nodes, 1, 3);
            if first && (!second || is_delaunay([0, 1, 2, 3].map(at))) {
                self.ears.extend([[0, 1, 2], [2, 3, 0]]);
            } else {
                self.ears.extend([[1, 2, 3], [3, 0, 1]]);
            }
        } else {
            self.ring.clear();
            self.ring.extend(0..count);
            while self.ring.len() > 3 {
                let n = self.ring.len();
                let ear = |i: usize| {
                    [
                        self.ring[(i + n - 1) % n],
                        self.ring[i],
                        self.ring[(i + 1) % n],
                    ]
                };
                let quality = |i: usize| {
                    let [a, b, c] = ear(i);
                    let angle = corner_angles([a, b, c].map(at))
                        .into_iter()
                        .fold(f64::MAX, f64::min);
                    if is_joinable(polygon, nodes, a, c) {
                        angle
                    } else {
                        -1.0
                    }
                };
                let best = (0..n).max_by(|&i, &j| quality(i).total_cmp(&quality(j)));
                let best = best.expect("a ring of more than three has a largest ear");
                self.ears.push(ear(best));
                self.ring.remove(best);
            }
            self.ears.push([self.ring[0], self.ring[1], self.ring[2]]);
        }
        let first = self.parts.len();
        for (i, ear) in self.ears.iter().enumerate() {
            let role = |k: usize| {
                let (a, b) = (ear[k], ear[(k + 1) % 3]);
                if b == (a + 1) % count {
                    return polygon[a].1;
                }
                let shares =
                    |other: &[usize; 3]| (0..3).find(|&k| other[k] == b && other[(k + 1) % 3] == a);
                let others = self.ears.iter().enumerate().filter(|&(j, _)| j != i);
                let (other, edge) = others
                    .into_iter()
                    .find_map(|(j, other)| Some((first + j, shares(other)?)))
                    .expect("a diagonal has two triangles");
                EdgeRole::Inner { other, edge }
            };
            self.parts.push(Part {
                corners: ear.map(|i| polygon[i].0),
                edges: [0, 1, 2].map(role),
            });
        }
    }
}

/// Returns whether a diagonal cannot repeat an edge of the surface.
///
/// It must join neither two old corners nor two nodes of one mesh edge.
fn is_joinable(polygon: &[(Corner, EdgeRole)], nodes: &[Node], a: usize, b: usize) -> bool {
    match (polygon[a].0, polygon[b].0) {
        (Corner::Old(_), Corner::Old(_)) => false,
        (Corner::Node { node: a, .. }, Corner::Node { node: b, .. }) => {
            match (nodes[a as usize].on, nodes[b as usize].on) {
                (On::Edge { ends: a, .. }, On::Edge { ends: b, .. }) => a != b,
                _ => true,
            }
        }
        _ => true,
    }
}

/// Returns whether the diagonal from `a` to `c` is Delaunay: the angles at `b` and `d` sum to at
/// most 180 degrees.
fn is_delaunay([a, b, c, d]: [Vec3; 4]) -> bool {
    let at = |p: Vec3, q: Vec3, r: Vec3| {
        let (u, w) = (p - q, r - q);
        (u.dot(&w), u.cross(&w).norm())
    };
    let ((cos_b, sin_b), (cos_d, sin_d)) = (at(a, b, c), at(c, d, a));
    let flat = |t: [Vec3; 3]| area_vector(t).norm() == 0.0;
    // A diagonal along the boundary makes a triangle without area.
    if flat([a, b, c]) || flat([c, d, a]) {
        return false;
    }
    if flat([b, c, d]) || flat([d, a, b]) {
        return true;
    }
    sin_b * cos_d + cos_b * sin_d >= 0.0
}
