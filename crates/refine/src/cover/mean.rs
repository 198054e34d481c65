//! A point inside as the weighted mean of three points of the rings.
//!
//! The level line through the point crosses two sides of the triangle that holds it; the point is a
//! mean of the two crossings and each crossing one of the side's ends. That keeps every weight in
//! 0 to 1 and stays accurate in the thinnest triangle, where quotients of areas do not.

use super::cdt::{Cdt, Place};
use super::sheet::INSIDE;

/// Where a level line crosses a side of a triangle: its ends and how far along.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Side {
    ends: [u32; 2],
    at: f64,
    pub(crate) x: f64,
}

impl Side {
    #[inline]
    fn at(cdt: &Cdt, ends: [u32; 2], y: f64) -> Self {
        let (p, q) = (cdt.point(ends[0]), cdt.point(ends[1]));
        let rise = q[1] - p[1];
        let at = if rise > 0.0 {
            ((y - p[1]) / rise).clamp(0.0, 1.0)
        } else {
            1.0
        };
        let x = p[0] + at * (q[0] - p[0]);
        Self { ends, at, x }
    }
}

/// A triangle of the rings, its corners from low to high.
pub(crate) struct Crossing {
    corners: [u32; 3],
    /// Their heights.
    pub(crate) ys: [f64; 3],
}

impl Crossing {
    pub(crate) fn of(cdt: &Cdt, t: u32) -> Self {
        let mut corners = cdt.corners(t);
        corners.sort_unstable_by(|&v, &w| {
            let (p, q) = (cdt.point(v), cdt.point(w));
            p[1].total_cmp(&q[1]).then(p[0].total_cmp(&q[0]))
        });
        let ys = corners.map(|v| cdt.point(v)[1]);
        Self { corners, ys }
    }

    /// The sides that a level line goes through, left and right. The same side gives the same bits
    /// in the triangle next to it.
    pub(crate) fn at(&self, cdt: &Cdt, y: f64) -> [Side; 2] {
        let [low, middle, high] = self.corners;
        // At the upper end of a triangle with a level top it is the top's two ends.
        let short = if y < self.ys[1] || self.ys[1] == self.ys[2] {
            [low, middle]
        } else {
            [middle, high]
        };
        let mut sides = [Side::at(cdt, [low, high], y), Side::at(cdt, short, y)];
        if sides[0].x > sides[1].x {
            sides.swap(0, 1);
        }
        sides
    }
}

/// The corners of the triangle that holds a point, and its weights as their mean. `None` outside of
/// the rings.
pub(crate) fn mean_in(cdt: &mut Cdt, p: [f64; 2]) -> Option<([u32; 3], [f64; 3])> {
    let t = match cdt.locate(p, cdt.last) {
        Place::Face(t) => t,
        Place::Edge(h) => h / 3,
        Place::Vertex(_) => return None,
    };
    if cdt.region[t as usize] != INSIDE {
        return None;
    }
    cdt.last = t;
    Some(mix(&Crossing::of(cdt, t).at(cdt, p[1]), p[0]))
}

/// A point between two sides of a triangle as a mean of its corners.
pub(crate) fn mix([left, right]: &[Side; 2], x: f64) -> ([u32; 3], [f64; 3]) {
    let width = right.x - left.x;
    let u = if width > 0.0 {
        ((x - left.x) / width).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let mut parents = [left.ends[0], left.ends[1], left.ends[0]];
    let mut weights = [(1.0 - u) * (1.0 - left.at), (1.0 - u) * left.at, 0.0];
    for (end, weight) in right
        .ends
        .into_iter()
        .zip([u * (1.0 - right.at), u * right.at])
    {
        if end == parents[0] {
            weights[0] += weight;
        } else if end == parents[1] {
            weights[1] += weight;
        } else {
            parents[2] = end;
            weights[2] = weight;
        }
    }
    (parents, weights)
}
