//! Nodes of an intersection curve: positions and interpolation weights.

use super::facets::{Facets, NO_FACET};
use crate::sizing::{is_made, local_length};
use incise_mesh::geometry::area_vector;
use incise_mesh::{HalfEdge, Surface, TriangleId, Vec3, VertexId, VertexOrigin};
use smallvec::SmallVec;
use std::cmp::Ordering;

/// Distance of the end of a curve from the edges of its mesh triangle [length across the triangle].
const END_MARGIN: f64 = 0.05;

/// No sweep edge.
pub(crate) const NO_EDGE: u32 = u32::MAX;

/// The mesh element on which a node lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum On {
    /// The mesh edge of half-edge `exit`, through which the curve leaves a triangle or, where it
    /// begins at the surface's boundary, enters it, and a facet. The edge runs from `ends[0]` to
    /// `ends[1]`, the node is at `t` between them, and `ends[1]` is above the facet if `rises`.
    Edge {
        exit: HalfEdge,
        facet: u32,
        ends: [VertexId; 2],
        t: f32,
        rises: bool,
    },
    /// A mesh triangle, where a sweep edge pierces it, or [`NO_EDGE`] between two such points.
    Face {
        edge: u32,
        triangle: TriangleId,
        corners: [VertexId; 3],
        weights: [f32; 3],
    },
    /// A vertex of the tip that the sweep continues.
    Tip(VertexId),
}

/// A node of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Node {
    pub(crate) on: On,
    /// Position \[m\].
    pub(crate) position: Vec3,
    /// Local edge length around its mesh triangles \[m\], see [`local_length`].
    pub(crate) local: f64,
    /// The facet in which the curve goes on.
    pub(crate) facet: u32,
    /// Whether the curve begins or ends here, on the sweep's boundary.
    ///
    /// Both sides then share the vertex. Not where a curve ends at the surface's boundary.
    pub(crate) is_end: bool,
}

impl Node {
    /// Makes the node where the edge of `exit` crosses a facet.
    ///
    /// `begins` if the curve enters the surface there, at its boundary.
    pub(crate) fn on_edge(
        surface: &Surface,
        facets: &Facets,
        exit: HalfEdge,
        facet: u32,
        begins: bool,
    ) -> Self {
        let topology = surface.topology();
        let (from, to) = (topology.origin(exit), topology.target(exit));
        // From the smaller vertex, so that the edge's two triangles round alike, and two walls.
        let is_ordered = compare_vertices(surface, from, to).is_lt();
        let rises = is_ordered != begins;
        let ends = if is_ordered { [from, to] } else { [to, from] };
        let [p, q] = ends.map(|v| surface.position(v));
        let [hp, hq] = [p, q].map(|x| facets.height(facet, x));
        let at = |t: f32| p + (q - p) * f64::from(t);
        let mut t = round_part(hp / (hp - hq));
        if let Some((side, _)) = facets.beyond(facet, at(t)) {
            // An edge that lies nearly in the plane passes it anywhere, as far as rounding knows.
            // That it is on this side of the crease is exact: so it is there or next to it.
            let [yp, yq] = [p, q].map(|x| facets.outside(facet, side, x));
            let there = round_part(yp / (yp - yq));
            if facets.miss(facet, at(there)) < facets.miss(facet, at(t)) {
                t = there;
            }
        }
        let beside = [exit, topology.twin(exit)].into_iter();
        let beside = beside.filter(|h| !h.is_null()).map(HalfEdge::triangle);
        Self {
            on: On::Edge {
                exit,
                facet,
                ends,
                t,
                rises,
            },
            position: at(t),
            local: local_length(surface, facets.tip().rest_shape(), beside),
            facet,
            is_end: false,
        }
    }

    /// Makes the node where sweep edge `edge` pierces `triangle`; the curve goes on in `facet`.
    pub(crate) fn in_face(
        surface: &Surface,
        facets: &Facets,
        triangle: TriangleId,
        edge: u32,
        facet: u32,
    ) -> Self {
        let corners = ordered_corners(surface, triangle);
        let [a, b, c] = corners.map(|v| surface.position(v));
        let normal = area_vector([a, b, c]);
        let [start, end] = facets.ends(edge);
        let [from, to] = [start, end].map(|x| normal.dot(&(x - a)));
        let x = start + (end - start) * (from / (from - to));
        let mut weights = weights_of([a, b, c], x);
        let at = |weights: [f32; 3]| {
            let [u, v, w] = weights.map(f64::from);
            a * u + b * v + c * w
        };
        // Along an edge that lies nearly in the triangle's plane rounding does not know where it
        // pierces that; but it does so where it runs through the triangle.
        let mut off = facets.off_edge(edge, at(weights));
        if off > 0.0 {
            let sides = facets.edges()[edge as usize].facets;
            for side in sides.into_iter().filter(|&i| i != NO_FACET) {
                let k = facets.edges_of(side).iter().position(|&e| e == edge);
                let k = k.expect("a facet beside an edge has it");
                let [u, v, _] = middle([a, b, c].map(|p| facets.outside(side, k, p)));
                let there = round_parts([u, v]);
                let other = facets.off_edge(edge, at(there));
                if other < off {
                    (weights, off) = (there, other);
                }
            }
        }
        Self {
            on: On::Face {
                edge,
                triangle,
                corners,
                weights,
            },
            position: at(weights),
            local: local_length(surface, facets.tip().rest_shape(), [triangle].into_iter()),
            facet,
            is_end: !facets.edges()[edge as usize].is_crease(),
        }
    }

