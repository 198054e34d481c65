//! Ray casts and the opposite vertex of a piece.

use super::{Bvh, MAX_HEIGHT};
use crate::geometry::{area_vector, to_f64};
use crate::{Aabb, Surface, TriangleId, Vec3, VertexId};

/// The intersection of a ray and a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct RayHit {
    /// The triangle.
    pub triangle: TriangleId,
    /// Distance in lengths of the ray's direction.
    pub distance: f64,
    /// Barycentric weights of the point; their sum is 1.
    pub weights: [f64; 3],
    /// Whether the ray hits the back side.
    pub from_inside: bool,
}

impl RayHit {
    /// Returns the corner of the triangle that is nearest to the point, 0 to 2.
    #[must_use]
    pub fn nearest_corner(&self) -> usize {
        let [a, b, c] = self.weights;
        if a >= b && a >= c {
            0
        } else {
            1 + usize::from(c > b)
        }
    }
}

/// A ray with precomputed values for box tests.
struct Ray {
    origin: Vec3,
    direction: Vec3,
    inverse: Vec3,
}

impl Bvh {
    /// Returns the nearest triangle that a ray hits, among those for which `counts` is true.
    ///
    /// Edges and corners belong to all their triangles, so no ray passes between two. Triangles
    /// seen edge-on are not hit. O(log n) for well-shaped triangles.
    #[must_use]
    pub fn cast(
        &self,
        surface: &Surface,
        origin: Vec3,
        direction: Vec3,
        counts: impl Fn(TriangleId) -> bool,
    ) -> Option<RayHit> {
        let inverse = direction.map(f64::recip);
        let ray = Ray {
            origin,
            direction,
            inverse,
        };
        let mut nearest: Option<RayHit> = None;
        let mut at = 0;
        let mut others = [0; MAX_HEIGHT];
        let mut depth = 0;
        while let Some(node) = self.nodes.get(at as usize) {
            let most = nearest.map_or(f64::INFINITY, |hit| hit.distance);
            if ray.enters(&node.bounds).is_some_and(|way| way <= most) {
                if !node.is_leaf() {
                    // Visit the nearer child first, because its hit may exclude the other one.
                    let [left, right] = [node.index, node.index + 1];
                    let way = |child: u32| {
                        let way = ray.enters(&self.nodes[child as usize].bounds);
                        way.unwrap_or(f64::INFINITY)
                    };
                    let (first, second) = if way(right) < way(left) {
                        (right, left)
                    } else {
                        (left, right)
                    };
                    others[depth] = second;
                    depth += 1;
                    at = first;
                    continue;
                }
                let block = &self.blocks[node.index as usize];
                for &triangle in &block.triangles[..node.count as usize] {
                    if counts(triangle)
                        && let Some(hit) = ray.meets(surface, triangle)
                        && nearest.is_none_or(|other| {
                            (hit.distance, hit.triangle) < (other.distance, other.triangle)
                        })
                    {
                        nearest = Some(hit);
                    }
                }
            }
            if depth == 0 {
                break;
            }
            depth -= 1;
            at = others[depth];
        }
        nearest
    }

    /// Returns the vertex opposite to `v` on its piece, along the inward normal.
    ///
    /// It is the nearest corner of the first triangle of the piece that the ray hits from inside.
    /// `None` without such a triangle, or if both vertices are neighbors. The BVH must be fitted.
    #[must_use]
    pub fn opposite_vertex(&self, surface: &Surface, v: VertexId) -> Option<VertexId> {
        let topology = surface.topology();
        let first = topology.outgoing(v);
        if first.is_null() {
            return None;
        }
        let piece = surface.piece(first.triangle());
        let normals = topology
            .outgoing_fan(v)
            .map(|h| area_vector(surface.triangle_positions(h.triangle())));
        let inward = -normals.sum::<Vec3>().try_normalize(0.0)?;
        let hit = self.cast(surface, surface.position(v), inward, |t| {
            surface.piece(t) == piece && !topology.triangle(t).contains(&v)
        })?;
        let corners = topology.triangle(hit.triangle);
        let heaviest = (0..3).max_by(|&i, &j| hit.weights[i].total_cmp(&hit.weights[j]))?;
        let other = corners[heaviest];
        (hit.from_inside && !topology.are_adjacent(v, other)).then_some(other)
    }
}

impl Ray {
    /// Returns the distance to a box, 0 inside; `None` if the ray misses it.
    fn enters(&self, bounds: &Aabb) -> Option<f64> {
        let (min, max) = (to_f64(bounds.min), to_f64(bounds.max));
        let (mut near, mut far) = (0.0_f64, f64::INFINITY);
        for k in 0..3 {
            if self.direction[k] == 0.0 {
                if self.origin[k] < min[k] || self.origin[k] > max[k] {
                    return None;
                }
                continue;
            }
            let ways = [min[k], max[k]].map(|side| (side - self.origin[k]) * self.inverse[k]);
            // Comparisons, since `f64::min` and `f64::max` are calls of functions in WebAssembly.
            let [enter, leave] = if ways[0] < ways[1] {
                ways
            } else {
                [ways[1], ways[0]]
            };
            if enter > near {
                near = enter;
            }
            // Rounded up, so that a triangle in a side of the box is not missed.
            let leave = leave * (1.0 + 4.0 * f64::EPSILON);
            if leave < far {
                far = leave;
            }
        }
        (near <= far).then_some(near)
    }

    /// Returns the hit of a triangle (Moeller and Trumbore 1997, as signs of three volumes).
    fn meets(&self, surface: &Surface, triangle: TriangleId) -> Option<RayHit> {
        let corners = surface.triangle_positions(triangle);
        let [a, b, c] = corners.map(|p| p - self.origin);
        let volumes = [(c, b), (a, c), (b, a)].map(|(p, q)| self.direction.dot(&p.cross(&q)));
        let is_inside = |sign: f64| volumes.iter().all(|v| v * sign >= 0.0);
        let sum: f64 = volumes.iter().sum();
        if sum == 0.0 || !(is_inside(1.0) || is_inside(-1.0)) {
            return None;
        }
        let weights = volumes.map(|v| v / sum);
        let point = a * weights[0] + b * weights[1] + c * weights[2];
        let distance = point.dot(&self.direction) / self.direction.norm_squared();
        (distance >= 0.0).then_some(RayHit {
            triangle,
            distance,
            weights,
            // Corners are counterclockwise seen from outside; the volumes assume the opposite
            // order.
            from_inside: sum < 0.0,
        })
    }
}
