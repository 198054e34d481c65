//! Asynchronous readback: collects a prefetched state without waiting.

use super::backend::{GpuBackend, GpuBody};
use super::error::GpuError;
use crate::solver::Solver;
use incise_mesh::Surface;

impl GpuBackend {
    /// Applies a state that [`GpuBackend::prefetch`] requested, if its copy is complete.
    ///
    /// The CPU copy then has the age of that state. Returns true if no copy is pending. A state
    /// older than the CPU copy or than the last [`GpuBackend::update`] is discarded. Velocities and
    /// pins that were set on the CPU side and not uploaded are kept, and so are contacts that were
    /// set since.
    ///
    /// # Errors
    /// As [`GpuBackend::read`]. A complete copy is applied even if the device is lost.
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
        if solver.has_surface_changes() {
            return Err(GpuError::StaleBody);
        }
        if !resident.state.has_arrived() {
            self.context.poll_once()?;
        }
        if !self.resident(body)?.state.has_arrived() {
            return Ok(false);
        }
        let set = solver.changed_velocities();
        self.take_state(body, surface, solver)?;
        for (v, velocity) in set {
            solver.particles_mut().velocities[v] = velocity;
        }
        Ok(true)
    }
}
