//! Off-centers of triangles, and the effect of inserting a point on the minimum angle.
//!
//! Üngör, "Off-centers: A new type of Steiner points", 2009. The off-center is the circumcenter,
//! or a point closer to the shortest side if the circumcenter would leave a small angle or long
//! edges at that side.

use super::spiral;
use crate::section_mesh::cdt::{Cdt, LinkEdge, constraint, is_in_circle, orient};

/// Maximum distances of an off-center from the midpoint of the shortest side, in its lengths.
///
/// The side appears under 36 and 58 degrees from there.
pub(crate) const OFF_CENTER_REACH: [f64; 2] = [1.54, 0.9];

/// cos^2 of 32 degrees: triangles at the rim with a smaller angle count as a complete spiral.
const COS2_32: f64 = 0.72;

/// A candidate point that meets its bound.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Candidate {
    pub(crate) at: [f64; 2],
    /// The triangle that contains the point.
    pub(crate) triangle: u32,
    /// cos^2 of the minimum angle of the new triangles.
    pub(crate) new_cos2: f64,
}

/// Scratch memory for the cavity of a point.
#[derive(Debug, Clone, Default)]
pub(crate) struct CavityScratch {
    /// Triangles whose circumcircle contains the point.
    cavity: Vec<u32>,
    /// Edges on the boundary of the cavity.
    link: Vec<LinkEdge>,
    /// The point of the cavity.
    at: [f64; 2],
    /// Value of `stamp` when each triangle was last visited.
    stamps: Vec<u32>,
    stamp: u32,
}

impl CavityScratch {
    pub(crate) fn clear(&mut self) {
        self.stamps.clear();
        self.stamp = 0;
    }

    /// Returns a candidate at `at`, seen from triangle `from`, if its triangles meet a bound.
    ///
    /// `bound` maps cos^2 of the minimum angle of the triangles to replace to that which all new
    /// ones must stay below. With `completes_spirals`, a sharp triangle at the rim is rated by its
    /// complete spiral. `None` also if a constraint lies between `from` and the point, or the point
    /// lies on an edge or vertex.
    pub(crate) fn evaluate(
        &mut self,
        cdt: &Cdt,
        from: u32,
        at: [f64; 2],
        bound: impl Fn(f64) -> f64,
        completes_spirals: bool,
    ) -> Option<Candidate> {
        let triangle = locate_visible(cdt, from, at)?;
        let bound = bound(self.find_cavity(cdt, triangle, at));
        let mut new_cos2 = -1.0f64;
        let mut is_complete = true;
        for edge in &self.link {
            let [p, q] = edge.ends.map(|v| cdt.point(v));
            if orient(p, q, at) <= 0.0 {
                return None;
            }
            let cos2 = cos2_min_angle([p, q, at]);
            if cos2 < bound {
                new_cos2 = new_cos2.max(cos2);
            } else if completes_spirals && edge.constraint != constraint::FREE && cos2 > COS2_32 {
                is_complete = false;
            } else {
                return None;
            }
        }
        // Spirals cost more than triangles, so they come last.
        if !is_complete {
            for edge in &self.link {
                let [p, q] = edge.ends.map(|v| cdt.point(v));
                if cos2_min_angle([p, q, at]) >= bound {
                    new_cos2 = new_cos2.max(spiral::cos2_beside([p, q], at));
                }
            }
        }
        (new_cos2 < bound).then_some(Candidate {
            at,
            triangle,
            new_cos2,
        })
    }

    /// Finds the cavity of `at`, which lies in `triangle`.
    ///
    /// Returns cos^2 of the minimum angle of its triangles.
    fn find_cavity(&mut self, cdt: &Cdt, triangle: u32, at: [f64; 2]) -> f64 {
        self.stamps.resize(cdt.region.len(), 0);
        self.stamp += 1;
        self.stamps[triangle as usize] = self.stamp;
        self.at = at;
        self.cavity.clear();
        self.cavity.push(triangle);
        self.link.clear();
        let mut cos2 = -1.0f64;
        let mut i = 0;
        while let Some(&t) = self.cavity.get(i) {
            i += 1;
            let corners = cdt.corners(t);
            let points = corners.map(|v| cdt.point(v));
            cos2 = cos2.max(cos2_min_angle(points));
            for (k, h) in (3 * t..3 * t + 3).enumerate() {
                let next = (k + 1) % 3;
                let (outside, constraint) = cdt.twin_and_constraint(h);
                if constraint == constraint::FREE {
                    let stamp = &mut self.stamps[outside as usize / 3];
                    if *stamp == self.stamp {
                        continue;
                    }
                    let apex = cdt.point(cdt.opposite(outside));
                    if is_in_circle([points[next], points[k], apex], at) {
                        *stamp = self.stamp;
                        self.cavity.push(outside / 3);
                        continue;
                    }
                }
                self.link.push(LinkEdge {
                    ends: [corners[k], corners[next]],
                    outside,
                    constraint,
                });
            }
        }
        cos2
    }

