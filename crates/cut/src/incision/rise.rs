//! The rise of a sweep from the surface beside an end of the tip.

use super::columns::{Column, is_at_boundary};
use incise_mesh::geometry::area_vector;
use incise_mesh::{Surface, Vec3};

/// Maximum rise of the sweep from an end of a tip [distance to the next point of the sweep], and
/// its part towards the front of the sweep [distance to that].
///
/// Below a half, so that points between two parts of a tip keep their order, and below 1, so that
/// the sweep does not turn back.
const MAX_RISE: f64 = 0.3;

/// Returns the maximum rise of the sweep from a column in a direction \[m\], see [`MAX_RISE`].
///
/// `beyond` is the column next to it.
pub(super) fn max_rise(column: Column, beyond: Column, direction: Vec3) -> f64 {
    let front = (beyond.current - column.current).try_normalize(0.0);
    let front = front.unwrap_or_default();
    let motion = column.current - column.previous;
    let to_front = motion - front * front.dot(&motion);
    let forward = direction.dot(&to_front) / to_front.norm_squared();
    let room = (beyond.previous - column.previous).norm();
    MAX_RISE * room.min(1.0 / forward.max(0.0))
}

/// Returns the unit vector half way between the blade and the direction away from the surface at a
/// column, in the plane of the sweep there.
///
/// Straight away from a surface that faces the motion, the sweep would turn back. `along` is the
/// direction of the blade towards the column, `to` the column's next position \[m\]. A sheet has
/// two sides: there the vector is on that from which the blade comes.
pub(super) fn outward(surface: &Surface, column: Column, along: Vec3, to: Vec3) -> Vec3 {
    let fan = surface.topology().outgoing_fan(column.vertex);
    let normals = fan.map(|h| area_vector(surface.triangle_positions(h.triangle())));
    let normal: Vec3 = normals.sum();
    let is_reversed = is_at_boundary(surface, column.vertex) && normal.dot(&along) > 0.0;
    let normal = if is_reversed { -normal } else { normal };
    let across = along.cross(&(to - column.previous));
    let across = across.try_normalize(0.0).unwrap_or_default();
    let in_plane = normal - across * across.dot(&normal);
    let beyond = in_plane.try_normalize(0.0).unwrap_or_default()
        - along.try_normalize(0.0).unwrap_or_default();
    beyond.try_normalize(0.0).unwrap_or_default()
}
