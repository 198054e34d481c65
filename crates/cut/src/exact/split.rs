//! Splits a hit triangle along the chords that cross it.

mod ears;
mod slit;

use super::contract::flatness;
use crate::error::CutError;
use crate::intersection::facets::Facets;
use crate::intersection::node::{Node, On};
use crate::intersection::trace::Chord;
use incise_mesh::geometry::area_vector;
use incise_mesh::{HalfEdge, TriangleId, Vec3, VertexId};
use robust::{Coord, orient2d};
use slit::join_slit;
use smallvec::SmallVec;

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

/// A hit triangle before the cut.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hit<'a> {
    pub(super) vertices: [VertexId; 3],
    pub(super) corners: [Vec3; 3],
    /// The neighbors' half-edges.
    pub(super) beyond: [HalfEdge; 3],
    /// The chords that cross it.
    pub(super) chords: &'a [Chord],
}

impl Hit<'_> {
    /// Returns the neighbor if all three edges have the same one, back to back with the triangle.
    fn only_neighbor(&self) -> Option<TriangleId> {
        let [a, b, c] = self.beyond.map(HalfEdge::triangle);
        (!self.beyond[0].is_null() && a == b && b == c).then_some(a)
    }
}

/// The parts of one hit triangle, with scratch memory.
#[derive(Debug, Clone, Default)]
pub(crate) struct Splitter {
    boundary: Vec<Mark>,
    polygon: Vec<PolygonEdge>,
    /// Polygons that slits inside the triangle wait to be joined to.
    polygons: Vec<Vec<PolygonEdge>>,
    /// Indices into the polygon that no ear has taken.
    ring: Vec<usize>,
    /// The polygon in the plane, moved inward by a little.
    inset: Vec<[f64; 2]>,
    /// New triangles by their corners in the polygon.
    ears: Vec<[usize; 3]>,
    pub(super) parts: Vec<Part>,
}

/// A corner of the hit triangle, a node on its boundary, or both.
#[derive(Debug, Clone, Copy)]
struct Mark {
    corner: Option<usize>,
    /// The node, its chord and whether the chord ends here.
    node: Option<u32>,
    chord: usize,
    ends: bool,
    /// The part of the boundary behind it.
    follows: EdgeRole,
    used: bool,
}

/// A corner of a polygon and the edge from there to the next one.
#[derive(Debug, Clone, Copy)]
struct PolygonEdge {
    corner: Corner,
    /// None for a bridge to a slit, which the polygon follows in both directions.
    role: Option<EdgeRole>,
}

impl Splitter {
    /// Splits a hit triangle along its chords.
    ///
    /// # Errors
    /// [`CutError::TipBlocked`] if a part would be inverted: its curves cross, since the sweep
    /// passes through itself there.
    pub(super) fn split(
        &mut self,
        hit: Hit<'_>,
        nodes: &[Node],
        facets: &Facets,
    ) -> Result<(), CutError> {
        self.mark(hit, nodes, facets);
        self.parts.clear();
        let slits = hit.chords.iter().filter(|c| !self.is_on_boundary(c));
        let slits: Vec<&Chord> = slits.collect();
        self.polygons.clear();
        for start in 0..self.boundary.len() {
            if !self.boundary[start].used {
                self.walk(start, hit.chords);
                if slits.is_empty() {
                    self.triangulate(nodes, hit);
                } else {
                    self.polygons.push(self.polygon.clone());
                }
            }
        }
        if !slits.is_empty() {
            let plane = Projection::new(&hit.corners);
            for slit in slits {
                join_slit(&mut self.polygons, slit, nodes, &hit.corners, plane);
            }
            for polygon in std::mem::take(&mut self.polygons) {
                self.polygon = polygon;
                self.triangulate(nodes, hit);
            }
        }
        self.check_parts(hit, nodes)
    }

    /// Checks that no part is inverted by more than rounding.
    ///
    /// Without nodes inside the triangle chords cannot cross.
    fn check_parts(&self, hit: Hit<'_>, nodes: &[Node]) -> Result<(), CutError> {
        let is_inner = |node: u32| matches!(nodes[node as usize].on, On::Face { .. });
        let mut all = hit.chords.iter().flat_map(Chord::nodes);
        if !all.any(is_inner) {
            return Ok(());
        }
        let normal = area_vector(hit.corners);
        let is_inverted = |part: &Part| {
            let corners = part
                .corners
                .map(|corner| position(corner, nodes, &hit.corners));
            let (own, is_flat) = flatness(corners);
            !is_flat && own.dot(&normal) < 0.0
        };
        match self.parts.iter().any(is_inverted) {
            true => Err(CutError::TipBlocked {
                triangle: hit.chords[0].triangle,
            }),
            false => Ok(()),
        }
    }

    /// Returns whether a chord has an end on the triangle's boundary.
    fn is_on_boundary(&self, chord: &Chord) -> bool {
        let ends = [chord.from, chord.to].map(Some);
        self.boundary.iter().any(|mark| ends.contains(&mark.node))
    }

