//! The side on which a vertex touches a sheet, which has no inside.
//!
//! [`super::narrow_phase`] asks for it once a triangle of a sheet is nearest to a vertex.

use super::persistent::PersistentContact;
use incise_mesh::geometry::area_vector;
use incise_mesh::{NearestPoint, Surface, TriangleId, Vec3};

/// Maximum sine of the direction from the boundary of a sheet to a vertex beside it.
const MAX_SINE: f64 = 0.5;

/// Minimum and maximum distances of a vertex that decide its side \[m\].
#[derive(Debug, Clone, Copy)]
pub(super) struct SideLimits {
    /// Minimum distance of a vertex without a previous contact.
    pub(super) apart: f64,
    /// Maximum depth of a vertex that has passed the sheet.
    pub(super) max_depth: f64,
}

/// Returns whether a vertex is behind the sheet whose triangle is nearest to it.
///
/// A vertex stays on the side of its previous contact, provided that it is not too deep and that
/// both triangles have the same orientation: a fold has others nearby. Returns `None` for a vertex
/// beside the boundary, and for a new one that is not yet apart.
pub(super) fn is_behind(
    surface: &Surface,
    (at, found): (Vec3, &NearestPoint),
    previous: Option<&PersistentContact>,
    limits: SideLimits,
) -> Option<bool> {
    let distance = found.distance.abs();
    let normal = |t: TriangleId| area_vector(surface.triangle_positions(t));
    let upward = normal(found.triangle).try_normalize(0.0)?;
    let height = upward.dot(&(at - found.point));
    let is_on_boundary = is_on_boundary(surface, found);
    if is_on_boundary && height.abs() <= MAX_SINE * distance {
        return None;
    }
    let (topology, t) = (surface.topology(), found.triangle);
    let is_same_layer = |previous: &&PersistentContact| {
        topology.is_triangle(previous.triangle)
            && surface.piece(previous.triangle) == surface.piece(t)
            && normal(previous.triangle).dot(&upward) > 0.0
    };
    match previous.filter(is_same_layer) {
        Some(previous) if distance <= limits.max_depth && !is_on_boundary => {
            Some(previous.is_behind)
        }
        None if distance < limits.apart => None,
        _ => Some(height < 0.0),
    }
}

/// Returns whether the nearest point is on the boundary of a sheet, where its sides meet.
fn is_on_boundary(surface: &Surface, found: &NearestPoint) -> bool {
    // The first half-edge is opposite to the third corner.
    let mut edges = found.triangle.half_edges().into_iter().zip([2, 0, 1]);
    edges
        .any(|(h, opposite)| surface.topology().twin(h).is_null() && found.weights[opposite] == 0.0)
}
