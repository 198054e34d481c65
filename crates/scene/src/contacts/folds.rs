//! Contacts within a piece: they touch from outside, not through the piece.
//!
//! Where a piece is thin, crushed or turned inside out, its sides face each other like those of a
//! fold. A contact would pull one through the other and hold it there. A
//! winding number of 0 or 2 halfway between the two means contact from outside: of separate sides,
//! or of the layers of a fold.

use super::persistent::PersistentContact;
use crate::body::Body;
use incise_mesh::Vec3;
use incise_mesh::geometry::area_vector;

/// Distance of features that coincide [thicknesses]: nothing is between them.
const COINCIDENT: f64 = 0.02;

/// Fraction of the way to a triangle's center: at a rim, the point behind it is in the piece.
const INWARD: f64 = 0.05;

/// Returns whether a vertex at `at` touches a triangle of its own closed piece from outside.
///
/// The body's BVH must be fitted.
pub(super) fn is_from_outside(
    body: &Body,
    (contact, at): (&PersistentContact, Vec3),
    thickness: f64,
) -> bool {
    let (surface, t) = (body.surface(), contact.triangle);
    let piece = surface.piece(t);
    let shape = body.piece_shapes().get(piece);
    if shape.is_sheet {
        return true;
    }
    // In a cavity, the space that the wall does not enclose counts -1.
    let outside = if shape.is_cavity { -1 } else { 0 };
    let is_own = |t| surface.piece(t) == piece;
    let enclosures = |point| body.bvh().winding_number(surface, point, is_own);
    let corners = surface.triangle_positions(t);
    let normal = area_vector(corners);
    let near = COINCIDENT * thickness;
    if contact.offset.norm() > near {
        let is_in_front = normal.dot(&contact.offset) > 0.0;
        let between = at - contact.offset / 2.0;
        let layers = enclosures(between) - outside;
        return layers == if is_in_front { 0 } else { 2 };
    }
    let Some(normal) = normal.try_normalize(0.0) else {
        return false;
    };
    let center = (corners[0] + corners[1] + corners[2]) / 3.0;
    let point = at - contact.offset;
    let behind = point + (center - point) * INWARD - normal * near;
    enclosures(behind) > outside
}
