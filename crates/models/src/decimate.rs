//! Decimation by quadric edge collapse (Garland and Heckbert 1997).

use crate::shell::{Shell, shape_quality};
use incise_mesh::geometry::{Vec3, area_vector};
use incise_mesh::{HalfEdge, VertexId};
use nalgebra::Matrix3;
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// Weight of the edge length^4 beside the squared distance times area.
///
/// In flat regions, short edges then collapse first and triangles stay similar in size.
const LENGTH_WEIGHT: f64 = 3e-4;
/// Weight of the edge's midpoint relative to the quadric's largest eigenvalue.
///
/// It determines the new point where the quadric is flat.
const CENTERING: f64 = 1e-3;
/// Minimum [`shape_quality`] of triangles after a collapse, unless they improve.
const WORST_QUALITY: f64 = 0.35;
/// Minimum cosine of the angle by which a triangle's normal may turn.
const LEAST_TURN_COSINE: f64 = 0.5;

/// Collapses edges until `target` triangles remain, or no edge can collapse.
pub(super) fn decimate(shell: &mut Shell, target: usize) {
    let mut state = Decimation::new(shell);
    while state.shell.live_triangles() > target {
        let Some(Reverse(candidate)) = state.queue.pop() else {
            return;
        };
        state.try_collapse(&candidate);
    }
}

/// A quadric: the area-weighted sum of squared distances to planes, p.Ap + 2 b.p + c.
#[derive(Clone, Copy)]
struct Quadric {
    a: Matrix3<f64>,
    b: Vec3,
    c: f64,
}

impl Quadric {
    const ZERO: Self = Self {
        a: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        b: Vec3::new(0.0, 0.0, 0.0),
        c: 0.0,
    };

    fn of_triangle(corners: [Vec3; 3]) -> Self {
        let vector = area_vector(corners);
        let length = vector.norm();
        if length == 0.0 {
            return Self::ZERO;
        }
        let n = vector / length;
        let offset = -n.dot(&corners[0]);
        let area = length / 2.0;
        Self {
            a: n * n.transpose() * area,
            b: n * (offset * area),
            c: offset * offset * area,
        }
    }

    fn add(&mut self, other: &Self) {
        self.a += other.a;
        self.b += other.b;
        self.c += other.c;
    }

    fn error(&self, p: Vec3) -> f64 {
        (p.dot(&(self.a * p)) + 2.0 * self.b.dot(&p) + self.c).max(0.0)
    }

    /// Returns the point of least error, weighted slightly toward `middle`.
    fn best_point(&self, middle: Vec3) -> Vec3 {
        let pull = CENTERING * self.a.trace();
        let m = self.a + Matrix3::from_diagonal_element(pull);
        let right = middle * pull - self.b;
        let [x, y, z] = [0, 1, 2].map(|i| Vec3::from(m.column(i)));
        let det = x.dot(&y.cross(&z));
        if det <= 0.0 {
            return middle;
        }
        Vec3::new(
            right.dot(&y.cross(&z)),
            x.dot(&right.cross(&z)),
            x.dot(&y.cross(&right)),
        ) / det
    }
}

/// A candidate collapse, valid while neither end changes; ordered by cost, then by ids.
struct Candidate {
    cost: f64,
    edge: HalfEdge,
    changes: [u32; 2],
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        self.cost
            .total_cmp(&other.cost)
            .then(self.edge.cmp(&other.edge))
            .then(self.changes.cmp(&other.changes))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Candidate {}

struct Decimation<'a> {
    shell: &'a mut Shell,
    quadrics: Vec<Quadric>,
    /// Change counter of each vertex, by which outdated candidates are recognized.
    changes: Vec<u32>,
    queue: BinaryHeap<Reverse<Candidate>>,
}

impl<'a> Decimation<'a> {
    fn new(shell: &'a mut Shell) -> Self {
        let mut quadrics = vec![Quadric::ZERO; shell.points.len()];
        let vertices: Vec<VertexId> = shell.vertices().collect();
        for &v in &vertices {
            for h in shell.fan(v) {
                let corners = shell.corners(h).map(|c| shell.point(c));
                quadrics[v.index()].add(&Quadric::of_triangle(corners));
            }
        }
        let mut out = Self {
            changes: vec![0; quadrics.len()],
            quadrics,
            queue: BinaryHeap::new(),
            shell,
        };
        let candidates: Vec<_> = out
            .shell
            .edges()
            .map(|h| Reverse(out.candidate(h)))
            .collect();
        out.queue = BinaryHeap::from(candidates);
        out
    }