    /// Makes the node at a vertex of the tip that the sweep continues.
    ///
    /// The curve goes on in `facet`.
    pub(crate) fn at_tip(surface: &Surface, facets: &Facets, vertex: VertexId, facet: u32) -> Self {
        let fan: SmallVec<[HalfEdge; 8]> = surface.topology().outgoing_fan(vertex).collect();
        let fan = fan.iter().copied();
        Self {
            on: On::Tip(vertex),
            position: surface.position(vertex),
            local: local_length(
                surface,
                facets.tip().rest_shape(),
                fan.map(HalfEdge::triangle),
            ),
            facet,
            is_end: false,
        }
    }

    /// Moves the end of a curve along it, away from the edges of its mesh triangle.
    ///
    /// By at most `reach` \[m\]. `before` is the node beside it; `is_last` of the two ends. Next to
    /// an edge, rounding could fold the surface around the end, where the next step goes on.
    pub(crate) fn center_end(
        &mut self,
        surface: &Surface,
        facets: &Facets,
        before: &Self,
        facet: u32,
        reach: f64,
        is_last: bool,
    ) {
        let On::Face {
            triangle,
            corners,
            weights,
            ..
        } = &mut self.on
        else {
            return;
        };
        // In the order of the triangle, not of the corners.
        let points = surface.topology().triangle(*triangle);
        let points = points.map(|v| surface.position(v));
        let heights = points.map(|p| facets.height(facet, p));
        let from = before.position;
        // A curve leaves the triangle across the edge that rises there, and enters across the one
        // that falls.
        let crossed = [(0, 1), (1, 2), (2, 0)].into_iter().find(|&(k, l)| {
            let is_below = [k, l].map(|i| heights[i] < 0.0);
            is_below == [is_last, !is_last]
        });
        let Some((k, l)) = crossed else {
            return;
        };
        let part = heights[k] / (heights[k] - heights[l]);
        let to = points[k] + (points[l] - points[k]) * part;
        let across = (to - from).norm();
        let part = (self.position - from).norm() / across;
        let margin = (reach / across).min(END_MARGIN);
        if part.is_nan() || (margin..=1.0 - margin).contains(&part) {
            return;
        }
        let part = part.clamp(margin, 1.0 - margin);
        let points = corners.map(|v| surface.position(v));
        *weights = weights_of(points, from + (to - from) * part);
        let [u, v, w] = weights.map(f64::from);
        self.position = points[0] * u + points[1] * v + points[2] * w;
    }

    /// Returns whether it is in a triangle between vertices that cuts have made, as on walls.
    pub(crate) fn is_between_cut_vertices(&self, surface: &Surface) -> bool {
        match self.on {
            On::Face { corners, .. } => corners.iter().all(|&v| is_made(surface, v)),
            On::Edge { .. } | On::Tip(_) => false,
        }
    }

    /// Makes the node midway between two nodes in the inside of one mesh triangle.
    pub(crate) fn between(surface: &Surface, triangle: TriangleId, a: &Self, b: &Self) -> Self {
        let corners = ordered_corners(surface, triangle);
        let points = corners.map(|v| surface.position(v));
        let weights = weights_of(points, (a.position + b.position) / 2.0);
        let [u, v, w] = weights.map(f64::from);
        Self {
            on: On::Face {
                edge: NO_EDGE,
                triangle,
                corners,
                weights,
            },
            position: points[0] * u + points[1] * v + points[2] * w,
            is_end: false,
            ..*a
        }
    }

    /// Returns whether the node joins parts of its curve in different facets.
    pub(crate) fn is_between_facets(&self) -> bool {
        matches!(self.on, On::Tip(_)) || self.sweep_edge().is_some()
    }

    /// Returns the sweep edge that pierces the surface here, if one does.
    pub(crate) fn sweep_edge(&self) -> Option<u32> {
        match self.on {
            On::Face { edge, .. } if edge != NO_EDGE => Some(edge),
            _ => None,
        }
    }

