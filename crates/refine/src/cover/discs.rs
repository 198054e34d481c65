//! A ring that touches or crosses itself, closed as a disc: ears clipped one by one.
//!
//! What counts is that it cannot fail: every ear joins two corners that were not neighbors, so no
//! edge comes twice, and where the surface outside has every such edge already, a vertex in the
//! middle takes its place. The order only serves the looks: ears of no area first, then those that
//! turn with the ring and are clear of its other corners, the roundest first.

use super::cdt::{id, orient};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A candidate, the best one greatest.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ear {
    class: u8,
    quality: f64,
    at: u32,
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

/// The ring that is left, linked by places in the ring that came in.
struct Ring<'a> {
    points: &'a [[f64; 2]],
    corners: &'a [u32],
    next: Vec<u32>,
    prev: Vec<u32>,
    stamp: Vec<u32>,
    alive: Vec<bool>,
    /// 1 or -1, so that the ring as a whole turns left.
    sign: f64,
    /// Places where the ring turned right or not at all: only these can be in an ear's way.
    reflex: Vec<u32>,
}

impl Ring<'_> {
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
        let square = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2);
        let class = if turn == 0.0 {
            // A spike goes at once, a straight corner only where nothing else is left.
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
        let quality = turn / (square(a, b) + square(b, c) + square(c, a));
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

/// Triangulates a ring of corners, at `points[corner]`. `joined` is asked about corners. Returns
/// the corners of what is left open where `joined` forbids every ear.
pub(crate) fn clip_ears(
    points: &[[f64; 2]],
    corners: &[u32],
    joined: impl Fn(u32, u32) -> bool,
    triangles: &mut Vec<[u32; 3]>,
) -> Option<Vec<u32>> {
    let n = id(corners.len());
    let mut ring = Ring {
        points,
        corners,
        next: (0..n).map(|i| (i + 1) % n).collect(),
        prev: (0..n).map(|i| (i + n - 1) % n).collect(),
        stamp: vec![0; corners.len()],
        alive: vec![true; corners.len()],
        sign: 1.0,
        reflex: Vec::new(),
    };
    let origin = ring.point(0);
    let twice: f64 = (0..n)
        .map(|i| {
            let (p, q) = (ring.point(i), ring.point((i + 1) % n));
            (p[0] - origin[0]) * (q[1] - origin[1]) - (p[1] - origin[1]) * (q[0] - origin[0])
        })
        .sum();
    if twice < 0.0 {
        ring.sign = -1.0;
    }
    ring.reflex = (0..n)
        .filter(|&i| ring.turn(ring.around(i)) <= 0.0)
        .collect();
    let mut ears: BinaryHeap<Ear> = (0..n).map(|i| ring.ear(i)).collect();
    let mut left = n;
    let mut last = 0;
    while left > 3 {
        let Some(ear) = ears.pop() else {
            let mut open = vec![corners[last as usize]];
            let mut at = ring.next[last as usize];
            while at != last {
                open.push(corners[at as usize]);
                at = ring.next[at as usize];
            }
            return Some(open);
        };
        if !ring.alive[ear.at as usize] || ear.stamp != ring.stamp[ear.at as usize] {
            continue;
        }
        if ear.class == 1 {
            // What was in its way may be gone.
            let again = ring.ear(ear.at);
            if again.class > 1 {
                ears.push(again);
                continue;
            }
        }
        let around = ring.around(ear.at);
        let [a, b, c] = around.map(|i| corners[i as usize]);
        if joined(a, c) {
            // For good: what it would join stays the same until one of its neighbors goes, and then
            // there is another ear here.
            continue;
        }
        triangles.push([a, b, c]);
        ring.remove(ear.at);
        left -= 1;
        last = around[0];
        ears.push(ring.ear(around[0]));
        ears.push(ring.ear(around[2]));
    }
    triangles.push(ring.around(last).map(|i| corners[i as usize]));
    None
}
