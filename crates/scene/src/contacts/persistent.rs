//! [`PersistentContact`]: a contact of a vertex with a triangle, kept from frame to frame.
//!
//! A search in every frame would alternate between triangles at the same distance, and resting
//! pieces would tremble. The narrow phase therefore reuses a contact while it persists.

use super::{MOTION_TOLERANCE, ROTATION_TOLERANCE};
use incise_mesh::geometry::area_vector;
use incise_mesh::{NearestPoint, Surface, TriangleId, Vec3, VertexId};
use incise_pbd_gpu::Contact;

/// A contact of a vertex with a point of a triangle, as found by the narrow phase.
#[derive(Debug, Clone, Copy)]
pub(super) struct PersistentContact {
    pub(super) vertex: VertexId,
    /// Index of the triangle's body in the scene.
    pub(super) other: u32,
    pub(super) triangle: TriangleId,
    corners: [VertexId; 3],
    /// Barycentric coordinates of the point.
    weights: [f64; 3],
    /// Unit normal of the contact plane, from the triangle to the vertex.
    normal: Vec3,
    /// Distance that the solver keeps along the normal \[m\]; grows up to the thickness.
    pub(super) gap: f64,
    /// The vertex relative to the point when it was found \[m\].
    offset: Vec3,
    /// Unit normal of the triangle when it was found.
    triangle_normal: Vec3,
}

impl PersistentContact {
    /// Creates the contact of a vertex at `at` with the nearest point of a body's surface, with a
    /// plane and its gap.
    pub(super) fn new(
        (other, surface): (u32, &Surface),
        (vertex, at): (VertexId, Vec3),
        found: &NearestPoint,
        (normal, gap): (Vec3, f64),
    ) -> Self {
        Self {
            vertex,
            other,
            triangle: found.triangle,
            corners: surface.topology().triangle(found.triangle),
            weights: found.weights,
            normal,
            gap,
            offset: at - found.point,
            triangle_normal: unit_normal(surface, found.triangle),
        }
    }

    /// Returns whether the contact can be reused for the vertex at `at`.
    ///
    /// The triangle must exist, and vertex and triangle must hardly have moved relative to each
    /// other.
    pub(super) fn persists(&self, surface: &Surface, at: Vec3, thickness: f64) -> bool {
        if !surface.topology().is_triangle(self.triangle)
            || surface.topology().triangle(self.triangle) != self.corners
        {
            return false;
        }
        let offset = self.offset(surface, at);
        (offset - self.offset).norm() <= MOTION_TOLERANCE * thickness
            && offset.dot(&self.normal) <= (1.0 + MOTION_TOLERANCE) * thickness
            && (unit_normal(surface, self.triangle) - self.triangle_normal).norm()
                <= ROTATION_TOLERANCE
    }

    /// Returns the vector from the point on the triangle to `at` \[m\].
    fn offset(&self, surface: &Surface, at: Vec3) -> Vec3 {
        let corners = self.corners.iter().zip(self.weights);
        let point: Vec3 = corners
            .map(|(&c, weight)| surface.position(c) * weight)
            .sum();
        at - point
    }

    /// Returns the rest distance of a vertex from the point of its own body \[m\].
    pub(super) fn rest_distance(&self, surface: &Surface) -> f64 {
        let corners = self.corners.iter().zip(self.weights);
        let point: Vec3 = corners.map(|(&c, w)| surface.rest_position(c) * w).sum();
        (surface.rest_position(self.vertex) - point).norm()
    }

    /// Returns the distance of a vertex at `at` along the normal \[m\]; negative in penetration.
    pub(super) fn height(&self, surface: &Surface, at: Vec3) -> f64 {
        self.offset(surface, at).dot(&self.normal)
    }

    /// Returns the solver's contact, whose gap opens at the speed `gap_rate` [m/s].
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the solver stores contacts in 32 bits"
    )]
    pub(super) fn to_solver(self, gap_rate: f64, friction: f32) -> Contact {
        let weights = self.weights.map(|w| w as f32);
        let normal = [0, 1, 2].map(|k: usize| self.normal[k] as f32);
        Contact {
            gap: self.gap as f32,
            gap_rate: gap_rate as f32,
            friction,
            ..Contact::vertex_face(self.vertex, self.corners, weights, normal)
        }
    }
}

/// Returns the unit normal of a triangle; zero for one without area.
fn unit_normal(surface: &Surface, t: TriangleId) -> Vec3 {
    area_normal(surface, t)
        .try_normalize(0.0)
        .unwrap_or_default()
}

/// Returns the normal of a triangle with the length of twice its area [m^2].
fn area_normal(surface: &Surface, t: TriangleId) -> Vec3 {
    area_vector(surface.triangle_positions(t))
}

/// Returns whether a triangle faces a vertex with an outward normal.
pub(super) fn faces(surface: &Surface, outward: Vec3, t: TriangleId) -> bool {
    outward.dot(&area_normal(surface, t)) < 0.0
}

/// Returns the sum of the area normals of the triangles around a vertex [m^2].
pub(super) fn outward_normal(surface: &Surface, v: VertexId) -> Vec3 {
    let fan = surface.topology().outgoing_fan(v);
    fan.map(|h| area_normal(surface, h.triangle())).sum()
}

/// Returns the normal of the contact plane and the distance of the vertex from it \[m\].
///
/// The candidates are the triangle's normal and the direction from the nearest point, both of
/// which separate the two. The one is chosen that leaves more room after the relative `motion`
/// \[m\]: the direction from an edge would stop a vertex that slides past it, the triangle's
/// normal one that falls past it.
pub(super) fn contact_plane(
    surface: &Surface,
    at: Vec3,
    found: &NearestPoint,
    motion: Vec3,
) -> (Vec3, f64) {
    let normal = unit_normal(surface, found.triangle);
    let offset = at - found.point;
    let height = normal.dot(&offset);
    // An offset of a few roundings has no direction.
    let extent = at.amax().max(found.point.amax());
    if found.distance <= 16.0 * f64::from(f32::EPSILON) * extent {
        return (normal, found.distance);
    }
    let direction = offset / found.distance;
    if found.distance + direction.dot(&motion) >= height + normal.dot(&motion) {
        (direction, found.distance)
    } else {
        (normal, height)
    }
}