    fn candidate(&self, edge: HalfEdge) -> Candidate {
        let ends = self.ends(edge);
        let [p, q] = ends.map(|v| self.shell.point(v));
        let (quadric, point) = self.merged(ends);
        let squared_length = (q - p).norm_squared();
        Candidate {
            cost: quadric.error(point) + LENGTH_WEIGHT * squared_length * squared_length,
            edge,
            changes: ends.map(|v| self.changes[v.index()]),
        }
    }

    fn ends(&self, edge: HalfEdge) -> [VertexId; 2] {
        [self.shell.origin(edge), self.shell.target(edge)]
    }

    /// Returns the quadric of both ends, and the point of their collapse.
    fn merged(&self, ends: [VertexId; 2]) -> (Quadric, Vec3) {
        let mut quadric = self.quadrics[ends[0].index()];
        quadric.add(&self.quadrics[ends[1].index()]);
        let [p, q] = ends.map(|v| self.shell.point(v));
        (quadric, quadric.best_point((p + q) / 2.0))
    }

    fn try_collapse(&mut self, candidate: &Candidate) {
        let h = candidate.edge;
        if self.shell.origin(h).is_null() {
            return;
        }
        let ends = self.ends(h);
        if ends.map(|v| self.changes[v.index()]) != candidate.changes || !self.shell.can_collapse(h)
        {
            return;
        }
        let (quadric, point) = self.merged(ends);
        if !self.keeps_shape(ends, point) {
            return;
        }
        self.shell.collapse(h, point);
        let [kept, gone] = ends;
        self.quadrics[kept.index()] = quadric;
        self.changes[kept.index()] += 1;
        self.changes[gone.index()] += 1;
        let around: Vec<HalfEdge> = self.shell.fan(kept).collect();
        for g in around {
            let renewed = self.candidate(g);
            self.queue.push(Reverse(renewed));
        }
    }

    /// Returns whether surviving triangles keep orientation and quality if both ends move to
    /// `point`.
    fn keeps_shape(&self, ends: [VertexId; 2], point: Vec3) -> bool {
        let shell = &*self.shell;
        let (mut before, mut after) = (f64::INFINITY, f64::INFINITY);
        for v in ends {
            for h in shell.fan(v) {
                let ids = shell.corners(h);
                let corners = ids.map(|c| shell.point(c));
                let normal = area_vector(corners);
                before = before.min(shape_quality(corners, normal));
                if ids.iter().filter(|c| ends.contains(c)).count() == 2 {
                    continue;
                }
                let moved = [point, corners[1], corners[2]];
                let turned = area_vector(moved);
                if turned.dot(&normal) < LEAST_TURN_COSINE * turned.norm() * normal.norm() {
                    return false;
                }
                after = after.min(shape_quality(moved, normal));
            }
        }
        after >= before.min(WORST_QUALITY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::implicit::{Body, ellipsoid};
    use crate::polygonize::polygonize;

    #[test]
    fn the_best_point_of_three_planes_is_their_intersection() {
        let corner = Vec3::new(1.0, -2.0, 0.5);
        let mut quadric = Quadric::ZERO;
        for (u, v) in [
            (Vec3::x(), Vec3::y()),
            (Vec3::y(), Vec3::z()),
            (Vec3::z(), Vec3::x()),
        ] {
            quadric.add(&Quadric::of_triangle([corner, corner + u, corner + v]));
        }
        assert!(quadric.error(corner) < 1e-15);
        assert!((quadric.error(corner + Vec3::new(0.0, 0.1, 0.0)) - 0.005).abs() < 1e-12);
        assert!((quadric.best_point(corner) - corner).norm() < 1e-12);
        let beside = quadric.best_point(corner + Vec3::repeat(0.1));
        assert!((beside - corner).norm() < 1e-3);
    }

    #[test]
    fn a_ball_keeps_its_volume() {
        let body = Body::new().with(ellipsoid([0.0; 3], [1.0; 3]), 0.1);
        let (points, faces) = polygonize(&body, 0.1);
        let mut shell = Shell::new(points, &faces);
        decimate(&mut shell, 500);
        let (points, faces) = shell.into_triangles();
        assert_eq!(faces.len(), 500);
        let volume: f64 = faces
            .iter()
            .map(|f| f.map(|v| points[v as usize]))
            .map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0)
            .sum();
        let exact = 4.0 / 3.0 * std::f64::consts::PI;
        assert!((volume / exact - 1.0).abs() < 0.02, "{volume}");
    }
}
