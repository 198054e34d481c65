//! The star of a vertex, and the displacement of the surface if the vertex is contracted.

use super::super::contract::{Opened, closed_fan, flatness, swept_volume};
use super::ring::{DisplacementBudget, Ring};
use super::shape::{Point, is_smooth, may_follow, quality, texture_scale, texture_side};
use incise_mesh::geometry::area_vector;
use incise_mesh::{HalfEdge, Surface, Vec3, VertexId};
use std::f64::consts::TAU;

/// A vertex with its triangles and neighbors, counterclockwise; on the rim from boundary to
/// boundary.
#[derive(Debug, Clone, Default)]
pub(super) struct Star {
    /// The half-edges that leave the vertex.
    pub(super) fan: Vec<HalfEdge>,
    /// Targets of the half-edges.
    pub(super) vertices: Vec<VertexId>,
    /// By neighbor, whether it is on the rim.
    pub(super) is_on_rim: Vec<bool>,
    is_on_boundary: bool,
    center: Option<Point>,
    points: Vec<Point>,
    pub(super) budget: Option<DisplacementBudget>,
    /// Neighbors projected to a plane around the vertex, and their heights above it.
    projected: Vec<[f64; 3]>,
}

impl Star {
    /// Gathers the star of the vertex off the rim that `start` leaves.
    ///
    /// Returns false where nothing may be contracted: at boundaries, outside the ring, on a seam of
    /// texture or normals, and between materials.
    pub(super) fn find(&mut self, surface: &Surface, ring: &Ring, start: HalfEdge) -> bool {
        let topology = surface.topology();
        self.is_on_boundary = false;
        ring.node_of(topology.origin(start)).is_none()
            && closed_fan(topology, start, &mut self.fan)
            && self.gather(surface, ring)
    }

    /// Gathers the star of a node's vertex on a side, as [`Self::find`] does off the rim.
    pub(super) fn find_at_node(
        &mut self,
        cut: &Opened<'_, '_>,
        ring: &Ring,
        node: u32,
        side: usize,
    ) -> bool {
        let surface = cut.edit.surface();
        self.is_on_boundary = true;
        self.fan.clear();
        let fan = cut.rim.fan(surface.topology(), cut.sides, node, side);
        self.fan.extend(fan);
        self.gather(surface, ring)
    }

    fn gather(&mut self, surface: &Surface, ring: &Ring) -> bool {
        let topology = surface.topology();
        let kind = |h: HalfEdge| (surface.material(h.triangle()), surface.piece(h.triangle()));
        self.vertices.clear();
        self.is_on_rim.clear();
        self.points.clear();
        self.budget = None;
        let start = self.fan[0];
        let end = self.fan[self.fan.len() - 1];
        let mut last = (!self.is_on_boundary).then_some(end);
        for &h in &self.fan {
            let Some(budget) = ring.budget(h.triangle()) else {
                return false;
            };
            let is_seam =
                last.is_some_and(|last| !surface.has_equal_corners(h.next(), last.prev()));
            if is_seam || kind(h) != kind(start) || !surface.has_equal_corners(h, start) {
                return false;
            }
            last = Some(h);
            self.budget = Some(self.budget.map_or(budget, |r| r.with(budget)));
            self.vertices.push(topology.target(h));
            self.points.push(Point::new(surface, h.next()));
        }
        if self.is_on_boundary {
            self.vertices.push(topology.origin(end.prev()));
            self.points.push(Point::new(surface, end.prev()));
        }
        let is_on_rim = self.vertices.iter().map(|&v| ring.node_of(v).is_some());
        self.is_on_rim.extend(is_on_rim);
        self.center = Some(Point::new(surface, start));
        true
    }

    /// Returns whether contraction onto neighbor `k` on the rim joins two more vertices of the rim.
    ///
    /// The cap may need that edge.
    pub(super) fn joins_rim(&self, k: usize) -> bool {
        let count = self.vertices.len();
        let is_new = |i: usize| i != k && (i + 1) % count != k && (k + 1) % count != i;
        self.is_on_rim[k] && (0..count).any(|i| is_new(i) && self.is_on_rim[i])
    }

    /// Returns the neighbor of a node on `side` that is the next node of the rim, or the one
    /// before.
    pub(super) fn along_rim(&self, side: usize, next: bool) -> usize {
        // On side 0 the rim runs against the order of nodes.
        if next == (side == 0) {
            self.vertices.len() - 1
        } else {
            0
        }
    }