    /// Returns a mesh triangle that the curve crosses or touches here.
    pub(crate) fn triangle(&self, surface: &Surface) -> TriangleId {
        match self.on {
            On::Edge { exit, .. } => exit.triangle(),
            On::Face { triangle, .. } => triangle,
            On::Tip(vertex) => surface.topology().outgoing(vertex).triangle(),
        }
    }

    /// Returns the origin of the node's vertices.
    pub(crate) fn origin(&self) -> VertexOrigin {
        match self.on {
            On::Edge {
                ends: [a, b], t, ..
            } => VertexOrigin::OnEdge { a, b, t },
            On::Face {
                corners, weights, ..
            } => VertexOrigin::InFace { corners, weights },
            On::Tip(vertex) => VertexOrigin::OnEdge {
                a: vertex,
                b: vertex,
                t: 0.0,
            },
        }
    }

    /// Returns the weights of the corners of a triangle on which it lies.
    pub(crate) fn weights_in(&self, corners: [VertexId; 3]) -> [f32; 3] {
        match self.on {
            On::Edge {
                ends: [a, b], t, ..
            } => corners.map(|v| {
                if v == a {
                    1.0 - t
                } else if v == b {
                    t
                } else {
                    0.0
                }
            }),
            On::Face {
                corners: own,
                weights,
                ..
            } => corners.map(|v| {
                let place = own.iter().position(|&corner| corner == v);
                place.map_or(0.0, |k| weights[k])
            }),
            On::Tip(vertex) => corners.map(|v| if v == vertex { 1.0 } else { 0.0 }),
        }
    }
}

/// Compares vertices, so that two coincident walls have the same order.
///
/// Vertices that cuts have made come last, ordered by position. Others are ordered by id.
fn compare_vertices(surface: &Surface, a: VertexId, b: VertexId) -> Ordering {
    let places = [a, b].map(|v| is_made(surface, v).then(|| surface.positions()[v.index()]));
    let order = match places {
        [Some(p), Some(q)] => {
            let mut orders = (0..3).map(|k| p[k].total_cmp(&q[k]));
            orders.find(|order| order.is_ne())
        }
        [p, q] => Some(p.is_some().cmp(&q.is_some())).filter(|order| order.is_ne()),
    };
    order.unwrap_or_else(|| a.cmp(&b))
}

/// Returns the corners of a triangle in their order, see [`compare_vertices`].
fn ordered_corners(surface: &Surface, triangle: TriangleId) -> [VertexId; 3] {
    let mut corners = surface.topology().triangle(triangle);
    corners.sort_unstable_by(|&a, &b| compare_vertices(surface, a, b));
    corners
}

/// Returns the barycentric weights of a point in a triangle's plane.
fn weights_of([a, b, c]: [Vec3; 3], x: Vec3) -> [f32; 3] {
    let normal = area_vector([a, b, c]);
    let part = |p: Vec3, q: Vec3| normal.dot(&area_vector([p, q, x])).max(0.0);
    let parts = [part(b, c), part(c, a)];
    let sum = parts[0] + parts[1] + part(a, b);
    if sum > 0.0 && sum.is_finite() {
        round_parts(parts.map(|part| part / sum))
    } else {
        [1.0 / 3.0; 3]
    }
}

/// Rounds a ratio to storage precision; returns a half if it is not finite.
#[expect(
    clippy::cast_possible_truncation,
    reason = "this is the one rounding of where a node lies"
)]
fn round_part(t: f64) -> f32 {
    if t.is_finite() {
        t.clamp(0.0, 1.0) as f32
    } else {
        0.5
    }
}

/// Rounds two of three weights to storage precision; the third is the remainder.
fn round_parts(parts: [f64; 2]) -> [f32; 3] {
    let [u, v] = parts.map(round_part);
    [u, v.min(1.0 - u), (1.0 - u - v).max(0.0)]
}

/// Returns the weights of the middle of the zero line of a linear function on a triangle, given by
/// its values at the corners; without a zero line, those of the corner with the smallest value.
fn middle(values: [f64; 3]) -> [f64; 3] {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for (k, l) in [(0, 1), (1, 2), (2, 0)] {
        let (p, q) = (values[k], values[l]);
        if (p < 0.0) != (q < 0.0) {
            let t = p / (p - q);
            sum[k] += 1.0 - t;
            sum[l] += t;
            count += 1.0;
        }
    }
    if count > 0.0 {
        return sum.map(|weight| weight / count);
    }
    let nearest = (0..3).min_by(|&k, &l| values[k].abs().total_cmp(&values[l].abs()));
    [0, 1, 2].map(|k| if Some(k) == nearest { 1.0 } else { 0.0 })
}
