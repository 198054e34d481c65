//! [`Obstacles`]: colliders, and whether a body may touch them within a frame.

use crate::constraints::colliders::ColliderRecord;
use crate::kernels::colliders::separation;
use incise_mesh::Surface;

/// Distance of obstacles within which a body counts as touching them [expected motions].
///
/// Elastic forces may move vertices faster than their velocity and gravity do.
const MARGIN: f32 = 2.0;

/// The obstacles of a body in a frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Obstacles<'a> {
    pub(crate) colliders: &'a [ColliderRecord],
    pub(crate) gravity: [f32; 3],
}

impl Obstacles<'_> {
    /// Returns whether a movable vertex may touch an obstacle within a frame of `dt` \[s\].
    ///
    /// `edge` is the mean length of edges \[m\], by which elastic forces may move vertices besides.
    /// O(vertices and colliders).
    pub(crate) fn may_touch(
        &self,
        (surface, velocities): (&Surface, &[[f32; 4]]),
        dt: f32,
        edge: f64,
    ) -> bool {
        let fall = norm(self.gravity) * dt;
        let mut vertices = surface.positions().iter().zip(velocities);
        vertices.any(|(&[x, y, z, inverse_mass], &[vx, vy, vz, _])| {
            let is_near = |distance: f32, velocity: [f32; 3]| {
                let motion = MARGIN * (norm(velocity) + fall) * dt;
                f64::from(distance) < f64::from(motion) + edge
            };
            inverse_mass > 0.0
                && self.colliders.iter().any(|collider| {
                    let along = collider.velocity;
                    let from = collider.origin;
                    let q = [x - from[0], y - from[1], z - from[2]];
                    let (distance, _) = separation(q, [0.0; 3], collider);
                    is_near(distance, [vx - along[0], vy - along[1], vz - along[2]])
                })
        })
    }
}

fn norm(a: [f32; 3]) -> f32 {
    (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]).sqrt()
}
