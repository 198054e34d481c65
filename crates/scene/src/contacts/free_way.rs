//! [`free_way`]: how far a box may move before it enters a collider.

use super::ContactFrame;
use incise_mesh::geometry::to_f32;
use incise_mesh::{Aabb, Vec3};
use incise_pbd_gpu::Collider;

/// Returns the part of a displacement on which a box enters no obstacle \[m\].
///
/// The box has a minimum and a maximum corner. It slides along planes, and stops in front of
/// others. If it is in one already, it may move, but not deeper into a plane.
pub(super) fn free_way(corners: [Vec3; 2], by: Vec3, frame: &ContactFrame<'_>) -> Vec3 {
    let [min, max] = corners;
    let mut free = by;
    for (point, normal) in frame.planes() {
        let lowest = min.zip_zip_map(&max, &normal, |a, b, n| if n > 0.0 { a } else { b });
        let room = normal.dot(&(lowest - point)).max(0.0);
        let sunk = -room - normal.dot(&free);
        if sunk > 0.0 {
            free += normal * sunk;
        }
    }
    let boxed = |by: Vec3| Aabb::around([to_f32(min + by), to_f32(max + by)]);
    let enters = frame.colliders.iter().any(|collider| {
        let bounds = collider.start.bounds();
        let is_plane = matches!(collider.start, Collider::Plane { .. });
        !is_plane && boxed(free).overlaps(&bounds) && !boxed(Vec3::zeros()).overlaps(&bounds)
    });
    if enters { Vec3::zeros() } else { free }
}
