//! Nearest point queries.

use super::{Bvh, MAX_HEIGHT, MotionBounds};
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
        self.nearest_below(surface, to, reach, |_| true, counts)
    }

    /// Returns the point nearest to `to` on the pieces for which `counts` is true.
    ///
    /// Reads no triangles of other pieces. `bounds` must be found with this BVH; otherwise pieces
    /// may be missed. Displacements do not matter.
    #[must_use]
    pub fn nearest_of_pieces(
        &self,
        surface: &Surface,
        to: Vec3,
        bounds: &MotionBounds,
        counts: impl Fn(u32) -> bool,
    ) -> Option<NearestPoint> {
        let may_count = |at| bounds.piece_below(at).is_none_or(&counts);
        let of_piece = |t| counts(surface.piece(t));
        self.nearest_below(surface, to, f64::INFINITY, may_count, of_piece)
    }

    /// Returns the point nearest to `to` within `reach` \[m\].
    ///
    /// `may_count` decides whether to descend to a node, `counts` whether a triangle counts.
    fn nearest_below(
        &self,
        surface: &Surface,
        to: Vec3,
        reach: f64,
        may_count: impl Fn(u32) -> bool,
        counts: impl Fn(TriangleId) -> bool,
    ) -> Option<NearestPoint> {
        let mut best = Nearest::within(reach);
        let mut stack = TraversalStack::<_, _, { MAX_HEIGHT + 1 }>::default();
        let mut next = self.nodes.first().map(|_| 0);
        while let Some(at) = next {
            let node = &self.nodes[at as usize];
            if node.is_leaf() {
                let block = &self.blocks[node.index as usize];
                for &t in &block.triangles[..node.count as usize] {
                    if counts(t) {
                        best.offer(Candidate::on(surface.triangle_positions(t), to), t);
                    }
                }
            } else {
                let children = [node.index, node.index + 1];
                let squares = children.map(|c| {
                    if may_count(c) {
                        square_to(&self.nodes[c as usize].bounds, to)
                    } else {
                        f64::INFINITY
                    }
                });
                stack.push(children, squares, best.limit());
            }
            next = stack.pop(best.limit());
        }
        best.into_point()
    }
}

/// A traversal stack: nodes to visit and their squared distances \[m^2\].
///
/// Each group of nodes is sorted from far to near.
#[derive(Debug)]
pub(super) struct TraversalStack<N, S, const MAX: usize> {
    nodes: [(N, S); MAX],
    len: usize,
}

impl<N: Copy + Default, S: Copy + Default, const MAX: usize> Default for TraversalStack<N, S, MAX> {
    fn default() -> Self {
        Self {
            nodes: [Default::default(); MAX],
            len: 0,
        }
    }
}

impl<N: Copy, S: Copy + PartialOrd, const MAX: usize> TraversalStack<N, S, MAX> {
    /// Keeps the nodes of a group that are within a limit; the nearest one is visited next.
    #[inline]
    pub(super) fn push<const COUNT: usize>(
        &mut self,
        nodes: [N; COUNT],
        squares: [S; COUNT],
        limit: S,
    ) {
        let first = self.len;
        for (node, square) in nodes.into_iter().zip(squares) {
            if square <= limit {
                let mut at = self.len;
                while at > first && self.nodes[at - 1].1 < square {
                    self.nodes[at] = self.nodes[at - 1];
                    at -= 1;
                }
                self.nodes[at] = (node, square);
                self.len += 1;
            }
        }
    }

    /// Removes and returns the last node that is within a limit.
    #[inline]
    pub(super) fn pop(&mut self, limit: S) -> Option<N> {
        while self.len > 0 {
            self.len -= 1;
            let (node, square) = self.nodes[self.len];
            if square <= limit {
                return Some(node);
            }
        }
        None
    }
}

/// The nearest point found so far.
#[derive(Debug)]
pub(super) struct Nearest {
    best: Option<(Candidate, TriangleId)>,
    /// Least squared distance, or that of the reach \[m^2\].
    least: f64,
}

impl Nearest {
    /// Begins a search within a reach \[m\].
    pub(super) fn within(reach: f64) -> Self {
        Self {
            best: None,
            least: reach * reach,
        }
    }

    /// Returns the squared distance up to which a point may be nearer or as near, finite \[m^2\].
    #[inline]
    pub(super) fn limit(&self) -> f64 {
        (self.least * (1.0 + TIE)).min(f64::MAX)
    }

    /// Takes a point that is nearer than the others.
    pub(super) fn offer(&mut self, found: Candidate, triangle: TriangleId) {
        let is_better = match &self.best {
            Some((other, number)) => {
                found.square <= self.limit() && found.is_before(other, triangle < *number)
            }
            None => found.square <= self.least,
        };
        if is_better {
            self.least = self.least.min(found.square);
            self.best = Some((found, triangle));
        }
    }

    pub(super) fn into_point(self) -> Option<NearestPoint> {
        self.best.map(|(found, triangle)| found.to_public(triangle))
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