    /// Iterates over the outer edges of the star, with the place of each first corner.
    fn sides(&self) -> impl Iterator<Item = (usize, [Point; 2])> + Clone + '_ {
        let count = self.points.len();
        let sides = 0..count - usize::from(self.is_on_boundary);
        sides.map(move |i| (i, [self.points[i], self.points[(i + 1) % count]]))
    }

    /// Iterates over the outer edges that do not touch neighbor `k`.
    fn sides_off(&self, k: usize) -> impl Iterator<Item = [Point; 2]> + Clone + '_ {
        let count = self.points.len();
        let is_off = move |i: usize| i != k && (i + 1) % count != k;
        self.sides().filter(move |s| is_off(s.0)).map(|s| s.1)
    }

    /// The worst triangle around the vertex.
    pub(super) fn quality(&self, layer: usize) -> f64 {
        let Some(center) = self.center else {
            return 0.0;
        };
        let sides = self.sides().map(|s| s.1);
        let all = sides.map(|[b, c]| quality([center, b, c].map(|p| p.at[layer])));
        all.fold(f64::INFINITY, f64::min)
    }

    /// Returns the quality of the worst triangle after contraction onto neighbor `k`.
    pub(super) fn quality_onto(&self, k: usize, layer: usize) -> f64 {
        let onto = self.points[k];
        let sides = self.sides_off(k);
        let all = sides.map(|[b, c]| quality([onto, b, c].map(|p| p.at[layer])));
        all.fold(f64::INFINITY, f64::min)
    }

    /// Returns whether all points are at their rest positions.
    pub(super) fn is_at_rest(&self) -> bool {
        let mut points = self.center.iter().chain(&self.points);
        points.all(Point::is_at_rest)
    }

    /// Returns the volume that contraction onto neighbor `k` moves \[m^3\].
    pub(super) fn volume_onto(&self, k: usize) -> f64 {
        let Some(center) = self.center else {
            return 0.0;
        };
        let onto = self.points[k].at[0];
        let swept = |[b, c]: [Point; 2]| swept_volume([center, b, c].map(|p| p.at[0]), onto);
        self.sides_off(k).map(swept).sum::<f64>().abs()
    }

    /// Returns the maximum displacement by contraction onto neighbor `k`, also at rest and in the
    /// texture \[m\].
    ///
    /// None if a triangle rotates by more than 30 degrees, or if the vertex is on a feature other
    /// than one along the edge to `k`.
    ///
    /// Projected along the mean normal, old and new triangles cover the same outline once. Their
    /// distance is linear between the vertex and the crossings of old and new edges, so its maximum
    /// is at one of these. A vertex of the rim first moves to the new rim edge, which makes both
    /// outlines equal. This moves each triangle by at most the displacement of the vertex.
    pub(super) fn distance_onto(&mut self, k: usize) -> Option<f64> {
        let center = self.center?;
        let scale = texture_scale(self.points.iter().map(|&p| [center, p]));
        if scale.is_some() && !self.texture_may_follow(center, k) {
            return None;
        }
        let scale = scale.unwrap_or(0.0);
        let distance = self.layer_distance(center, k, 0, scale)?;
        if self.is_at_rest() {
            return Some(distance);
        }
        Some(distance.max(self.layer_distance(center, k, 1, 0.0)?))
    }

    fn texture_may_follow(&self, center: Point, k: usize) -> bool {
        let onto = self.points[k];
        let side = |a: Point, [b, c]: [Point; 2]| texture_side([a, b, c].map(|p| p.uv));
        let old = self.sides().map(|s| side(center, s.1));
        may_follow(old, self.sides_off(k).map(|s| side(onto, s)))
    }

    fn layer_distance(&mut self, vertex: Point, k: usize, layer: usize, scale: f64) -> Option<f64> {
        let normal = self.turned_normal(vertex, k, layer)?;
        let center = if self.is_on_boundary {
            self.on_new_edge(vertex, layer)
        } else {
            vertex
        };
        self.lay_flat(center, normal, layer);
        if !self.is_covered_once() {
            return None;
        }
        let farthest = if self.is_on_boundary {
            let far = (center.at[layer] - vertex.at[layer]).norm();
            let gap = [0, 1].map(|c| center.uv[c] - vertex.uv[c]);
            [far, scale * gap[0].hypot(gap[1])]
        } else {
            self.gap_at_center(center, k, scale)
        };
        let crossings = self.gap_at_crossings(center, k, scale);
        let [far, chart] = if self.is_on_boundary {
            [0, 1].map(|i| farthest[i] + crossings[i])
        } else {
            [0, 1].map(|i| farthest[i].max(crossings[i]))
        };
        (far.is_finite() && chart.is_finite()).then(|| far.max(chart))
    }

    /// Returns the point nearest to a rim vertex on the edge that replaces it.
    fn on_new_edge(&self, vertex: Point, layer: usize) -> Point {
        let (a, b) = (self.points[0], self.points[self.points.len() - 1]);
        let along = b.at[layer] - a.at[layer];
        let part = along.dot(&(vertex.at[layer] - a.at[layer])) / along.norm_squared();
        let t = part.clamp(0.0, 1.0);
        let uv = [0, 1].map(|i| a.uv[i] + t * (b.uv[i] - a.uv[i]));
        let at = [0, 1].map(|i| a.at[i] + (b.at[i] - a.at[i]) * t);
        Point { at, uv }
    }

    /// Returns the mean normal; none if a triangle rotates too far or a feature forbids the move.
    fn turned_normal(&self, center: Point, k: usize, layer: usize) -> Option<Vec3> {
        let of = |a: Point, [b, c]: [Point; 2]| [a, b, c].map(|p| p.at[layer]);
        let onto = self.points[k];
        let count = self.points.len();
        let normal: Vec3 = (self.sides()).map(|s| area_vector(of(center, s.1))).sum();
        let mut before = None;
        if !self.is_on_boundary {
            before = Some(flatness(of(
                center,
                [self.points[count - 1], self.points[0]],
            )));
        }
        let mut features = 0;
        let mut is_along = false;
        for (i, side) in self.sides() {
            let (was, is_flat) = flatness(of(center, side));
            if let Some((before, false)) = before
                && !is_flat
                && !is_smooth(before, was)
            {
                features += 1;
                is_along |= i == k;
            }
            before = Some((was, is_flat));
            if !is_flat && was.dot(&normal) <= 0.0 {
                return None;
            }
            if i == k || (i + 1) % count == k {
                continue;
            }
            let now = area_vector(of(onto, side));
            if now.dot(&normal) <= 0.0 || (!is_flat && !is_smooth(was, now)) {
                return None;
            }
        }
        let runs_along = features == 2 && is_along && !self.is_on_boundary;
        (features == 0 || runs_along).then(|| normal.normalize())
    }

    /// Projects the neighbors to the plane across `normal`, with the vertex at the origin.
    fn lay_flat(&mut self, center: Point, normal: Vec3, layer: usize) {
        let axis = Vec3::ith(normal.iamin(), 1.0);
        let x = axis.cross(&normal).normalize();
        let y = normal.cross(&x);
        let origin = center.at[layer];
        let flat = |p: &Point| [x, y, normal].map(|axis| axis.dot(&(p.at[layer] - origin)));
        self.projected.clear();
        self.projected.extend(self.points.iter().map(flat));
    }

    /// Returns whether the neighbors run counterclockwise around the vertex once, or half a turn on
    /// the rim.
    fn is_covered_once(&self) -> bool {
        let count = self.projected.len();
        let mut sum = 0.0;
        for (i, _) in self.sides() {
            let ([ax, ay, _], [bx, by, _]) = (self.projected[i], self.projected[(i + 1) % count]);
            let left = ax * by - ay * bx;
            if self.is_on_boundary && left < 0.0 {
                return false;
            }
            sum += left.atan2(ax * bx + ay * by);
        }
        // A whole number of turns, or about half of one.
        let most = if self.is_on_boundary { TAU } else { 1.5 * TAU };
        0.0 <= sum && sum < most
    }

    /// Returns the distance of the new triangles from the vertex, in space and in the texture.
    fn gap_at_center(&self, center: Point, k: usize, scale: f64) -> [f64; 2] {
        let count = self.points.len();
        let mut best = (f64::NEG_INFINITY, [f64::INFINITY; 2]);
        for i in (0..count).filter(|&i| i != k && (i + 1) % count != k) {
            let corners = [k, i, (i + 1) % count];
            let [a, b, c] = corners.map(|i| self.projected[i]);
            let part = |p: [f64; 3], q: [f64; 3]| p[0] * q[1] - p[1] * q[0];
            let parts = [part(b, c), part(c, a), part(a, b)];
            let whole: f64 = parts.iter().sum();
            let weights = parts.map(|part| part / whole);
            let least = weights[0].min(weights[1]).min(weights[2]);
            // The vertex is in one of them, up to rounding.
            if least > best.0 {
                let height = weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2];
                let gap = [0, 1].map(|axis| {
                    let uv = corners.map(|i| self.points[i].uv[axis]);
                    let there = weights[0] * uv[0] + weights[1] * uv[1] + weights[2] * uv[2];
                    there - center.uv[axis]
                });
                best = (least, [height.abs(), scale * gap[0].hypot(gap[1])]);
            }
        }
        best.1
    }

    /// Returns the maximum distance of crossing old and new edges, in space and in the texture.
    fn gap_at_crossings(&self, center: Point, k: usize, scale: f64) -> [f64; 2] {
        let count = self.points.len();
        let is_new = |i: usize| i != k && (i + 1) % count != k && (k + 1) % count != i;
        let (onto, [wx, wy, wz]) = (self.points[k], self.projected[k]);
        let mut farthest = [0.0_f64; 2];
        for j in (0..count).filter(|&j| is_new(j)) {
            let [dx, dy, dz] = [0, 1, 2].map(|i| self.projected[j][i] - self.projected[k][i]);
            for i in (0..count).filter(|&i| i != k && i != j) {
                let [ux, uy, uz] = self.projected[i];
                let whole = ux * dy - uy * dx;
                let s = (wx * dy - wy * dx) / whole;
                let t = (wx * uy - wy * ux) / whole;
                let is_part = |x: f64| (0.0..=1.0).contains(&x);
                if !is_part(s) || !is_part(t) {
                    continue;
                }
                let gap = [0, 1].map(|axis| {
                    let [from, to] = [center, self.points[i]].map(|p| p.uv[axis]);
                    let [start, end] = [onto, self.points[j]].map(|p| p.uv[axis]);
                    from + s * (to - from) - (start + t * (end - start))
                });
                farthest[0] = farthest[0].max((s * uz - (wz + t * dz)).abs());
                farthest[1] = farthest[1].max(scale * gap[0].hypot(gap[1]));
            }
        }
        farthest
    }
}
