//! Which colliders a body has to do with.

use crate::body::Body;
use crate::error::SceneError;
use crate::scene::Scene;
use incise_mesh::Aabb;
use incise_pbd_gpu::Collider;

impl Scene {
    /// Wakes bodies for colliders that are others than in the frame before: who lies on one that goes has to fall.
    pub(crate) fn wake_at_colliders(&mut self) {
        if self.colliders != self.known_colliders {
            self.known_colliders.clone_from(&self.colliders);
            self.sleep.wake_all();
        }
    }

    /// Gives every body that is awake its colliders.
    pub(crate) fn hand_out_colliders(&mut self) -> Result<(), SceneError> {
        let near = &mut self.near_colliders;
        for (i, body) in self.bodies.iter_mut().enumerate() {
            let Some(body) = body else { continue };
            if self.sleep.is_asleep(i) {
                continue;
            }
            near.clear();
            if !self.colliders.is_empty() {
                let on_device = self.device.as_ref().is_some_and(|d| d.holds(i));
                // Where a body on a device is nobody knows here.
                let reach = (!on_device).then(|| reach(body, &self.params, &mut self.stats.boxes));
                let comes_to = |c: &&Collider| reach.is_none_or(|r| c.bounds().overlaps(&r));
                near.extend(self.colliders.iter().filter(comes_to).copied());
            }
            self.stats.colliders += near.len();
            body.parts().1.set_colliders(near)?;
        }
        Ok(())
    }
}

/// The box that a body may get to within a frame, if nothing makes any of it more than twice as fast as it is.
#[expect(
    clippy::cast_possible_truncation,
    reason = "a box may be a rounding too small, as it is grown by far more than moves"
)]
fn reach(body: &mut Body, params: &crate::SceneParams, boxes: &mut u32) -> Aabb {
    let mut bounds = body.bounds(boxes);
    let squares = body.solver().velocities().iter().map(|v| v.map(f64::from));
    let fastest = squares
        .map(|[x, y, z, _]| x * x + y * y + z * z)
        .fold(0.0, f64::max)
        .sqrt();
    let gravity = params.solver.gravity.map(f64::from);
    let pull = gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
    let dt = f64::from(params.dt);
    let by = 2.0 * (fastest + pull * dt) * dt;
    for k in 0..3 {
        bounds.min[k] = (f64::from(bounds.min[k]) - by) as f32;
        bounds.max[k] = (f64::from(bounds.max[k]) + by) as f32;
    }
    bounds
}
