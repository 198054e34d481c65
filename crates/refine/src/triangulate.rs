//! The paper's Algorithm A2: a polygon's triangles, smallest angle first.
//!
//! What the listing leaves open, and what was decided:
//!
//! - It takes the smallest angle whatever lies beside it. On a polygon that is not convex that
//!   makes triangles outside it, so an ear counts only where the polygon turns left and no other
//!   vertex lies in the triangle. When no such ear is left (a self-crossing rim) the smallest angle
//!   of all is taken, as the listing does.
//! - `minAngle` is never reset and `index` never initialized in the listing; both start anew for
//!   every ear here.
//! - Lines 10 and 14 name the clipped edge's own ends as the new edge; it joins the ear's two outer
//!   ends, the start of the edge before and the end of the edge at `index`.
//! - Line 18 names the start of the last edge twice; the last triangle has the three vertices left.
//! - The listing looks at all edges for every triangle, O(n^2). A heap gives the same order in
//!   O(n log n), plus the test of each ear against the reflex vertices.
//! - A diagonal that the surface outside has as an edge already would make a third triangle on it,
//!   so such an ear waits; if nothing else is left, a vertex in the middle takes its place.

use crate::patch::{Patch, RefineReport};
use incise_mesh::Vec3;
use robust::{Coord, orient2d};
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// Covers the polygon `rim` with triangles on its own vertices: n - 2 of them, unless `joined`
/// forbids every diagonal, which costs a vertex in the middle. See [`crate::fill`] for the meaning of the
/// arguments. O(n log n + n r) for r reflex vertices.
///
/// A rim of fewer than 3 vertices has no triangles.
pub fn triangulate(rim: &[Vec3], normal: Vec3, joined: &impl Fn(u32, u32) -> bool) -> Patch {
    let mut patch = Patch {
        rim: rim.len(),
        points: rim.to_vec(),
        inner: Vec::new(),
        triangles: Vec::with_capacity(rim.len().saturating_sub(2)),
        report: RefineReport::default(),
    };
    if rim.len() < 3 {
        return patch;
    }
    let mut polygon = Polygon::new(project(rim, normal));
    let mut ears = BinaryHeap::new();
    let mut waiting: Vec<Reverse<Ear>> = Vec::new();
    for v in 0..rim.len() {
        ears.push(Reverse(polygon.ear(v)));
    }
    let mut left = rim.len();
    let mut strict = true;
    while left > 3 {
        let Some(Reverse(ear)) = ears.pop() else {
            // Every ear left is covered by the polygon or forbidden by the surface.
            if !strict {
                close_with_center(&mut patch, &polygon);
                return patch;
            }
            strict = false;
            ears.extend(waiting.drain(..));
            continue;
        };
        if ear.stamp != polygon.stamp[ear.vertex] {
            continue;
        }
        let [a, b, c] = polygon.corners(ear.vertex);
        if joined(index(a), index(c)) || (strict && !polygon.is_clear(ear.vertex)) {
            waiting.push(Reverse(ear));
            continue;
        }
        patch.triangles.push([a, b, c].map(index));
        polygon.remove(b);
        left -= 1;
        strict = true;
        ears.push(Reverse(polygon.ear(a)));
        ears.push(Reverse(polygon.ear(c)));
        ears.extend(waiting.drain(..));
    }
    let [a, b, c] = polygon.corners(polygon.first());
    patch.triangles.push([a, b, c].map(index));
    patch
}

/// A candidate: a vertex, its interior angle, and the count of changes around it when that was measured.
#[derive(Debug, Clone, Copy)]
struct Ear {
    angle: f64,
    vertex: usize,
    stamp: u32,
}

impl Ord for Ear {
    fn cmp(&self, other: &Self) -> Ordering {
        self.angle
            .total_cmp(&other.angle)
            .then(self.vertex.cmp(&other.vertex))
            .then(self.stamp.cmp(&other.stamp))
    }
}

