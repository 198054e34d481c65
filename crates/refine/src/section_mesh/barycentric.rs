//! Barycentric weights of a point in the triangulation of the loops.
//!
//! The horizontal line through the point crosses two sides of the containing triangle. The point
//! is a mean of the two crossings, and each crossing a mean of the side's ends. All weights are in
//! 0 to 1 and accurate in the thinnest triangle, unlike quotients of areas.

use super::cdt::{Cdt, Location};
use super::loop_triangulation::INSIDE;

/// The crossing of a horizontal line and a side of a triangle.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Side {
    /// Ends of the side.
    ends: [u32; 2],
    /// Position along the side, 0 to 1.
    at: f64,
    /// The crossing's x.
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

    /// Interpolates a value of the vertices at the crossing.
    pub(crate) fn interpolate(&self, value: impl Fn(u32) -> f64) -> f64 {
        let [start, end] = self.ends.map(value);
        start + self.at * (end - start)
    }
}

/// A triangle with its corners sorted by y, for crossings with horizontal lines.
pub(crate) struct Crossing {
    corners: [u32; 3],
    /// y of each corner, ascending.
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

    /// Returns the left and the right crossing with the line at `y`.
    ///
    /// A shared side gives the same bits in both of its triangles.
    pub(crate) fn at(&self, cdt: &Cdt, y: f64) -> [Side; 2] {
        let [low, middle, high] = self.corners;
        // At the top of a triangle with a horizontal upper side, take that side's two ends.
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

/// Returns the corners of the triangle that contains `p` and their weights.
///
/// `None` outside of the loops and on a vertex.
pub(crate) fn barycentric_weights(cdt: &mut Cdt, p: [f64; 2]) -> Option<([u32; 3], [f64; 3])> {
    let t = match cdt.locate(p, cdt.last) {
        Location::Face(t) => t,
        Location::Edge(h) => h / 3,
        Location::Vertex(_) => return None,
    };
    if cdt.region[t as usize] != INSIDE {
        return None;
    }
    cdt.last = t;
    Some(weights_between(&Crossing::of(cdt, t).at(cdt, p[1]), p[0]))
}

/// Returns the corners and weights of the point at `x` between two crossings of a triangle.
pub(crate) fn weights_between([left, right]: &[Side; 2], x: f64) -> ([u32; 3], [f64; 3]) {
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
