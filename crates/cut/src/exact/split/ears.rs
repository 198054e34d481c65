//! Triangulation of the polygons into which chords divide a hit triangle.

use super::{Corner, EdgeRole, Hit, Part, PolygonEdge, Projection, Splitter, position, turn};
use crate::intersection::node::{Node, On};
use incise_mesh::geometry::{area_vector, corner_angles};
use incise_mesh::{Vec3, VertexId};
use std::cmp::Ordering;

impl Splitter {
    /// Cuts the polygon into triangles.
    pub(super) fn triangulate(&mut self, nodes: &[Node], hit: Hit<'_>) {
        let corners = &hit.corners;
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
                let first = is_joinable(polygon, &hit.vertices, nodes, 0, 2);
                let second = is_joinable(polygon, &hit.vertices, nodes, 1, 3);
                let is_first_better = || match hit.only_neighbor() {
                    Some(other) => {
                        // One triangle takes the diagonal at the first corner, the other the other
                        // one: else it would be an edge of four triangles.
                        let first = (0..4).min_by_key(|&i| order(polygon[i].corner, &hit));
                        (first.is_some_and(|i| i % 2 == 0)) == (hit.chords[0].triangle < other)
                    }
                    None => is_first_delaunay([0, 1, 2, 3].map(at)),
                };
                if first && (!second || is_first_better()) {
                    self.ears.extend([[0, 1, 2], [2, 3, 0]]);
                } else {
                    self.ears.extend([[1, 2, 3], [3, 0, 1]]);
                }
            }
            (other, _) => self.clip_ears(nodes, hit, other.is_some()),
        }
        self.number_parts();
    }

    /// Cuts ears off the polygon, the one with the largest angles first.
    ///
    /// With nodes inside the triangle a polygon is not convex, and ears must be empty.
    fn clip_ears(&mut self, nodes: &[Node], hit: Hit<'_>, has_inner: bool) {
        let corners = &hit.corners;
        let polygon = &self.polygon;
        let at = |i: usize| position(polygon[i].corner, nodes, corners);
        if has_inner {
            let plane = Projection::new(corners);
            let outline: Vec<_> = (0..polygon.len()).map(|i| plane.project(at(i))).collect();
            inset(&outline, &mut self.inset);
        }
        self.ring.clear();
        self.ring.extend(0..polygon.len());
        if has_inner && self.search_ears(nodes, hit) {
            return;
        }
        self.ears.clear();
        self.ring.clear();
        self.ring.extend(0..self.polygon.len());
        while self.ring.len() > 3 {
            let ring = &self.ring;
            let at = |i: usize| position(self.polygon[ring[i]].corner, nodes, &hit.corners);
            let rank = |i: usize| (self.ear_quality(nodes, hit, has_inner, i), at(i));
            let best = (0..ring.len()).max_by(|&i, &j| compare_ears(&rank(i), &rank(j)));
            let best = best.expect("a ring of more than three has a largest ear");
            self.ears.push(ear(&self.ring, best));
            self.ring.remove(best);
        }
        self.ears.push([self.ring[0], self.ring[1], self.ring[2]]);
    }

    /// Clips ears, the one with the largest smallest angle first, and backtracks at dead ends.
    ///
    /// Returns false if it finds no triangulation within [`MAX_EARS`] extra ears.
    fn search_ears(&mut self, nodes: &[Node], hit: Hit<'_>) -> bool {
        let choices = |own: &Self| {
            let at = |i: usize| position(own.polygon[own.ring[i]].corner, nodes, &hit.corners);
            let all = (0..own.ring.len()).filter(|_| own.ring.len() > 3);
            let all = all.map(|i| ((own.ear_quality(nodes, hit, true, i), at(i)), i));
            let mut valid: Vec<((f64, Vec3), usize)> =
                all.filter(|choice| choice.0.0 > -1.0).collect();
            valid.sort_by(|a, b| compare_ears(&a.0, &b.0));
            valid.drain(..valid.len().saturating_sub(MAX_CHOICES));
            valid
        };
        let mut left = vec![choices(self)];
        let mut removed: Vec<(usize, usize)> = Vec::new();
        let mut tries = self.ring.len() + MAX_EARS;
        while let Some(last) = left.last_mut() {
            if let [a, b, c] = self.ring[..]
                && turn(self.inset[a], self.inset[b], self.inset[c]) > 0.0
            {
                self.ears.push([a, b, c]);
                return true;
            }
            if let Some((_, i)) = last.pop() {
                tries -= 1;
                if tries == 0 {
                    return false;
                }
                self.ears.push(ear(&self.ring, i));
                removed.push((i, self.ring.remove(i)));
                left.push(choices(self));
            } else {
                left.pop();
                if let Some((i, corner)) = removed.pop() {
                    self.ring.insert(i, corner);
                    self.ears.pop();
                }
            }
        }
        false
    }

    /// Returns the smallest angle of the ear at place `i` of the ring, or a negative number.
    ///
    /// At most -1 if the ear is invalid, and -0.5 if it leaves a sliver.
    fn ear_quality(&self, nodes: &[Node], hit: Hit<'_>, has_inner: bool, i: usize) -> f64 {
        let (polygon, ring, inset) = (&self.polygon, &self.ring, &self.inset);
        let at = |i: usize| position(polygon[i].corner, nodes, &hit.corners);
        let [a, b, c] = ear(ring, i);
        if !is_joinable(polygon, &hit.vertices, nodes, a, c)
            || (has_inner && are_neighbors(polygon, &self.ears, nodes, [a, c]))
        {
            return -2.0;
        }
        if has_inner && !is_empty_ear(inset, [a, b, c], ring) {
            return -1.0;
        }
        if has_inner && ring.iter().any(|&i| is_beside(at(i), [at(a), at(c)])) {
            return -0.5;
        }
        // In one order, so that mirrored triangles are split alike.
        let angles = corner_angles(sorted([a, b, c].map(at)));
        angles.into_iter().fold(f64::MAX, f64::min)
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

/// Maximum number of candidates for each ear of [`Splitter::search_ears`].
const MAX_CHOICES: usize = 8;

/// Maximum number of extra ears that [`Splitter::search_ears`] clips while it backtracks.
///
/// A triangle with two slits has a dozen corners and needs a few. The bound keeps the time of a
/// split below a millisecond where there is no triangulation.
const MAX_EARS: usize = 1000;

/// Returns the ear at place `i` of a ring.
fn ear(ring: &[usize], i: usize) -> [usize; 3] {
    let n = ring.len();
    [ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]]
}