impl PartialOrd for Ear {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Ear {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Ear {}

/// What is left of the polygon, as a linked ring.
struct Polygon {
    points: Vec<Coord<f64>>,
    next: Vec<usize>,
    prev: Vec<usize>,
    alive: Vec<bool>,
    stamp: Vec<u32>,
    /// Vertices that were reflex or straight at first: only these can lie in an ear, and clipping
    /// ears never makes new ones.
    reflex: Vec<usize>,
}

impl Polygon {
    fn new(points: Vec<Coord<f64>>) -> Self {
        let n = points.len();
        let mut polygon = Self {
            next: (0..n).map(|i| (i + 1) % n).collect(),
            prev: (0..n).map(|i| (i + n - 1) % n).collect(),
            alive: vec![true; n],
            stamp: vec![0; n],
            reflex: Vec::new(),
            points,
        };
        polygon.reflex = (0..n).filter(|&v| polygon.turn(v) <= 0.0).collect();
        polygon
    }

    fn corners(&self, v: usize) -> [usize; 3] {
        [self.prev[v], v, self.next[v]]
    }

    fn first(&self) -> usize {
        self.alive
            .iter()
            .position(|&alive| alive)
            .expect("three vertices are never removed")
    }

    /// Positive where the polygon turns left. The sign is exact.
    fn turn(&self, v: usize) -> f64 {
        let [a, b, c] = self.corners(v).map(|i| self.points[i]);
        orient2d(a, b, c)
    }

    /// The interior angle at `v` \[rad\], 0 to 2 pi.
    fn angle(&self, v: usize) -> f64 {
        let [a, b, c] = self.corners(v).map(|i| self.points[i]);
        let (ux, uy) = (c.x - b.x, c.y - b.y);
        let (wx, wy) = (a.x - b.x, a.y - b.y);
        let angle = (ux * wy - uy * wx).atan2(ux * wx + uy * wy);
        if angle < 0.0 {
            angle + std::f64::consts::TAU
        } else {
            angle
        }
    }

    fn ear(&self, v: usize) -> Ear {
        Ear {
            angle: self.angle(v),
            vertex: v,
            stamp: self.stamp[v],
        }
    }

    /// Whether the polygon turns left at `v` and no other vertex lies in its ear.
    fn is_clear(&self, v: usize) -> bool {
        if self.turn(v) <= 0.0 {
            return false;
        }
        let corners = self.corners(v);
        let [a, b, c] = corners.map(|i| self.points[i]);
        !self.reflex.iter().any(|&r| {
            self.alive[r] && !corners.contains(&r) && {
                let p = self.points[r];
                orient2d(a, b, p) >= 0.0 && orient2d(b, c, p) >= 0.0 && orient2d(c, a, p) >= 0.0
            }
        })
    }

    fn remove(&mut self, v: usize) {
        let [a, _, c] = self.corners(v);
        self.next[a] = c;
        self.prev[c] = a;
        self.alive[v] = false;
        for i in [a, v, c] {
            self.stamp[i] += 1;
        }
    }

