//! Where a curve's nodes are.

use super::signs::Signs;
use incise_mesh::geometry::area_vector;
use incise_mesh::{HalfEdge, Origin, Surface, TriangleId, Vec3, VertexId};

/// What a node lies on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum On {
    /// The mesh edge of half-edge `exit`, through which the curve leaves a triangle, and sweep triangle
    /// `plane`. The edge runs from `ends[0]` to `ends[1]`, the node is at `t` between them, and
    /// `ends[1]` is above the sweep triangle if `rises`.
    Edge {
        exit: HalfEdge,
        plane: usize,
        ends: [VertexId; 2],
        t: f32,
        rises: bool,
    },
    /// A mesh triangle, where the crease pierces it.
    Face {
        corners: [VertexId; 3],
        weights: [f32; 3],
    },
}

/// A node of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Node {
    pub(super) on: On,
    /// Where it is \[m\].
    pub(super) position: Vec3,
    /// The mean length of the edges of the mesh triangles that it lies on \[m\].
    pub(super) local: f64,
}

impl Node {
    /// The node where the edge of `exit` passes sweep triangle `plane`.
    pub(super) fn on_edge(surface: &Surface, signs: &Signs, exit: HalfEdge, plane: usize) -> Self {
        let topology = surface.topology();
        let (from, to) = (topology.origin(exit), topology.target(exit));
        // From the smaller id, so that the edge's two triangles round alike.
        let ends = if from < to { [from, to] } else { [to, from] };
        let [p, q] = ends.map(|v| surface.position(v));
        let [hp, hq] = [p, q].map(|x| signs.height(plane, x));
        let t = round_part(hp / (hp - hq));
        Self {
            on: On::Edge {
                exit,
                plane,
                ends,
                t,
                rises: from < to,
            },
            position: p + (q - p) * f64::from(t),
            local: mean_edge(surface, [Some(exit), Some(topology.twin(exit))]),
        }
    }

    /// The node where the crease pierces `triangle`.
    pub(super) fn on_crease(surface: &Surface, signs: &Signs, triangle: TriangleId) -> Self {
        let corners = surface.topology().triangle(triangle);
        let [a, b, c] = corners.map(|v| surface.position(v));
        let normal = area_vector([a, b, c]);
        let [start, end] = signs.crease();
        let [from, to] = [start, end].map(|x| normal.dot(&(x - a)));
        let x = start + (end - start) * (from / (from - to));
        let part = |p: Vec3, q: Vec3| normal.dot(&area_vector([p, q, x])).max(0.0);
        let parts = [part(b, c), part(c, a)];
        let sum = parts[0] + parts[1] + part(a, b);
        let weights = if sum > 0.0 && sum.is_finite() {
            let [u, v] = parts.map(|part| round_part(part / sum));
            [u, v.min(1.0 - u), (1.0 - u - v).max(0.0)]
        } else {
            [1.0 / 3.0; 3]
        };
        let [u, v, w] = weights.map(f64::from);
        Self {
            on: On::Face { corners, weights },
            position: a * u + b * v + c * w,
            local: mean_edge(surface, [triangle.half_edges().first().copied(), None]),
        }
    }

    /// Where it came from, for who follows the cut.
    pub(super) fn origin(&self) -> Origin {
        match self.on {
            On::Edge {
                ends: [a, b], t, ..
            } => Origin::OnEdge { a, b, t },
            On::Face { corners, weights } => Origin::InFace { corners, weights },
        }
    }

    /// Weights of the corners of `triangle`, on which it lies.
    pub(super) fn weights_in(&self, corners: [VertexId; 3]) -> [f32; 3] {
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
            On::Face { weights, .. } => weights,
        }
    }
}

/// A part of a whole as storage keeps it; a half where there is no whole.
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

/// The mean length of the edges of these half-edges' triangles \[m\].
fn mean_edge(surface: &Surface, half_edges: [Option<HalfEdge>; 2]) -> f64 {
    let triangles = half_edges.into_iter().flatten().filter(|h| !h.is_null());
    let (sum, count) = triangles.fold((0.0, 0.0), |(sum, count), h| {
        let [a, b, c] = surface.triangle_positions(h.triangle());
        let perimeter = (b - a).norm() + (c - b).norm() + (a - c).norm();
        (sum + perimeter, count + 3.0)
    });
    sum / count
}
