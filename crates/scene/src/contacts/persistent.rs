//! [`PersistentContact`]: a contact of a vertex with a triangle, kept from frame to frame.
//!
//! A search in every frame would alternate between triangles at the same distance, and resting
//! pieces would tremble. The narrow phase therefore reuses a contact while it persists. The solver
//! finds nearest point and normal in every substep, so that the contact may move meanwhile.

use incise_mesh::geometry::area_vector;
use incise_mesh::{NearestPoint, Surface, TriangleId, Vec3, VertexId};
use incise_pbd_gpu::ContactKind;

/// Maximum motion of a vertex relative to the triangle of a persistent contact [thicknesses].
const MOTION_TOLERANCE: f64 = 1.0;

/// Maximum distance of a vertex from the triangle of a persistent contact [thicknesses].
const MAX_DISTANCE: f64 = 2.0;

/// A contact of a vertex with a triangle, as found by the narrow phase.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct PersistentContact {
    pub(super) vertex: VertexId,
    /// Index of the triangle's body in the scene.
    pub(super) other: u32,
    pub(super) triangle: TriangleId,
    pub(super) corners: [VertexId; 3],
    pub(super) kind: ContactKind,
    /// Whether the vertex is behind the triangle of a sheet.
    pub(super) is_behind: bool,
    /// Barycentric coordinates of the nearest point when it was found.
    pub(super) weights: [f64; 3],
    /// The vertex relative to the point when it was found \[m\].
    pub(super) offset: Vec3,
}

impl PersistentContact {
    /// Creates the contact of a vertex at `at` with the nearest point of a body's surface.
    pub(super) fn new(
        (other, surface): (u32, &Surface),
        (vertex, at): (VertexId, Vec3),
        found: &NearestPoint,
        (kind, is_behind): (ContactKind, bool),
    ) -> Self {
        Self {
            vertex,
            other,
            triangle: found.triangle,
            corners: surface.topology().triangle(found.triangle),
            kind,
            is_behind,
            weights: found.weights,
            offset: at - found.point,
        }
    }

    /// Returns whether the contact can be reused for the vertex at `at`.
    ///
    /// The triangle must exist, the vertex must be above it, and both must have moved little
    /// relative to each other.
    pub(super) fn persists(
        &self,
        surface: &Surface,
        at: Vec3,
        thickness: impl Fn(TriangleId) -> f64,
    ) -> bool {
        if !surface.topology().is_triangle(self.triangle)
            || surface.topology().triangle(self.triangle) != self.corners
        {
            return false;
        }
        if self.kind != ContactKind::VertexFace {
            return false;
        }
        let thickness = thickness(self.triangle);
        let [a, b, c] = self.corners.map(|c| surface.position(c));
        let point = a * self.weights[0] + b * self.weights[1] + c * self.weights[2];
        let offset = at - point;
        (offset - self.offset).norm() <= MOTION_TOLERANCE * thickness
            && offset.norm() <= MAX_DISTANCE * thickness
            && is_above([a, b, c], at)
    }

    /// Returns the rest distance of a vertex from the point of its own body \[m\].
    pub(super) fn rest_distance(&self, surface: &Surface) -> f64 {
        let corners = self.corners.iter().zip(self.weights);
        let point: Vec3 = corners.map(|(&c, w)| surface.rest_position(c) * w).sum();
        (surface.rest_position(self.vertex) - point).norm()
    }
}

/// Returns whether a point projects into a triangle along its normal.
fn is_above([a, b, c]: [Vec3; 3], p: Vec3) -> bool {
    let normal = (b - a).cross(&(c - a));
    let is_inside = |from: Vec3, to: Vec3| normal.dot(&(to - from).cross(&(p - from))) >= 0.0;
    is_inside(a, b) && is_inside(b, c) && is_inside(c, a)
}

/// Returns the normal of a triangle with the length of twice its area [m^2].
pub(super) fn area_normal(surface: &Surface, t: TriangleId) -> Vec3 {
    area_vector(surface.triangle_positions(t))
}

/// Returns whether a vertex at `at` keeps its distance from the plane or the nearest point.
///
/// Both separate the two. The one is chosen that leaves more room after the relative `motion`
/// \[m\]: the direction from an edge would stop a vertex that slides past it, the triangle's
/// normal one that falls past it.
pub(super) fn contact_kind(
    surface: &Surface,
    at: Vec3,
    (found, is_behind): (&NearestPoint, bool),
    motion: Vec3,
) -> ContactKind {
    let normal = area_normal(surface, found.triangle);
    let normal = normal.try_normalize(0.0).unwrap_or_default();
    let side = if is_behind { -1.0 } else { 1.0 };
    let (normal, distance) = (normal * side, found.distance * side);
    let offset = at - found.point;
    // An offset of a few roundings has no direction.
    let extent = at.amax().max(found.point.amax());
    if distance <= 16.0 * f64::from(f32::EPSILON) * extent {
        return ContactKind::VertexFace;
    }
    let from_point = distance + (offset / distance).dot(&motion);
    if from_point >= normal.dot(&offset) + normal.dot(&motion) {
        ContactKind::VertexPoint
    } else {
        ContactKind::VertexFace
    }
}