    fn ring(&self) -> Vec<usize> {
        let first = self.first();
        let mut ring = vec![first];
        let mut at = self.next[first];
        while at != first {
            ring.push(at);
            at = self.next[at];
        }
        ring
    }
}

/// Closes what is left with a fan around the mean of three of its vertices.
fn close_with_center(patch: &mut Patch, polygon: &Polygon) {
    let ring = polygon.ring();
    let n = ring.len();
    let parents = [ring[0], ring[n / 3], ring[2 * n / 3]];
    let center = index(patch.points.len());
    patch
        .points
        .push(parents.iter().map(|&i| patch.points[i]).sum::<Vec3>() / 3.0);
    patch.inner.push(parents.map(index));
    for i in 0..n {
        patch
            .triangles
            .push([index(ring[i]), index(ring[(i + 1) % n]), center]);
    }
}

/// The rim in a plane across `normal`, so that counterclockwise stays counterclockwise.
fn project(rim: &[Vec3], normal: Vec3) -> Vec<Coord<f64>> {
    let length = normal.norm();
    let n = if length > 0.0 {
        normal / length
    } else {
        Vec3::z()
    };
    let helper = if n.x.abs() <= n.y.abs() && n.x.abs() <= n.z.abs() {
        Vec3::x()
    } else if n.y.abs() <= n.z.abs() {
        Vec3::y()
    } else {
        Vec3::z()
    };
    let u = n.cross(&helper).normalize();
    let v = n.cross(&u);
    // In a plane of two axes coordinates are exact as they are; elsewhere the difference to a vertex nearby loses less.
    let is_level = n.iter().filter(|&&x| x == 0.0).count() == 2;
    let origin = if is_level { Vec3::zeros() } else { rim[0] };
    rim.iter()
        .map(|p| {
            let d = p - origin;
            Coord {
                x: d.dot(&u),
                y: d.dot(&v),
            }
        })
        .collect()
}

pub(crate) fn index(i: usize) -> u32 {
    u32::try_from(i).expect("a rim has fewer than 2^32 vertices")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn area(points: &[Vec3], t: &[u32; 3]) -> f64 {
        let [a, b, c] = t.map(|i| points[i as usize]);
        (b - a).cross(&(c - a)).z / 2.0
    }

    fn polygon_area(rim: &[Vec3]) -> f64 {
        (0..rim.len())
            .map(|i| rim[i].cross(&rim[(i + 1) % rim.len()]).z / 2.0)
            .sum()
    }

    proptest! {
        /// A star-shaped polygon is simple, whatever its radii: its triangles lie in it and fill it.
        #[test]
        fn a_simple_polygon_is_covered_once(radii in prop::collection::vec(0.1f64..1.0, 3..60)) {
            let n = radii.len() as f64;
            let rim: Vec<Vec3> = radii.iter().enumerate().map(|(i, r)| {
                let a = i as f64 * std::f64::consts::TAU / n;
                Vec3::new(r * a.cos(), r * a.sin(), 0.0)
            }).collect();
            let patch = triangulate(&rim, Vec3::z(), &|_, _| false);
            prop_assert_eq!(patch.triangles.len(), rim.len() - 2);
            prop_assert!(patch.triangles.iter().all(|t| area(&patch.points, t) > 0.0));
            let sum: f64 = patch.triangles.iter().map(|t| area(&patch.points, t)).sum();
            prop_assert!((sum - polygon_area(&rim)).abs() < 1e-12 * n);
        }

        /// Any loop at all, crossing itself or not, gives n - 2 triangles whose boundary is the rim.
        #[test]
        fn any_loop_is_closed(points in prop::collection::vec([-1.0f64..1.0, -1.0..1.0, -1.0..1.0], 3..40)) {
            let rim: Vec<Vec3> = points.iter().map(|&p| p.into()).collect();
            let patch = triangulate(&rim, Vec3::z(), &|_, _| false);
            prop_assert_eq!(patch.triangles.len(), rim.len() - 2);
            prop_assert_eq!(boundary(&patch), (0..index(rim.len())).collect::<Vec<_>>());
        }
    }

    /// Start vertices of the directed edges without an opposite, ascending; each must go one step up.
    fn boundary(patch: &Patch) -> Vec<u32> {
        let edges: Vec<(u32, u32)> = patch
            .triangles
            .iter()
            .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
            .collect();
        let mut open: Vec<u32> = edges
            .iter()
            .filter(|&&(a, b)| !edges.contains(&(b, a)))
            .map(|&(a, b)| {
                assert_eq!(b, (a + 1) % index(patch.rim), "a boundary edge of the rim");
                a
            })
            .collect();
        open.sort_unstable();
        open
    }

    #[test]
    fn forbidden_diagonals_are_not_used() {
        let rim = [
            Vec3::new(0.0, 0.0, 0.0),
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(1.0, 1.0, 0.0),
            Vec3::new(0.0, 1.0, 0.0),
        ];
        let patch = triangulate(&rim, Vec3::z(), &|a, b| (a + b) % 4 == 2 && a % 2 == 0);
        assert!(
            patch
                .triangles
                .iter()
                .all(|t| !(t.contains(&0) && t.contains(&2)))
        );
        assert_eq!(patch.triangles.len(), 2);
        let patch = triangulate(&rim, Vec3::z(), &|_, _| true);
        assert_eq!((patch.triangles.len(), patch.inner.len()), (4, 1));
        assert_eq!(boundary(&patch), [0, 1, 2, 3]);
    }
}
