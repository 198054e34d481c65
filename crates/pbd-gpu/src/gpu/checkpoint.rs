//! States that come to the host by the way: nobody waits for them.

use super::backend::{GpuBackend, GpuBody};
use super::error::GpuError;
use crate::solver::Solver;
use incise_mesh::Surface;

impl GpuBackend {
    /// Takes over the state that an earlier [`GpuBackend::prefetch`] had copied, if it has arrived, and
    /// waits for nothing. The host's copy is then as old as that state, and still behind the device.
    ///
    /// Returns whether nothing is on its way any more. A state that is older than the host's copy, or
    /// than the last [`GpuBackend::update`], is dropped. Velocities and pins that were set on
    /// the host and not been sent are kept.
    ///
    /// # Errors
    /// As [`GpuBackend::read`]. What has arrived is handed out even if the device is gone.
    pub fn collect(
        &mut self,
        body: GpuBody,
        surface: &mut Surface,
        solver: &mut Solver,
    ) -> Result<bool, GpuError> {
        let resident = self.resident_mut(body)?;
        match resident.state.frame() {
            None => return Ok(true),
            Some(frame) if frame <= resident.host => {
                resident.state.forget();
                return Ok(true);
            }
            Some(_) => {}
        }
        if !solver.is_followed_by(resident.follower) {
            return Err(GpuError::ForeignSolver);
        }
        if solver.changes_concern_surface() {
            return Err(GpuError::StaleBody);
        }
        if !resident.state.has_arrived() {
            self.context.poll_once()?;
        }
        if !self.resident(body)?.state.has_arrived() {
            return Ok(false);
        }
        let set = solver.velocities_set();
        self.take_state(body, surface, solver)?;
        for (v, velocity) in set {
            solver.velocities[v] = velocity;
        }
        Ok(true)
    }
}
