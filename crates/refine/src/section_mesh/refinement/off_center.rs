//! Off-centers of triangles, and the effect of inserting a point on the minimum angle.
//!
//! Üngör, "Off-centers: A new type of Steiner points", 2009. The off-center is the circumcenter,
//! or a point closer to the shortest side if the circumcenter would leave a small angle or long
//! edges at that side.

use super::spiral;
use crate::section_mesh::cdt::{Cdt, LinkEdge, constraint, incircle_of, orient};

/// Maximum distances of an off-center from the midpoint of the shortest side, in its lengths.
///
/// The side appears under 36 and 58 degrees from there.
pub(crate) const OFF_CENTER_REACH: [f64; 2] = [1.54, 0.9];

/// cos^2 of 32 degrees: triangles at the rim with a smaller angle count as a complete spiral.
const COS2_32: f64 = 0.72;

/// A candidate point and the minimum angles, as cos^2, before and after its insertion.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Candidate {
    pub(crate) at: [f64; 2],
    /// The triangle that contains the point.
    pub(crate) triangle: u32,
    /// cos^2 of the minimum angle of the triangles to replace.
    pub(crate) old_cos2: f64,
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

    /// Computes the minimum angles before and after inserting `at`, and the cavity.
    ///
    /// `None` if a constraint lies between triangle `from` and the point, or the point lies on an
    /// edge or vertex.
    pub(crate) fn evaluate(&mut self, cdt: &Cdt, from: u32, at: [f64; 2]) -> Option<Candidate> {
        let triangle = locate_visible(cdt, from, at)?;
        self.stamps.resize(cdt.region.len(), 0);
        self.stamp += 1;
        self.stamps[triangle as usize] = self.stamp;
        self.at = at;
        self.cavity.clear();
        self.cavity.push(triangle);
        self.link.clear();
        let (mut old, mut new) = (-1.0f64, -1.0f64);
        let mut i = 0;
        while i < self.cavity.len() {
            let t = self.cavity[i];
            i += 1;
            old = old.max(cos2_min_angle(cdt.corner_points(t)));
            for h in [3 * t, 3 * t + 1, 3 * t + 2] {
                if cdt.constraints[h as usize] == constraint::FREE {
                    let u = cdt.twin[h as usize] / 3;
                    if self.stamps[u as usize] == self.stamp {
                        continue;
                    }
                    if incircle_of(cdt.corner_points(u), at) > 0.0 {
                        self.stamps[u as usize] = self.stamp;
                        self.cavity.push(u);
                        continue;
                    }
                }
                self.link.push(LinkEdge::from_half_edge(h));
            }
        }
        for edge in &self.link {
            let h = edge.half_edge;
            let [p, q] = [cdt.start(h), cdt.end(h)].map(|v| cdt.point(v));
            if orient(p, q, at) <= 0.0 {
                return None;
            }
            new = new.max(cos2_min_angle([p, q, at]));
        }
        Some(Candidate {
            at,
            triangle,
            old_cos2: old,
            new_cos2: new,
        })
    }

    /// Computes the minimum angle of the candidate evaluated last, once spirals are complete.
    ///
    /// Returns false unless its sin^2 is greater than `gain` times the one before.
    pub(crate) fn complete_spirals(&self, cdt: &Cdt, candidate: &mut Candidate, gain: f64) -> bool {
        let bound = 1.0 - gain * (1.0 - candidate.old_cos2);
        let is_rim = |h: u32| cdt.constraints[h as usize] != constraint::FREE;
        let corners = |h: u32| [cdt.start(h), cdt.end(h)].map(|v| cdt.point(v));
        if candidate.new_cos2 < bound {
            return true;
        }
        // Triangles inside the section decide first: those at the rim cost more.
        let mut new = -1.0f64;
        for is_rim_turn in [false, true] {
            for h in self.link.iter().map(|edge| edge.half_edge) {
                if is_rim(h) != is_rim_turn {
                    continue;
                }
                let [p, q] = corners(h);
                let cos2 = cos2_min_angle([p, q, candidate.at]);
                new = new.max(if is_rim_turn && cos2 > COS2_32 {
                    cos2.min(spiral::cos2_beside([p, q], candidate.at))
                } else {
                    cos2
                });
                if new >= bound {
                    return false;
                }
            }
        }
        candidate.new_cos2 = new;
        true
    }
}

impl CavityScratch {
    /// Inserts the point of a candidate as vertex `v`.
    pub(crate) fn insert(&mut self, cdt: &mut Cdt, v: u32, candidate: &Candidate) {
        if self.at != candidate.at {
            self.evaluate(cdt, candidate.triangle, candidate.at);
        }
        cdt.insert_in_cavity(v, &mut self.cavity, &mut self.link);
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

/// Returns cos^2 of a triangle's minimum angle: 1/4 for an equilateral one, 1 for a degenerate one.
pub(crate) fn cos2_min_angle([a, b, c]: [[f64; 2]; 3]) -> f64 {
    let sides = [
        distance_squared(b, c),
        distance_squared(c, a),
        distance_squared(a, b),
    ];
    let shortest = sides[0].min(sides[1]).min(sides[2]);
    let [x, y] = if sides[0] == shortest {
        [sides[1], sides[2]]
    } else if sides[1] == shortest {
        [sides[0], sides[2]]
    } else {
        [sides[0], sides[1]]
    };
    let part = x + y - shortest;
    part * part / (4.0 * x * y)
}

/// Returns the index of a triangle's shortest side and its length.
pub(crate) fn shortest_side(p: [[f64; 2]; 3]) -> (usize, f64) {
    let squares = [0, 1, 2].map(|k| distance_squared(p[k], p[(k + 1) % 3]));
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
