//! Rest values, from rest positions. The order of the vertices is canonical, so the same edge always
//! gets the same bits.

use incise_mesh::geometry::{Vec3, area_vector};
use incise_mesh::{EdgeKey, Surface, VertexId};

/// The rest length of an edge \[m\].
#[expect(
    clippy::cast_possible_truncation,
    reason = "a computed length is rounded once to storage"
)]
pub(crate) fn length(surface: &Surface, edge: EdgeKey) -> f32 {
    let [a, b] = edge.vertices().map(|v| surface.rest_position(v));
    (b - a).norm() as f32
}

/// The signed angle between the normals at an edge \[rad\], vertices as in
/// [`BendingSet`](crate::BendingSet): 0 is flat, positive is convex.
#[expect(
    clippy::cast_possible_truncation,
    reason = "a computed angle is rounded once to storage"
)]
pub(crate) fn angle(surface: &Surface, vertices: [VertexId; 4]) -> f32 {
    dihedral(vertices.map(|v| surface.rest_position(v))) as f32
}

/// The signed angle at the edge from the first to the second point \[rad\].
pub(crate) fn dihedral([p0, p1, p2, p3]: [Vec3; 4]) -> f64 {
    let e = p1 - p0;
    let first = area_vector([p0, p1, p2]);
    let second = area_vector([p0, p3, p1]);
    (-e.norm() * (p2 - p0).dot(&second)).atan2(first.dot(&second))
}
