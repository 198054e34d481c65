//! Colliders of a [`Scene`]: wakes bodies when they change, passes each body those near it, with
//! their motion.

use crate::body::Body;
use crate::error::SceneError;
use crate::params::SceneParams;
use crate::scene::Scene;
use incise_mesh::Aabb;
use incise_pbd_gpu::MovingCollider;

impl Scene {
    /// Finds the motion of colliders since the previous frame.
    ///
    /// Wakes all bodies if one was added, removed or changed.
    pub(crate) fn begin_colliders(&mut self) {
        let (colliders, previous) = (&self.colliders, &mut self.previous_colliders);
        if colliders != previous {
            self.sleep.wake_all();
        }
        if previous.len() != colliders.len() {
            previous.clone_from(colliders);
        }
        let dt = self.params.dt;
        let pairs = previous.iter().zip(colliders);
        self.moving_colliders.clear();
        self.moving_colliders
            .extend(pairs.map(|(from, to)| MovingCollider::between(from, to, dt)));
        previous.clone_from(colliders);
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
            if !self.moving_colliders.is_empty() {
                let on_gpu = self.gpu.as_ref().is_some_and(|gpu| gpu.holds(i));
                let aabbs_computed = &mut self.stats.aabbs_computed;
                let reachable =
                    (!on_gpu).then(|| reachable_bounds(body, &self.params, aabbs_computed));
                let dt = self.params.dt;
                let is_near =
                    |c: &&MovingCollider| reachable.is_none_or(|r| c.bounds(dt).overlaps(&r));
                near.extend(self.moving_colliders.iter().filter(is_near).copied());
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
