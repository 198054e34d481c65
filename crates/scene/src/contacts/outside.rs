//! Sides of triangles on which a vertex may touch them.
//!
//! A fast vertex in front of a triangle touches it whatever its own normal is, which may point
//! anywhere in a crushed piece. A slow vertex, and one slightly behind, must be faced by it.

use super::persistent::area_normal;
use incise_mesh::{NearestPoint, Surface, TriangleId, Vec3, VertexId};

/// Returns the sum of the area normals of the triangles around a vertex [m^2].
pub(super) fn outward_normal(surface: &Surface, v: VertexId) -> Vec3 {
    let fan = surface.topology().outgoing_fan(v);
    fan.map(|h| area_normal(surface, h.triangle())).sum()
}

/// Returns whether a triangle faces a vertex with an outward normal.
pub(super) fn faces(surface: &Surface, outward: Vec3, t: TriangleId) -> bool {
    outward.dot(&area_normal(surface, t)) < 0.0
}

/// A vertex that may touch a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touching {
    /// Position \[m\].
    pub(super) at: Vec3,
    /// Outward normal, of any length.
    pub(super) outward: Vec3,
    /// Whether the triangle must face the vertex, also one that the vertex is in front of.
    pub(super) must_be_faced: bool,
    /// Maximum depth behind a triangle that faces the vertex \[m\].
    pub(super) max_depth: f64,
}

/// Returns whether a vertex is in front of a triangle, or slightly behind one that faces it.
pub(super) fn is_outside(surface: &Surface, t: TriangleId, vertex: Touching) -> bool {
    let [a, ..] = surface.triangle_positions(t);
    let normal = area_normal(surface, t);
    let height = normal.dot(&(vertex.at - a));
    let is_faced = vertex.outward.dot(&normal) < 0.0;
    if height > 0.0 {
        is_faced || !vertex.must_be_faced
    } else {
        is_faced && height.powi(2) <= vertex.max_depth.powi(2) * normal.norm_squared()
    }
}

/// Reassigns a nearest point on the border of an accepted triangle to that triangle.
///
/// Beside the rim of a cap, only the cap carries a vertex above it; the skin would let it pass. The
/// distance keeps its sign, since a vertex in front of either of them is outside.
pub(super) fn shared_by(
    surface: &Surface,
    mut found: NearestPoint,
    counts: impl Fn(TriangleId) -> bool,
) -> NearestPoint {
    let topology = surface.topology();
    let corners = topology.triangle(found.triangle);
    let used = found.weights.iter().filter(|&&w| w > 0.0).count();
    let first = found.weights.iter().position(|&w| w > 0.0);
    let Some(first) = first.filter(|_| used < 3 && !counts(found.triangle)) else {
        return found;
    };
    for h in topology.outgoing_fan(corners[first]) {
        let weights = topology.triangle(h.triangle()).map(|v| {
            let corner = corners.iter().position(|&c| c == v);
            corner.map_or(0.0, |k| found.weights[k])
        });
        let has_point = weights.iter().filter(|&&w| w > 0.0).count() == used;
        if has_point && counts(h.triangle()) {
            (found.triangle, found.weights) = (h.triangle(), weights);
            break;
        }
    }
    found
}
