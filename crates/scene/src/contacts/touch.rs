//! A contact of two pieces as it was found, and what tells which way is out.

use super::{AGAIN, TURNED};
use incise_cut::NearestPoint;
use incise_mesh::geometry::area_vector;
use incise_mesh::{Surface, TriangleId, Vec3, VertexId};
use incise_pbd_gpu::{Above, Contact};

/// A contact as it was found, so that who rests finds the same again: were it looked for anew, triangles that are as near
/// would take turns, and what rests would tremble.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    pub(super) vertex: VertexId,
    pub(super) triangle: TriangleId,
    corners: [VertexId; 3],
    weights: [f64; 3],
    /// The way out.
    out: Vec3,
    /// How far the vertex is to stay \[m\]. Grows while there is a contact, up to the thickness.
    pub(super) goal: f64,
    /// Where the vertex was, as seen from the point \[m\].
    at: Vec3,
    /// The triangle's normal then.
    facing: Vec3,
}

impl Touch {
    /// The contact of a vertex at a place with the nearest point found, along a way out and so far off.
    pub(super) fn new(
        surface: &Surface,
        (vertex, at): (VertexId, Vec3),
        found: &NearestPoint,
        (out, goal): (Vec3, f64),
    ) -> Self {
        Self {
            vertex,
            triangle: found.triangle,
            corners: surface.topology().triangle(found.triangle),
            weights: found.weights,
            out,
            goal,
            at: at - found.point,
            facing: facing(surface, found.triangle),
        }
    }

    /// Whether the vertex is at `at`, as seen from the triangle, next to where it was, and touches it still. With `own` the
    /// two may be of one piece.
    pub(super) fn holds(&self, surface: &Surface, at: Vec3, (thickness, own): (f64, bool)) -> bool {
        if surface.topology().outgoing(self.vertex).is_null()
            || !surface.topology().is_triangle(self.triangle)
            || surface.topology().triangle(self.triangle) != self.corners
            || !own && self.is_fold(surface)
        {
            return false;
        }
        let now = self.way(surface, at);
        (now - self.at).norm() <= AGAIN * thickness
            && now.dot(&self.out) <= (1.0 + AGAIN) * thickness
            && (facing(surface, self.triangle) - self.facing).norm() <= TURNED
    }

    /// From the point to `at` \[m\].
    fn way(&self, surface: &Surface, at: Vec3) -> Vec3 {
        let corners = self.corners.iter().zip(self.weights);
        let point: Vec3 = corners
            .map(|(&c, weight)| surface.position(c) * weight)
            .sum();
        at - point
    }

    /// Whether the two are of one piece.
    fn is_fold(&self, surface: &Surface) -> bool {
        let of_vertex = surface.topology().outgoing(self.vertex).triangle();
        surface.piece(of_vertex) == surface.piece(self.triangle)
    }

    /// How far the vertex is to stay off \[m\]: a fold that is thinner than that at rest is to stay one.
    pub(super) fn thickness(&self, surface: &Surface, thickness: f64) -> f64 {
        if !self.is_fold(surface) {
            return thickness;
        }
        let corners = self.corners.iter().zip(self.weights);
        let point: Vec3 = corners.map(|(&c, w)| surface.rest_position(c) * w).sum();
        thickness.min((surface.rest_position(self.vertex) - point).norm() / 2.0)
    }

    /// How far the vertex is off along the way out \[m\].
    pub(super) fn height(&self, surface: &Surface, at: Vec3) -> f64 {
        self.way(surface, at).dot(&self.out)
    }

    #[expect(
        clippy::cast_possible_truncation,
        reason = "what was found is rounded once to storage"
    )]
    pub(super) fn contact(&self, rise: f64) -> Contact {
        Contact {
            vertex: self.vertex,
            above: Above::Triangle {
                corners: self.corners,
                weights: self.weights.map(|w| w as f32),
            },
            normal: [self.out.x as f32, self.out.y as f32, self.out.z as f32],
            gap: self.goal as f32,
            rise: rise as f32,
        }
    }
}

/// A triangle's unit normal; zero of one without area.
fn facing(surface: &Surface, t: TriangleId) -> Vec3 {
    normal(surface, t).try_normalize(0.0).unwrap_or_default()
}

/// Along a triangle's normal [m^2].
fn normal(surface: &Surface, t: TriangleId) -> Vec3 {
    area_vector(surface.triangle_positions(t))
}

/// Whether a triangle looks towards a vertex with that way out.
pub(super) fn faces(surface: &Surface, outward: Vec3, t: TriangleId) -> bool {
    outward.dot(&normal(surface, t)) < 0.0
}

/// Out of the body at a vertex [m^2].
pub(super) fn outward(surface: &Surface, v: VertexId) -> Vec3 {
    let fan = surface.topology().outgoing_fan(v);
    fan.map(|h| normal(surface, h.triangle())).sum()
}

/// The way out and how far along it a vertex is \[m\]: along the triangle's normal or straight from the nearest point,
/// whichever leaves the vertex more room where it is moving \[m\]. Either plane keeps the two apart; but straight
/// from an edge what slides past is held up, and along a normal what falls past.
pub(super) fn plane_of(
    surface: &Surface,
    at: Vec3,
    found: &NearestPoint,
    moves: Vec3,
) -> (Vec3, f64) {
    let normal = facing(surface, found.triangle);
    let way = at - found.point;
    let height = normal.dot(&way);
    // A way of a few roundings has no direction.
    let extent = at.amax().max(found.point.amax());
    if found.distance <= 16.0 * f64::from(f32::EPSILON) * extent {
        return (normal, found.distance);
    }
    let straight = way / found.distance;
    if found.distance + straight.dot(&moves) >= height + normal.dot(&moves) {
        (straight, found.distance)
    } else {
        (normal, height)
    }
}
