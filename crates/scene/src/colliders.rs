//! Colliders of a [`Scene`]: wakes bodies when they change, passes each body those near it.

use crate::body::Body;
use crate::error::SceneError;
use crate::params::SceneParams;
use crate::scene::Scene;
use incise_mesh::Aabb;
use incise_pbd_gpu::Collider;

impl Scene {
    /// Wakes all bodies if a collider was added, removed or changed since the previous frame.
    pub(crate) fn wake_at_colliders(&mut self) {
        if self.colliders != self.previous_colliders {
            self.previous_colliders.clone_from(&self.colliders);
            self.sleep.wake_all();
        }
    }

    /// Passes every awake body the colliders that it may reach within the frame.
    ///
    /// GPU bodies get all of them, since the CPU does not have their positions.
    pub(crate) fn assign_colliders(&mut self) -> Result<(), SceneError> {
        let near = &mut self.near_colliders;
        for (i, body) in self.bodies.iter_mut().enumerate() {
            let Some(body) = body else { continue };
            if self.sleep.is_asleep(i) {
                continue;
            }
            near.clear();
            if !self.colliders.is_empty() {
                let on_gpu = self.gpu.as_ref().is_some_and(|gpu| gpu.holds(i));
                let aabbs_computed = &mut self.stats.aabbs_computed;
                let reachable =
                    (!on_gpu).then(|| reachable_bounds(body, &self.params, aabbs_computed));
                let is_near = |c: &&Collider| reachable.is_none_or(|r| c.bounds().overlaps(&r));
                near.extend(self.colliders.iter().filter(is_near).copied());
            }
            self.stats.collider_pairs += near.len();
            body.parts().1.set_colliders(near)?;
        }
        Ok(())
    }
}

/// Returns a box that the body does not leave in a frame unless its speed more than doubles.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the box is grown by much more than the rounding of its corners"
)]
fn reachable_bounds(body: &mut Body, params: &SceneParams, aabbs_computed: &mut u32) -> Aabb {
    let mut bounds = body.bounds(aabbs_computed);
    let velocities = body.solver().velocities().iter().map(|v| v.map(f64::from));
    let max_speed = velocities
        .map(|[x, y, z, _]| x * x + y * y + z * z)
        .fold(0.0, f64::max)
        .sqrt();
    let gravity = params.solver.gravity.map(f64::from);
    let gravity = gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
    let dt = f64::from(params.dt);
    let by = 2.0 * (max_speed + gravity * dt) * dt;
    for k in 0..3 {
        bounds.min[k] = (f64::from(bounds.min[k]) - by) as f32;
        bounds.max[k] = (f64::from(bounds.max[k]) + by) as f32;
    }
    bounds
}