/// Returns a key of a corner that is the same in two triangles back to back.
fn order(corner: Corner, hit: &Hit<'_>) -> (bool, u32) {
    match corner {
        Corner::Old(k) => (false, hit.vertices[k].0),
        Corner::Node { node, .. } => (true, node),
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

/// Minimum distance of a corner from a diagonal [length of the diagonal].
///
/// Rounding may fold a thinner triangle.
const MIN_DISTANCE: f64 = 1e-3;

/// Returns whether a point lies beside a diagonal between its ends, where it leaves a sliver.
fn is_beside(p: Vec3, [a, b]: [Vec3; 2]) -> bool {
    let (edge, to_point) = (b - a, p - a);
    let along = edge.dot(&to_point) / edge.norm_squared();
    let distance = (to_point - edge * along).norm();
    0.0 < along && along < 1.0 && p != b && distance < MIN_DISTANCE * edge.norm()
}

/// Returns whether a diagonal cannot repeat an edge of the surface.
///
/// It must not join two corners or nodes of one edge of the hit triangle.
fn is_joinable(
    polygon: &[PolygonEdge],
    vertices: &[VertexId; 3],
    nodes: &[Node],
    a: usize,
    b: usize,
) -> bool {
    match (polygon[a].corner, polygon[b].corner) {
        (Corner::Old(_), Corner::Old(_)) => false,
        (Corner::Node { node: a, .. }, Corner::Node { node: b, .. }) => {
            match (nodes[a as usize].on, nodes[b as usize].on) {
                (On::Edge { ends: a, .. }, On::Edge { ends: b, .. }) => a != b,
                _ => a != b,
            }
        }
        (Corner::Old(k), Corner::Node { node, .. })
        | (Corner::Node { node, .. }, Corner::Old(k)) => match nodes[node as usize].on {
            On::Edge { ends, .. } => !ends.contains(&vertices[k]),
            _ => true,
        },
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

/// Compares two points by their coordinates.
fn compare(p: Vec3, q: Vec3) -> Ordering {
    let mut orders = (0..3).map(|k| p[k].total_cmp(&q[k]));
    orders
        .find(|order| order.is_ne())
        .unwrap_or(Ordering::Equal)
}

/// Compares two ears by quality and then by position, so that mirrored triangles are split alike.
fn compare_ears(a: &(f64, Vec3), b: &(f64, Vec3)) -> Ordering {
    a.0.total_cmp(&b.0).then_with(|| compare(a.1, b.1))
}

/// Returns points in the order of their coordinates.
fn sorted(mut points: [Vec3; 3]) -> [Vec3; 3] {
    points.sort_by(|&p, &q| compare(p, q));
    points
}

/// Returns whether the first of the two diagonals of a quadrilateral is Delaunay.
///
/// The answer for the mirror image, which begins at any corner, is the same diagonal.
fn is_first_delaunay(corners: [Vec3; 4]) -> bool {
    let least = (0..4).min_by(|&i, &j| compare(corners[i], corners[j]));
    let least = least.unwrap_or_default();
    let mut ordered = [0, 1, 2, 3].map(|k| corners[(least + k) % 4]);
    if compare(ordered[1], ordered[3]).is_gt() {
        ordered.swap(1, 3);
    }
    is_delaunay(ordered) == (least % 2 == 0)
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
