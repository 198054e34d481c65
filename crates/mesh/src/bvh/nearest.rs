//! Nearest point queries.

use super::{Bvh, MAX_HEIGHT};
use crate::{Aabb, Surface, TriangleId, Vec3};

/// The nearest point of a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct NearestPoint {
    /// The triangle.
    pub triangle: TriangleId,
    /// Barycentric weights of the point, 0 to 1; their sum is 1.
    pub weights: [f64; 3],
    /// Position of the point \[m\].
    pub point: Vec3,
    /// Signed distance \[m\], positive on the side of the triangle's normal.
    pub distance: f64,
}

impl Bvh {
    /// Returns the point nearest to `to` within `reach` \[m\], among triangles for which `counts`
    /// is true.
    ///
    /// If several triangles share an edge or corner as nearest point, the triangle whose plane is
    /// farthest from `to` wins. Its sign separates inside and outside there (Baerentzen and Aanaes
    /// 2005 use normals). O(log n) for points near well-shaped triangles.
    #[must_use]
    pub fn nearest(
        &self,
        surface: &Surface,
        to: Vec3,
        reach: f64,
        counts: impl Fn(TriangleId) -> bool,
    ) -> Option<NearestPoint> {
        let reaches = |found: &Candidate, _| found.square <= reach * reach;
        self.nearest_below(surface, (to, reach), None, |_| true, counts, reaches)
    }

    /// Returns the point nearest to `to` within `reach` \[m\], better than `first`.
    ///
    /// `is_near` decides whether to descend to a node, `accepts` whether a triangle counts, and
    /// `reaches` whether its nearest point does.
    pub(super) fn nearest_below(
        &self,
        surface: &Surface,
        (to, reach): (Vec3, f64),
        first: Option<(Candidate, TriangleId)>,
        is_near: impl Fn(u32) -> bool,
        accepts: impl Fn(TriangleId) -> bool,
        reaches: impl Fn(&Candidate, TriangleId) -> bool,
    ) -> Option<NearestPoint> {
        let mut best = first;
        let mut least = best
            .as_ref()
            .map_or(reach * reach, |(found, _)| found.square);
        let mut at = 0;
        let mut others = [(0, 0.0); MAX_HEIGHT];
        let mut depth = 0;
        while let Some(node) = self.nodes.get(at as usize) {
            if !node.is_leaf() {
                let [left, right] = [node.index, node.index + 1].map(|child| {
                    let square = square_to(&self.nodes[child as usize].bounds, to);
                    let is_near = square <= least * (1.0 + TIE) && is_near(child);
                    (child, if is_near { square } else { f64::INFINITY })
                });
                let (near, far) = if right.1 < left.1 {
                    (right, left)
                } else {
                    (left, right)
                };
                if near.1 <= least {
                    if far.1 < f64::INFINITY {
                        others[depth] = far;
                        depth += 1;
                    }
                    at = near.0;
                    continue;
                }
            } else if square_to(&node.bounds, to) <= least {
                let block = &self.blocks[node.index as usize];
                for &triangle in &block.triangles[..node.count as usize] {
                    if !accepts(triangle) {
                        continue;
                    }
                    let found = Candidate::on(surface.triangle_positions(triangle), to);
                    if !reaches(&found, triangle) {
                        continue;
                    }
                    let is_better = best
                        .as_ref()
                        .is_none_or(|(other, number)| found.is_before(other, triangle < *number));
                    if found.square <= least * (1.0 + TIE) && is_better {
                        least = least.min(found.square);
                        best = Some((found, triangle));
                    }
                }
            }
            // The next node that may contain a nearer point.
            loop {
                if depth == 0 {
                    return best.map(|(found, triangle)| found.to_public(triangle));
                }
                depth -= 1;
                if others[depth].1 <= least * (1.0 + TIE) {
                    at = others[depth].0;
                    break;
                }
            }
        }
        None
    }
}

/// Relative difference below which squared distances are considered equal.
const TIE: f64 = 1e-9;

/// The nearest point of one triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    weights: [f64; 3],
    point: Vec3,
    /// Squared distance \[m^2\].
    pub(super) square: f64,
    /// Height of `to` above the triangle's plane \[m\].
    height: f64,
}

impl Candidate {
    /// Returns the nearest point of a triangle by Voronoi regions (Ericson 2005, section 5.1.5).
    pub(super) fn on([a, b, c]: [Vec3; 3], to: Vec3) -> Self {
        let (ab, ac, ap) = (b - a, c - a, to - a);
        let normal = ab.cross(&ac);
        let height = normal.try_normalize(0.0).map_or(0.0, |n| n.dot(&ap));
        let weights = nearest_weights(ab, ac, ap);
        let point = a * weights[0] + b * weights[1] + c * weights[2];
        Self {
            weights,
            point,
            square: (to - point).norm_squared(),
            height,
        }
    }

    fn is_before(&self, other: &Self, has_smaller_number: bool) -> bool {
        let is_tie = (self.square - other.square).abs() <= TIE * other.square;
        if !is_tie {
            return self.square < other.square;
        }
        let (height, other) = (self.height.abs(), other.height.abs());
        height > other || height == other && has_smaller_number
    }

    fn to_public(self, triangle: TriangleId) -> NearestPoint {
        NearestPoint {
            triangle,
            weights: self.weights,
            point: self.point,
            distance: self.square.sqrt().copysign(self.height),
        }
    }
}

fn nearest_weights(ab: Vec3, ac: Vec3, ap: Vec3) -> [f64; 3] {
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = ap - ab;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = d1 / (d1 - d3);
        return [1.0 - t, t, 0.0];
    }
    let cp = ap - ac;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = d2 / (d2 - d6);
        return [1.0 - t, 0.0, t];
    }
    let va = d3 * d6 - d5 * d4;
    let (e, f) = (d4 - d3, d5 - d6);
    if va <= 0.0 && e >= 0.0 && f >= 0.0 {
        let t = e / (e + f);
        return [0.0, 1.0 - t, t];
    }
    let sum = va + vb + vc;
    if sum > 0.0 {
        [va / sum, vb / sum, vc / sum]
    } else {
        [1.0, 0.0, 0.0]
    }
}

/// Returns the squared distance from a box to a point \[m^2\].
#[inline]
fn square_to(bounds: &Aabb, to: Vec3) -> f64 {
    let off = |k: usize| {
        let (below, above) = (
            f64::from(bounds.min[k]) - to[k],
            to[k] - f64::from(bounds.max[k]),
        );
        below.max(above).max(0.0)
    };
    let [x, y, z] = [off(0), off(1), off(2)];
    x * x + y * y + z * z
}
