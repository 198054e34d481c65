//! Inside test for a sweep that hits nothing.

use crate::sweep::Sweep;
use incise_mesh::Surface;
use incise_mesh::geometry::to_f64;

/// Returns whether the sweep's first corner is inside a body of the surface. O(n).
///
/// A sweep that hits no triangle then lies inside the body as a whole, which [`crate::Cutter::cut`]
/// reports as a miss: this test takes longer than the cut. The corner is inside if the solid angle
/// of the bodies is more than half of the full one (van Oosterom and Strackee 1983).
#[must_use]
pub fn blade_starts_inside(surface: &Surface, sweep: &Sweep) -> bool {
    is_in_body(surface, &surface.open_pieces(), sweep.points()[0])
}

/// Returns whether a point is inside a piece that is not marked in `is_sheet`.
pub(crate) fn is_in_body(surface: &Surface, is_sheet: &[bool], point: [f32; 3]) -> bool {
    let at = to_f64(point);
    let triangles = surface.topology().triangles();
    let angle: f64 = triangles
        .filter(|&t| is_sheet.get(surface.piece(t) as usize) != Some(&true))
        .map(|t| {
            let [a, b, c] = surface.triangle_positions(t).map(|p| p - at);
            let [la, lb, lc] = [a, b, c].map(|p| p.norm());
            let volume = a.dot(&b.cross(&c));
            let scale = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
            2.0 * volume.atan2(scale)
        })
        .sum();
    angle.abs() > std::f64::consts::TAU
}
