//! Splits a hit triangle along the chords that cross it.

use crate::intersection::facets::Facets;
use crate::intersection::node::{Node, On};
use crate::intersection::trace::Chord;
use incise_mesh::geometry::{area_vector, corner_angles};
use incise_mesh::{HalfEdge, Vec3, VertexId};
use robust::{Coord, orient2d};

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
    pub(super) fn split(&mut self, hit: Hit<'_>, nodes: &[Node], facets: &Facets) {
        self.mark(hit, nodes, facets);
        self.parts.clear();
        let slits = hit.chords.iter().filter(|c| !self.is_on_boundary(c));
        let slits: Vec<&Chord> = slits.collect();
        self.polygons.clear();
        for start in 0..self.boundary.len() {
            if !self.boundary[start].used {
                self.walk(start, hit.chords);
                if slits.is_empty() {
                    self.triangulate(nodes, &hit.corners);
                } else {
                    self.polygons.push(self.polygon.clone());
                }
            }
        }
        if slits.is_empty() {
            return;
        }
        let plane = Projection::new(&hit.corners);
        for slit in slits {
            join_slit(&mut self.polygons, slit, nodes, &hit.corners, plane);
        }
        for polygon in std::mem::take(&mut self.polygons) {
            self.polygon = polygon;
            self.triangulate(nodes, &hit.corners);
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
            for (i, chord) in hit.chords.iter().enumerate() {
                for (node, expected, ends) in
                    [(chord.from, hit.beyond[edge], false), (chord.to, h, true)]
                {
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
        let mut nodes: Vec<u32> = chord.nodes().collect();
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

    /// Cuts the polygon into triangles.
    fn triangulate(&mut self, nodes: &[Node], corners: &[Vec3; 3]) {
        let polygon = &self.polygon;
        let count = polygon.len();
        let at = |i: usize| position(polygon[i].corner, nodes, corners);
        self.ears.clear();
        let is_inner = |edge: &PolygonEdge| match edge.corner {
            Corner::Old(_) => false,
            Corner::Node { node, .. } => matches!(nodes[node as usize].on, On::Face { .. }),
        };
        let mut inner = (0..count).filter(|&i| is_inner(&polygon[i]));
        match (inner.next(), inner.next()) {
            (Some(apex), None) => {
                // From the notch's tip the whole part is seen.
                let fan = 1..count - 1;
                let fan = fan.map(|i| [apex, (apex + i) % count, (apex + i + 1) % count]);
                self.ears.extend(fan);
            }
            (None, _) if count == 4 => {
                let first = is_joinable(polygon, nodes, 0, 2);
                let second = is_joinable(polygon, nodes, 1, 3);
                if first && (!second || is_delaunay([0, 1, 2, 3].map(at))) {
                    self.ears.extend([[0, 1, 2], [2, 3, 0]]);
                } else {
                    self.ears.extend([[1, 2, 3], [3, 0, 1]]);
                }
            }
            (other, _) => self.clip_ears(nodes, corners, other.is_some()),
        }
        self.number_parts();
    }

    /// Cuts ears off the polygon, the one with the largest angles first.
    ///
    /// With nodes inside the triangle a polygon is not convex, and ears must be empty.
    fn clip_ears(&mut self, nodes: &[Node], corners: &[Vec3; 3], has_inner: bool) {
        let polygon = &self.polygon;
        let at = |i: usize| position(polygon[i].corner, nodes, corners);
        if has_inner {
            let plane = Projection::new(corners);
            let outline: Vec<_> = (0..polygon.len()).map(|i| plane.project(at(i))).collect();
            inset(&outline, &mut self.inset);
        }
        let inset = &self.inset;
        self.ring.clear();
        self.ring.extend(0..polygon.len());
        while self.ring.len() > 3 {
            let ring = &self.ring;
            let n = ring.len();
            let ear = |i: usize| [ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]];
            let quality = |i: usize| {
                let [a, b, c] = ear(i);
                if !is_joinable(polygon, nodes, a, c)
                    || (has_inner && are_neighbors(polygon, &self.ears, nodes, [a, c]))
                {
                    return -2.0;
                }
                let points = [a, b, c].map(at);
                if has_inner && !is_empty_ear(inset, [a, b, c], ring) {
                    return -1.0;
                }
                let angles = corner_angles(points);
                angles.into_iter().fold(f64::MAX, f64::min)
            };
            let best = (0..n).max_by(|&i, &j| quality(i).total_cmp(&quality(j)));
            let best = best.expect("a ring of more than three has a largest ear");
            self.ears.push(ear(best));
            self.ring.remove(best);
        }
        self.ears.push([self.ring[0], self.ring[1], self.ring[2]]);
    }

    /// Makes the ears parts, with the roles of their edges.
    fn number_parts(&mut self) {
        let (polygon, ears) = (&self.polygon, &self.ears);
        let count = polygon.len();
        let first = self.parts.len();
        let find = |a: usize, b: usize, own: usize| {
            let shares =
                |other: &[usize; 3]| (0..3).find(|&k| other[k] == a && other[(k + 1) % 3] == b);
            let others = ears.iter().enumerate().filter(|&(j, _)| j != own);
            let found = others
                .into_iter()
                .find_map(|(j, other)| Some((first + j, shares(other)?)));
            let (other, edge) = found.expect("an inner edge has two triangles");
            EdgeRole::Inner { other, edge }
        };
        for (i, ear) in ears.iter().enumerate() {
            let role = |k: usize| {
                let (a, b) = (ear[k], ear[(k + 1) % 3]);
                if b != (a + 1) % count {
                    return find(b, a, i);
                }
                polygon[a].role.unwrap_or_else(|| {
                    let back = (0..count).find(|&j| {
                        let next = polygon[(j + 1) % count].corner;
                        j != a
                            && polygon[j].role.is_none()
                            && polygon[j].corner == polygon[b].corner
                            && next == polygon[a].corner
                    });
                    let back = back.expect("a bridge is followed in both directions");
                    find(back, (back + 1) % count, i)
                })
            };
            self.parts.push(Part {
                corners: ear.map(|i| polygon[i].corner),
                edges: [0, 1, 2].map(role),
            });
        }
    }
}

/// Returns the position of a corner \[m\].
fn position(corner: Corner, nodes: &[Node], corners: &[Vec3; 3]) -> Vec3 {
    match corner {
        Corner::Old(k) => corners[k],
        Corner::Node { node, .. } => nodes[node as usize].position,
    }
}

/// Joins a slit that lies inside the triangle to the polygon around it, by a bridge.
fn join_slit(
    polygons: &mut [Vec<PolygonEdge>],
    slit: &Chord,
    nodes: &[Node],
    corners: &[Vec3; 3],
    plane: Projection,
) {
    let point = |edge: &PolygonEdge| plane.project(position(edge.corner, nodes, corners));
    let ends = [slit.from, slit.to].map(|n| nodes[n as usize].position);
    let start = plane.project(ends[0]);
    // The shortest bridge that meets nothing else; rounding may leave none.
    let mut best = (false, f64::INFINITY, 0, 0);
    for (p, polygon) in polygons.iter().enumerate() {
        let outline = || polygon.iter().map(&point);
        let sides = || outline().zip(outline().cycle().skip(1));
        let is_around = sides()
            .filter(|&(a, b)| is_crossed_upward(a, b, start))
            .count()
            % 2
            == 1;
        for (i, from) in outline().enumerate() {
            let is_free = is_around && !sides().any(|(a, b)| do_cross([from, start], [a, b]));
            let length = (start[0] - from[0]).hypot(start[1] - from[1]);
            if (!is_free, length) < (!best.0, best.1) {
                best = (is_free, length, p, i);
            }
        }
    }
    let (_, _, p, i) = best;
    let polygon = &mut polygons[p];
    let own: Vec<u32> = slit.nodes().collect();
    let mut detour = vec![PolygonEdge {
        corner: polygon[i].corner,
        role: None,
    }];
    let mut add = |node: u32, side: usize, role| {
        let corner = Corner::Node { node, side };
        detour.push(PolygonEdge { corner, role });
    };
    for pair in own.windows(2) {
        let side = 1;
        add(
            pair[0],
            side,
            Some(EdgeRole::Rim {
                node: pair[0],
                side,
            }),
        );
    }
    for pair in own.windows(2).rev() {
        let side = 0;
        add(
            pair[1],
            side,
            Some(EdgeRole::Rim {
                node: pair[0],
                side,
            }),
        );
    }
    // Both sides share the vertices of the ends.
    let side = 1;
    add(own[0], side, None);
    polygon.splice(i..i, detour);
}

/// Returns whether the ray from `p` to the right crosses an edge.
fn is_crossed_upward(a: [f64; 2], b: [f64; 2], p: [f64; 2]) -> bool {
    (a[1] > p[1]) != (b[1] > p[1]) && (turn(a, b, p) > 0.0) == (b[1] > a[1])
}

/// Returns whether two segments cross in a point inside both.
fn do_cross([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> bool {
    turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0
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

/// Moves the corners of an outline inward by a little, so that a slit opens.
fn inset(outline: &[[f64; 2]], out: &mut Vec<[f64; 2]>) {
    let n = outline.len();
    let between = |a: [f64; 2], b: [f64; 2]| [b[0] - a[0], b[1] - a[1]];
    let pairs = (0..n).flat_map(|i| (0..i).map(move |j| (i, j)));
    let distances = pairs.map(|(i, j)| {
        let [x, y] = between(outline[i], outline[j]);
        x.hypot(y)
    });
    let least = distances.filter(|&d| d > 0.0).fold(f64::INFINITY, f64::min);
    let left = |a: [f64; 2], b: [f64; 2]| {
        let [x, y] = between(a, b);
        let length = x.hypot(y);
        if length > 0.0 {
            [-y / length, x / length]
        } else {
            [0.0; 2]
        }
    };
    out.clear();
    out.extend((0..n).map(|i| {
        let (before, at, after) = (outline[(i + n - 1) % n], outline[i], outline[(i + 1) % n]);
        let (u, v) = (left(before, at), left(at, after));
        [0, 1].map(|k| at[k] + INSET * least * (u[k] + v[k]))
    }));
}

/// Displacement of corners by [`inset`] [of the smallest distance between two].
const INSET: f64 = 1e-4;

/// Returns whether an ear of a ring of points has an area and no other point inside or on it.
fn is_empty_ear(points: &[[f64; 2]], ear: [usize; 3], ring: &[usize]) -> bool {
    let [a, b, c] = ear.map(|i| points[i]);
    let mut others = ring.iter().filter(|i| !ear.contains(i)).map(|&i| points[i]);
    turn(a, b, c) > 0.0
        && !others.any(|p| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0)
}

/// Returns whether a diagonal cannot repeat an edge of the surface.
///
/// It must join neither two old corners nor two nodes of one mesh edge.
fn is_joinable(polygon: &[PolygonEdge], nodes: &[Node], a: usize, b: usize) -> bool {
    match (polygon[a].corner, polygon[b].corner) {
        (Corner::Old(_), Corner::Old(_)) => false,
        (Corner::Node { node: a, .. }, Corner::Node { node: b, .. }) => {
            match (nodes[a as usize].on, nodes[b as usize].on) {
                (On::Edge { ends: a, .. }, On::Edge { ends: b, .. }) => a != b,
                _ => a != b,
            }
        }
        _ => true,
    }
}

/// Returns whether the polygon or one of its ears has an edge between the vertices of two corners.
///
/// The polygon may pass a vertex twice.
fn are_neighbors(
    polygon: &[PolygonEdge],
    ears: &[[usize; 3]],
    nodes: &[Node],
    corners: [usize; 2],
) -> bool {
    let vertex = |i: usize| match polygon[i].corner {
        Corner::Node { node, .. } if nodes[node as usize].is_end => Corner::Node { node, side: 0 },
        corner => corner,
    };
    let ends = corners.map(vertex);
    let is_same = |a: usize, b: usize| {
        let edge = [vertex(a), vertex(b)];
        edge == ends || edge == [ends[1], ends[0]]
    };
    let count = polygon.len();
    ends[0] == ends[1]
        || (0..count).any(|i| is_same(i, (i + 1) % count))
        || ears
            .iter()
            .any(|ear| (0..3).any(|k| is_same(ear[k], ear[(k + 1) % 3])))
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
