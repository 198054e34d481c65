//! The paper's Algorithm A2: ear clipping of a polygon, smallest angle first.
//!
//! Departures from the listing:
//!
//! - It takes the smallest angle without a test. In a concave polygon that gives triangles outside,
//!   so an ear must turn left and contain no other vertex. If no such ear is left (a self-crossing
//!   rim), the smallest angle of all is taken, as in the listing.
//! - `minAngle` is never reset and `index` never initialized in the listing; both are here, for
//!   every ear.
//! - Lines 10 and 14 name the clipped edge's own ends as the new edge. The new edge connects the
//!   ear's two outer ends: the start of the previous edge and the end of the edge at `index`.
//! - Line 18 names the start of the last edge twice; the last triangle has the three vertices left.
//! - The listing visits all edges for every triangle, O(n^2). A heap gives the same order in
//!   O(n log n), plus the test of each ear against the reflex vertices.
//! - A diagonal that is already an edge of the surrounding surface would get a third triangle. Such
//!   an ear waits; if no other ear is left, a central vertex replaces the diagonals.

use super::{Patch, RefineReport};
use incise_mesh::{Vec3, index_u32};
use robust::{Coord, orient2d};
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// Triangulates the polygon `rim` with n - 2 triangles on its own vertices.
///
/// If `has_edge` forbids every diagonal, a central vertex is added. [`fill`](super::fill) explains
/// the arguments. Time is O(n log n + n r) for r reflex vertices. A rim of fewer than 3 vertices
/// has no triangles.
pub fn triangulate(rim: &[Vec3], normal: Vec3, has_edge: &impl Fn(u32, u32) -> bool) -> Patch {
    let mut patch = Patch {
        rim_len: rim.len(),
        points: rim.to_vec(),
        parents: Vec::new(),
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
            // Every remaining ear contains a vertex or is forbidden by the surface.
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
        if has_edge(index_u32(a), index_u32(c)) || (strict && !polygon.is_clear(ear.vertex)) {
            waiting.push(Reverse(ear));
            continue;
        }
        patch.triangles.push([a, b, c].map(index_u32));
        polygon.remove(b);
        left -= 1;
        strict = true;
        ears.push(Reverse(polygon.ear(a)));
        ears.push(Reverse(polygon.ear(c)));
        ears.extend(waiting.drain(..));
    }
    let [a, b, c] = polygon.corners(polygon.first());
    patch.triangles.push([a, b, c].map(index_u32));
    patch
}

/// A candidate ear.
#[derive(Debug, Clone, Copy)]
struct Ear {
    /// Interior angle \[rad\].
    angle: f64,
    vertex: usize,
    /// The vertex's change counter when the angle was measured.
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

/// The remaining polygon, as a circular linked list.
struct Polygon {
    points: Vec<Coord<f64>>,
    next: Vec<usize>,
    prev: Vec<usize>,
    alive: Vec<bool>,
    stamp: Vec<u32>,
    /// Vertices that were reflex or straight at first; only these can lie in an ear.
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

    /// Returns a number with the exact sign of the turn at `v`, positive for a left turn.
    fn turn(&self, v: usize) -> f64 {
        let [a, b, c] = self.corners(v).map(|i| self.points[i]);
        orient2d(a, b, c)
    }

    /// Returns the interior angle at `v` \[rad\], 0 to 2 pi.
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

    /// Returns whether the polygon turns left at `v` and no other vertex lies in its ear.
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

/// Fills the remaining polygon with a fan around the mean of three of its vertices.
fn close_with_center(patch: &mut Patch, polygon: &Polygon) {
    let ring = polygon.ring();
    let n = ring.len();
    let parents = [ring[0], ring[n / 3], ring[2 * n / 3]];
    let center = index_u32(patch.points.len());
    patch
        .points
        .push(parents.iter().map(|&i| patch.points[i]).sum::<Vec3>() / 3.0);
    patch.parents.push(parents.map(index_u32));
    for i in 0..n {
        patch
            .triangles
            .push([index_u32(ring[i]), index_u32(ring[(i + 1) % n]), center]);
    }
}

/// Projects the rim along `normal`, so that counterclockwise stays counterclockwise.
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
    // In a coordinate plane coordinates are exact; elsewhere a nearby origin loses fewer digits.
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
        /// A star-shaped polygon is simple for any radii: its triangles cover it exactly.
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

        /// Any loop, self-crossing or not, gives n - 2 triangles whose boundary is the rim.
        #[test]
        fn any_loop_is_closed(
            points in prop::collection::vec([-1.0f64..1.0, -1.0..1.0, -1.0..1.0], 3..40)
        ) {
            let rim: Vec<Vec3> = points.iter().map(|&p| p.into()).collect();
            let patch = triangulate(&rim, Vec3::z(), &|_, _| false);
            prop_assert_eq!(patch.triangles.len(), rim.len() - 2);
            prop_assert_eq!(boundary(&patch), (0..index_u32(rim.len())).collect::<Vec<_>>());
        }
    }

    /// Returns the start vertices of boundary edges, ascending; each must be an edge of the rim.
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
                assert_eq!(
                    b,
                    (a + 1) % index_u32(patch.rim_len),
                    "a boundary edge of the rim"
                );
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
        assert_eq!((patch.triangles.len(), patch.parents.len()), (4, 1));
        assert_eq!(boundary(&patch), [0, 1, 2, 3]);
    }
}
