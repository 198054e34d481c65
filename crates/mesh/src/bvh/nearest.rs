//! Nearest point queries.

use super::{Bvh, MAX_HEIGHT, NONE};
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

/// Search radii of triangles, and for each BVH node their maximum and its piece.
///
/// A search skips whole pieces, and searches far for fast triangles only.
#[derive(Debug, Clone, Default)]
pub struct SearchRadii {
    /// Radius and piece of each node.
    nodes: Vec<NodeReach>,
    /// Radius of each triangle slot \[m\].
    triangles: Vec<f64>,
}

#[derive(Debug, Clone, Copy)]
struct NodeReach {
    /// Piece of all triangles below; [`NONE`] for a node of several pieces.
    piece: u32,
    /// Largest radius below \[m\].
    reach: f64,
}

impl SearchRadii {
    /// Computes the radii of a BVH's nodes from those of its triangles \[m\]. O(n).
    ///
    /// Valid until the BVH is updated or rebuilt.
    pub fn find(&mut self, bvh: &Bvh, surface: &Surface, reach: impl Fn(TriangleId) -> f64) {
        let nowhere = NodeReach {
            piece: NONE,
            reach: 0.0,
        };
        self.nodes.clear();
        self.nodes.resize(bvh.nodes.len(), nowhere);
        self.triangles.clear();
        self.triangles.resize(bvh.places.len(), 0.0);
        if !bvh.nodes.is_empty() {
            self.find_below(bvh, surface, &reach, 0);
        }
    }

    /// Returns the capacity, in triangles.
    #[must_use]
    pub fn capacity(&self) -> usize {
        self.nodes.capacity() + self.triangles.capacity()
    }

    fn find_below(
        &mut self,
        bvh: &Bvh,
        surface: &Surface,
        reach: &impl Fn(TriangleId) -> f64,
        at: u32,
    ) -> NodeReach {
        let node = &bvh.nodes[at as usize];
        let both = |a: NodeReach, b: NodeReach| NodeReach {
            piece: if a.piece == b.piece { a.piece } else { NONE },
            reach: a.reach.max(b.reach),
        };
        let found = if node.is_leaf() {
            let block = &bvh.blocks[node.index as usize];
            let triangles = block.triangles[..node.count as usize].iter();
            let each = triangles.map(|&t| {
                let (piece, reach) = (surface.piece(t), reach(t));
                self.triangles[t.index()] = reach;
                NodeReach { piece, reach }
            });
            each.reduce(both)
        } else {
            let [left, right] = [node.index, node.index + 1]
                .map(|child| self.find_below(bvh, surface, reach, child));
            Some(both(left, right))
        };
        if let Some(found) = found {
            self.nodes[at as usize] = found;
        }
        self.nodes[at as usize]
    }
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
        self.nearest_below(
            surface,
            (to, reach),
            None,
            counts,
            |_| Some(reach),
            |_| reach,
        )
    }

    /// Returns the nearest point within each triangle's radius plus `more` \[m\], except on piece
    /// `but`.
    ///
    /// A good first guess, such as the last nearest triangle, speeds the search up.
    #[must_use]
    pub fn nearest_in_reach(
        &self,
        surface: &Surface,
        (to, more): (Vec3, f64),
        (reaches, but): (&SearchRadii, Option<u32>),
        first: Option<TriangleId>,
        counts: impl Fn(TriangleId) -> bool,
    ) -> Option<NearestPoint> {
        let but = but.unwrap_or(NONE);
        let node = |at: u32| {
            let node = reaches.nodes.get(at as usize)?;
            (node.piece != but || but == NONE).then_some(node.reach + more)
        };
        let most = node(0)?;
        let counts = |t| (but == NONE || surface.piece(t) != but) && counts(t);
        let reach = |t: TriangleId| reaches.triangles[t.index()] + more;
        let first = first.filter(|&t| surface.topology().is_triangle(t) && counts(t));
        let first = first.map(|t| (Candidate::on(surface.triangle_positions(t), to), t));
        let first = first.filter(|(found, t)| found.square <= reach(*t).powi(2));
        self.nearest_below(surface, (to, most), first, counts, node, reach)
    }

    /// Searches nodes within their radius only.
    fn nearest_below(
        &self,
        surface: &Surface,
        (to, reach): (Vec3, f64),
        first: Option<(Candidate, TriangleId)>,
        counts: impl Fn(TriangleId) -> bool,
        reach_of: impl Fn(u32) -> Option<f64>,
        reach_of_triangle: impl Fn(TriangleId) -> f64,
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
                    let is_near = reach_of(child).is_some_and(|reach| square <= reach * reach);
                    (child, if is_near { square } else { f64::INFINITY })
                });
                let (near, far) = if right.1 < left.1 {
                    (right, left)
                } else {
                    (left, right)
                };
                if near.1 <= least {
                    others[depth] = far;
                    depth += 1;
                    at = near.0;
                    continue;
                }
            } else if square_to(&node.bounds, to) <= least {
                let block = &self.blocks[node.index as usize];
                for &triangle in &block.triangles[..node.count as usize] {
                    if !counts(triangle) {
                        continue;
                    }
                    let found = Candidate::on(surface.triangle_positions(triangle), to);
                    if found.square > reach_of_triangle(triangle).powi(2) {
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
struct Candidate {
    weights: [f64; 3],
    point: Vec3,
    /// Squared distance \[m^2\].
    square: f64,
    /// Height of `to` above the triangle's plane \[m\].
    height: f64,
}

impl Candidate {
    /// Returns the nearest point of a triangle by Voronoi regions (Ericson 2005, section 5.1.5).
    fn on([a, b, c]: [Vec3; 3], to: Vec3) -> Self {
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