    /// Inserts the point of a candidate as vertex `v`.
    pub(crate) fn insert(&mut self, cdt: &mut Cdt, v: u32, candidate: &Candidate) {
        if self.at != candidate.at {
            self.find_cavity(cdt, candidate.triangle, candidate.at);
        }
        cdt.insert_in_cavity(v, &mut self.cavity, &self.link);
    }
}

/// Returns the triangle that contains `at`, unless a constraint separates it from triangle `t`.
fn locate_visible(cdt: &Cdt, mut t: u32, at: [f64; 2]) -> Option<u32> {
    for _ in 0..32 {
        let out = [3 * t, 3 * t + 1, 3 * t + 2]
            .into_iter()
            .find(|&h| orient(cdt.point(cdt.start(h)), cdt.point(cdt.end(h)), at) < 0.0);
        match out {
            None => return Some(t),
            Some(h) if cdt.constraints[h as usize] != constraint::FREE => return None,
            Some(h) => t = cdt.twin[h as usize] / 3,
        }
    }
    None
}

/// Returns the squared distance of two points.
pub(crate) fn distance_squared(p: [f64; 2], q: [f64; 2]) -> f64 {
    (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2)
}

/// Returns the midpoint of two points.
pub(crate) fn midpoint(p: [f64; 2], q: [f64; 2]) -> [f64; 2] {
    [0.5 * p[0] + 0.5 * q[0], 0.5 * p[1] + 0.5 * q[1]]
}

/// Returns the squared lengths of a triangle's sides, side k from corner k to the next.
pub(crate) fn squared_sides([a, b, c]: [[f64; 2]; 3]) -> [f64; 3] {
    [
        distance_squared(a, b),
        distance_squared(b, c),
        distance_squared(c, a),
    ]
}

/// Returns cos^2 of a triangle's minimum angle: 1/4 for an equilateral one, 1 for a degenerate one.
pub(crate) fn cos2_min_angle(p: [[f64; 2]; 3]) -> f64 {
    cos2_of_sides(squared_sides(p))
}

/// Returns [`cos2_min_angle`] of a triangle with these squared sides.
pub(crate) fn cos2_of_sides([a, b, c]: [f64; 3]) -> f64 {
    let shortest = a.min(b).min(c);
    let [x, y] = if a == shortest {
        [b, c]
    } else if b == shortest {
        [a, c]
    } else {
        [a, b]
    };
    let part = x + y - shortest;
    part * part / (4.0 * x * y)
}

/// Returns the index of the shortest of squared sides and its length.
pub(crate) fn shortest_side(squares: [f64; 3]) -> (usize, f64) {
    let k = (0..3).fold(
        0,
        |best, k| if squares[k] < squares[best] { k } else { best },
    );
    (k, squares[k].sqrt())
}

/// Returns the off-center of a triangle at side `k`, at most `reach` side lengths from its
/// midpoint.
pub(crate) fn off_center(p: [[f64; 2]; 3], k: usize, reach: f64) -> Option<[f64; 2]> {
    let [a, b, c] = [p[k], p[(k + 1) % 3], p[(k + 2) % 3]];
    let (u, w) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
    let double = u[0] * w[1] - u[1] * w[0];
    let base = u[0] * u[0] + u[1] * u[1];
    if !(double > 0.0 && base > 0.0) {
        return None;
    }
    // Distance of the circumcenter from the midpoint, in lengths of the side.
    let off = (w[0] * (w[0] - u[0]) + w[1] * (w[1] - u[1])) / (2.0 * double);
    let off = off.min(reach);
    let at = [
        a[0] + 0.5 * u[0] - off * u[1],
        a[1] + 0.5 * u[1] + off * u[0],
    ];
    (at[0].is_finite() && at[1].is_finite()).then_some(at)
}
