//! Ear clipping of a loop that touches or crosses itself.
//!
//! It cannot fail. Every ear joins two corners that were not neighbors, so no edge is made twice.
//! Where the surrounding surface already has every such edge, the caller adds a central vertex.
//! The order affects quality only: ears without area first, then ears with the loop's orientation
//! that contain no other corner, in the order of their shape quality.

use super::cdt::orient;
use super::refinement::off_center::distance_squared;
use incise_mesh::index_u32;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A candidate ear; the best one compares greatest.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ear {
    /// 3: spike, 2: clear, 1: contains a corner, 0: wrong orientation or straight.
    class: u8,
    /// Area over the sum of squared sides.
    quality: f64,
    /// Position in the loop.
    at: u32,
    /// The position's change counter when the ear was evaluated.
    stamp: u32,
}

impl Eq for Ear {}

impl PartialOrd for Ear {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Ear {
    fn cmp(&self, other: &Self) -> Ordering {
        self.class
            .cmp(&other.class)
            .then(self.quality.total_cmp(&other.quality))
            .then(other.at.cmp(&self.at))
            .then(self.stamp.cmp(&other.stamp))
    }
}

/// The remaining loop, as a linked list over positions in the input loop.
struct Polygon<'a> {
    points: &'a [[f64; 2]],
    corners: &'a [u32],
    next: Vec<u32>,
    prev: Vec<u32>,
    stamp: Vec<u32>,
    alive: Vec<bool>,
    /// 1 for a counterclockwise loop, -1 for a clockwise one.
    sign: f64,
    /// Positions of initially reflex or straight corners; only these can lie in an ear.
    reflex: Vec<u32>,
}

impl Polygon<'_> {
    fn point(&self, i: u32) -> [f64; 2] {
        self.points[self.corners[i as usize] as usize]
    }

    fn around(&self, i: u32) -> [u32; 3] {
        [self.prev[i as usize], i, self.next[i as usize]]
    }

    fn turn(&self, [a, b, c]: [u32; 3]) -> f64 {
        self.sign * orient(self.point(a), self.point(b), self.point(c))
    }

    fn is_clear(&self, ear: [u32; 3]) -> bool {
        let p = ear.map(|i| self.point(i));
        let low = [0, 1].map(|k| p[0][k].min(p[1][k]).min(p[2][k]));
        let high = [0, 1].map(|k| p[0][k].max(p[1][k]).max(p[2][k]));
        !self.reflex.iter().any(|&i| {
            let q = self.point(i);
            self.alive[i as usize]
                && (0..2).all(|k| low[k] <= q[k] && q[k] <= high[k])
                && !p.contains(&q)
                && self.sign * orient(p[0], p[1], q) >= 0.0
                && self.sign * orient(p[1], p[2], q) >= 0.0
                && self.sign * orient(p[2], p[0], q) >= 0.0
        })
    }

    fn ear(&self, at: u32) -> Ear {
        let ear = self.around(at);
        let turn = self.turn(ear);
        let [a, b, c] = ear.map(|i| self.point(i));
        let class = if turn == 0.0 {
            // Spikes are clipped first, straight corners last.
            let ahead =
                (a[0] - b[0]) * (c[0] - b[0]) >= 0.0 && (a[1] - b[1]) * (c[1] - b[1]) >= 0.0;
            if ahead { 3 } else { 0 }
        } else if turn < 0.0 {
            0
        } else if self.is_clear(ear) {
            2
        } else {
            1
        };
        let quality =
            turn / (distance_squared(a, b) + distance_squared(b, c) + distance_squared(c, a));
        Ear {
            class,
            quality: if quality.is_nan() { 0.0 } else { quality },
            at,
            stamp: self.stamp[at as usize],
        }
    }

    fn remove(&mut self, at: u32) {
        let [a, _, c] = self.around(at);
        self.next[a as usize] = c;
        self.prev[c as usize] = a;
        self.alive[at as usize] = false;
        for i in [a, at, c] {
            self.stamp[i as usize] += 1;
        }
    }
}

/// Triangulates a loop of corners, at `points[corner]`.
///
/// Returns the corners of the remaining loop if `has_edge` forbids every ear.
pub(crate) fn clip_ears(
    points: &[[f64; 2]],
    corners: &[u32],
    has_edge: impl Fn(u32, u32) -> bool,
    triangles: &mut Vec<[u32; 3]>,
) -> Option<Vec<u32>> {
    let n = index_u32(corners.len());
    let mut polygon = Polygon {
        points,
        corners,
        next: (0..n).map(|i| (i + 1) % n).collect(),
        prev: (0..n).map(|i| (i + n - 1) % n).collect(),
        stamp: vec![0; corners.len()],
        alive: vec![true; corners.len()],
        sign: 1.0,
        reflex: Vec::new(),
    };
    let origin = polygon.point(0);
    let twice: f64 = (0..n)
        .map(|i| {
            let (p, q) = (polygon.point(i), polygon.point((i + 1) % n));
            (p[0] - origin[0]) * (q[1] - origin[1]) - (p[1] - origin[1]) * (q[0] - origin[0])
        })
        .sum();
    if twice < 0.0 {
        polygon.sign = -1.0;
    }
    polygon.reflex = (0..n)
        .filter(|&i| polygon.turn(polygon.around(i)) <= 0.0)
        .collect();
    let mut ears: BinaryHeap<Ear> = (0..n).map(|i| polygon.ear(i)).collect();
    let mut left = n;
    let mut last = 0;
    while left > 3 {
        let Some(ear) = ears.pop() else {
            let mut open = vec![corners[last as usize]];
            let mut at = polygon.next[last as usize];
            while at != last {
                open.push(corners[at as usize]);
                at = polygon.next[at as usize];
            }
            return Some(open);
        };
        if !polygon.alive[ear.at as usize] || ear.stamp != polygon.stamp[ear.at as usize] {
            continue;
        }
        if ear.class == 1 {
            // The corner inside the ear may have been clipped.
            let again = polygon.ear(ear.at);
            if again.class > 1 {
                ears.push(again);
                continue;
            }
        }
        let around = polygon.around(ear.at);
        let [a, b, c] = around.map(|i| corners[i as usize]);
        if has_edge(a, c) {
            // The ear stays forbidden until a neighbor is clipped, which queues a new ear here.
            continue;
        }
        triangles.push([a, b, c]);
        polygon.remove(ear.at);
        left -= 1;
        last = around[0];
        ears.push(polygon.ear(around[0]));
        ears.push(polygon.ear(around[2]));
    }
    triangles.push(polygon.around(last).map(|i| corners[i as usize]));
    None
}