    /// Puts the nodes on the boundary in order.
    fn mark(&mut self, hit: Hit<'_>, nodes: &[Node], facets: &Facets) {
        self.boundary.clear();
        let triangle = hit.chords[0].triangle;
        for (edge, h) in triangle.half_edges().into_iter().enumerate() {
            let follows = |part| EdgeRole::Outer { edge, part };
            let mut corner = Mark {
                corner: Some(edge),
                node: None,
                chord: 0,
                ends: false,
                follows: follows(0),
                used: false,
            };
            for (i, chord) in hit.chords.iter().enumerate() {
                for (node, ends) in [(chord.from, false), (chord.to, true)] {
                    if nodes[node as usize].on == On::Tip(hit.vertices[edge]) {
                        (corner.node, corner.chord, corner.ends) = (Some(node), i, ends);
                    }
                }
            }
            self.boundary.push(corner);
            let first = self.boundary.len();
            let is_on = |node: u32, expected: HalfEdge| match nodes[node as usize].on {
                On::Edge { exit, .. } => exit == expected,
                On::Face { .. } | On::Tip(_) => false,
            };
            // At the surface's boundary a chord begins at the triangle's own half-edge.
            let entry = if hit.beyond[edge].is_null() {
                h
            } else {
                hit.beyond[edge]
            };
            for (i, chord) in hit.chords.iter().enumerate() {
                for (node, expected, ends) in [(chord.from, entry, false), (chord.to, h, true)] {
                    if is_on(node, expected) {
                        self.boundary.push(Mark {
                            corner: None,
                            node: Some(node),
                            chord: i,
                            ends,
                            follows: follows(0),
                            used: false,
                        });
                    }
                }
            }
            let own = &mut self.boundary[first..];
            let ends = [hit.corners[edge], hit.corners[(edge + 1) % 3]];
            let facet = |mark: &Mark| mark.node.map_or(0, |node| nodes[node as usize].facet);
            own.sort_by(|a, b| facets.compare_on_mesh_edge(ends, facet(a), facet(b)));
            for (part, mark) in own.iter_mut().enumerate() {
                mark.follows = follows(part + 1);
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
                self.push(Corner::Old(corner), follows);
            }
            at = (at + 1) % count;
            let mark = self.boundary[at];
            if mark.node.is_some() {
                // A chord that ends here rises: the part before it is below the sweep.
                let chord = &chords[mark.chord];
                let partner = self.partner(mark.chord, mark.ends);
                self.along(chord, mark.ends);
                if let Some(corner) = mark.corner {
                    let first = self.polygon.len() + 1 - chord.nodes().count();
                    self.polygon[first].corner = Corner::Old(corner);
                }
                let last = if mark.ends { chord.from } else { chord.to };
                let (node, side) = if let Some(partner) = partner {
                    at = partner;
                    (last, usize::from(!mark.ends))
                } else {
                    // Around the end of the slit and back.
                    self.along(chord, !mark.ends);
                    let first = if mark.ends { chord.to } else { chord.from };
                    (first, usize::from(mark.ends))
                };
                if self.boundary[at].corner.is_some() {
                    if at == start {
                        break;
                    }
                    // The corner itself comes next.
                    continue;
                }
                let follows = self.boundary[at].follows;
                self.push(Corner::Node { node, side }, follows);
            }
            if at == start {
                break;
            }
        }
    }

    fn push(&mut self, corner: Corner, role: EdgeRole) {
        let role = Some(role);
        self.polygon.push(PolygonEdge { corner, role });
    }

    /// Appends the nodes of a chord but the last: below the sweep in reverse order, or above it.
    fn along(&mut self, chord: &Chord, is_below: bool) {
        let mut nodes: SmallVec<[u32; 8]> = chord.nodes().collect();
        if is_below {
            nodes.reverse();
        }
        let side = usize::from(!is_below);
        for pair in nodes.windows(2) {
            // The rim's edges are named by the node that comes first along the curve.
            let name = if is_below { pair[1] } else { pair[0] };
            let corner = Corner::Node {
                node: pair[0],
                side,
            };
            self.push(corner, EdgeRole::Rim { node: name, side });
        }
    }

    /// Returns the other end of a chord on the boundary; none if it ends inside the triangle.
    fn partner(&self, chord: usize, ends: bool) -> Option<usize> {
        let is_partner = |m: &Mark| m.node.is_some() && m.chord == chord && m.ends != ends;
        self.boundary.iter().position(is_partner)
    }
}

/// Returns the position of a corner \[m\].
fn position(corner: Corner, nodes: &[Node], corners: &[Vec3; 3]) -> Vec3 {
    match corner {
        Corner::Old(k) => corners[k],
        Corner::Node { node, .. } => nodes[node as usize].position,
    }
}

/// Returns a number with the exact sign of the turn from a over b to c, positive to the left.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let [a, b, c] = [a, b, c].map(|[x, y]| Coord { x, y });
    orient2d(a, b, c)
}

/// A projection along an axis that keeps the orientation of the hit triangle.
#[derive(Debug, Clone, Copy)]
struct Projection([usize; 2]);

impl Projection {
    fn new(corners: &[Vec3; 3]) -> Self {
        let normal = area_vector(*corners);
        let axis = normal.iamax();
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        Self(if normal[axis] > 0.0 { [u, v] } else { [v, u] })
    }

    fn project(self, p: Vec3) -> [f64; 2] {
        self.0.map(|k| p[k])
    }
}
