//! Whether a sweep begins inside the body.

use crate::sweep::Sweep;
use incise_mesh::Surface;
use incise_mesh::geometry::widen;

/// Whether the sweep's first corner is inside the surface: whether the solid angle under which it sees
/// the surface is nearer to the full one than to nothing (van Oosterom and Strackee 1983). O(n).
///
/// A sweep that hits no triangle lies inside the body as a whole then. [`crate::Cutter::cut`] takes it
/// for a miss: to look at every triangle would cost a frame more than the cut. Who cuts once can ask.
#[must_use]
pub fn starts_inside(surface: &Surface, sweep: &Sweep) -> bool {
    let at = widen(sweep.corners()[0]);
    let angle: f64 = surface
        .topology()
        .triangles()
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
