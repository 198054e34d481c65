//! What does a ray hit first?

use super::{Bvh, MAX_HEIGHT};
use incise_mesh::geometry::widen;
use incise_mesh::{Aabb, Surface, TriangleId, Vec3, VertexId};

/// Where a ray meets a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayHit {
    /// The triangle.
    pub triangle: TriangleId,
    /// How far it is, in lengths of the ray's direction.
    pub distance: f64,
    /// What its corners weigh at that point; they sum to 1.
    pub weights: [f64; 3],
    /// Whether the ray comes from the side that the triangle's normal points away from.
    pub from_inside: bool,
}

/// A ray, with what boxes are tested against.
struct Ray {
    origin: Vec3,
    direction: Vec3,
    inverse: Vec3,
}

impl Bvh {
    /// The nearest triangle that a ray meets, of those that `counts`. Edges and corners belong to all triangles
    /// around them, so nothing slips through between two; a triangle that is seen edge-on is not met. O(log n) in a tree
    /// of well-shaped triangles.
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
                    // The nearer child first: what it gives may spare the other one.
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

    /// The vertex on the other side of its piece that `v` looks at, along its inward normal: the nearest corner of
    /// the first triangle of the piece there. None if there is nothing, if that triangle is seen from outside, or if the
    /// two are neighbors. The tree has to fit the surface.
    #[must_use]
    pub fn across(&self, surface: &Surface, v: VertexId) -> Option<VertexId> {
        let topology = surface.topology();
        let first = topology.outgoing(v);
        if first.is_null() {
            return None;
        }
        let piece = surface.piece(first.triangle());
        let normals = topology.outgoing_fan(v).map(|h| {
            let corners = surface.triangle_positions(h.triangle());
            incise_mesh::geometry::area_vector(corners)
        });
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
    /// How far it is to a box, 0 inside; none if the ray misses it.
    fn enters(&self, bounds: &Aabb) -> Option<f64> {
        let (min, max) = (widen(bounds.min), widen(bounds.max));
        let (mut near, mut far) = (0.0_f64, f64::INFINITY);
        for k in 0..3 {
            if self.direction[k] == 0.0 {
                if self.origin[k] < min[k] || self.origin[k] > max[k] {
                    return None;
                }
                continue;
            }
            let ways = [min[k], max[k]].map(|side| (side - self.origin[k]) * self.inverse[k]);
            near = near.max(ways[0].min(ways[1]));
            // Rounded up, so that a triangle in the side of a box is not lost.
            far = far.min(ways[0].max(ways[1]) * (1.0 + 4.0 * f64::EPSILON));
        }
        (near <= far).then_some(near)
    }

    /// The point in a triangle (Moeller and Trumbore 1997, as three volumes of which the signs decide).
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
            // Corners are counterclockwise seen from outside, and the volumes are those of the other winding.
            from_inside: sum < 0.0,
        })
    }
}
