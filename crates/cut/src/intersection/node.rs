//! Nodes of an intersection curve: positions and interpolation weights.

use super::signs::Signs;
use incise_mesh::geometry::area_vector;
use incise_mesh::{HalfEdge, Surface, TriangleId, Vec3, VertexId, VertexOrigin};

/// The mesh element on which a node lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum On {
    /// The mesh edge of half-edge `exit`, through which the curve leaves a triangle, and sweep
    /// triangle `plane`. The edge runs from `ends[0]` to `ends[1]`, the node is at `t` between
    /// them, and `ends[1]` is above the sweep triangle if `rises`.
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
pub(crate) struct Node {
    pub(crate) on: On,
    /// Position \[m\].
    pub(crate) position: Vec3,
    /// Local edge length: the mean over the edges of its mesh triangles \[m\].
    pub(crate) local: f64,
}

impl Node {
    /// Makes the node where the edge of `exit` crosses sweep triangle `plane`.
    pub(crate) fn on_edge(surface: &Surface, signs: &Signs, exit: HalfEdge, plane: usize) -> Self {
        let topology = surface.topology();
        let (from, to) = (topology.origin(exit), topology.target(exit));
        // From the smaller id, so that the edge's two triangles round alike.
        let ends = if from < to { [from, to] } else { [to, from] };
        let [p, q] = ends.map(|v| surface.position(v));
        let [hp, hq] = [p, q].map(|x| signs.height(plane, x));
        let at = |t: f32| p + (q - p) * f64::from(t);
        let mut t = round_part(hp / (hp - hq));
        if signs.beyond(plane, at(t)) > 0.0 {
            // An edge that lies nearly in the plane passes it anywhere, as far as rounding knows.
            // That it is on this side of the crease is exact: so it is there or next to it.
            let [yp, yq] = [p, q].map(|x| signs.across(plane, x));
            let there = round_part(yp / (yp - yq));
            if signs.miss(plane, at(there)) < signs.miss(plane, at(t)) {
                t = there;
            }
        }
        Self {
            on: On::Edge {
                exit,
                plane,
                ends,
                t,
                rises: from < to,
            },
            position: at(t),
            local: mean_edge(surface, [Some(exit), Some(topology.twin(exit))]),
        }
    }

    /// Makes the node where the crease pierces `triangle`.
    pub(crate) fn on_crease(surface: &Surface, signs: &Signs, triangle: TriangleId) -> Self {
        let corners = surface.topology().triangle(triangle);
        let [a, b, c] = corners.map(|v| surface.position(v));
        let normal = area_vector([a, b, c]);
        let [start, end] = signs.crease();
        let [from, to] = [start, end].map(|x| normal.dot(&(x - a)));
        let x = start + (end - start) * (from / (from - to));
        let part = |p: Vec3, q: Vec3| normal.dot(&area_vector([p, q, x])).max(0.0);
        let parts = [part(b, c), part(c, a)];
        let sum = parts[0] + parts[1] + part(a, b);
        let mut weights = if sum > 0.0 && sum.is_finite() {
            round_parts(parts.map(|part| part / sum))
        } else {
            [1.0 / 3.0; 3]
        };
        let at = |weights: [f32; 3]| {
            let [u, v, w] = weights.map(f64::from);
            a * u + b * v + c * w
        };
        // Along a crease that lies nearly in the triangle's plane rounding does not know where it
        // pierces that; but it does so where it runs through the triangle.
        let mut off = signs.off_crease(at(weights));
        if off > 0.0 {
            for i in 0..2 {
                let [u, v, _] = middle([a, b, c].map(|p| signs.across(i, p)));
                let there = round_parts([u, v]);
                let other = signs.off_crease(at(there));
                if other < off {
                    (weights, off) = (there, other);
                }
            }
        }
        Self {
            on: On::Face { corners, weights },
            position: at(weights),
            local: mean_edge(surface, [triangle.half_edges().first().copied(), None]),
        }
    }

    /// Returns the origin of the node's vertices.
    pub(crate) fn origin(&self) -> VertexOrigin {
        match self.on {
            On::Edge {
                ends: [a, b], t, ..
            } => VertexOrigin::OnEdge { a, b, t },
            On::Face { corners, weights } => VertexOrigin::InFace { corners, weights },
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
            On::Face { weights, .. } => weights,
        }
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

/// Returns the mean edge length of the triangles of half-edges \[m\].
fn mean_edge(surface: &Surface, half_edges: [Option<HalfEdge>; 2]) -> f64 {
    let triangles = half_edges.into_iter().flatten().filter(|h| !h.is_null());
    let (sum, count) = triangles.fold((0.0, 0.0), |(sum, count), h| {
        let [a, b, c] = surface.triangle_positions(h.triangle());
        let perimeter = (b - a).norm() + (c - b).norm() + (a - c).norm();
        (sum + perimeter, count + 3.0)
    });
    sum / count
}
