//! Bodies of stress cases on a GPU.

use super::error::StressError;
use incise_mesh::Surface;
use incise_pbd_gpu::{AdapterRequest, GpuBackend, GpuBody, Solver, SolverParams};
use incise_scene::{BackendChoice, BackendRequest};

/// An open GPU.
#[derive(Debug)]
pub(super) struct Device {
    gpu: GpuBackend,
    /// The request that opened it.
    request: AdapterRequest,
}

/// A body on the GPU.
pub(super) type Place = GpuBody;

impl Device {
    /// Opens the GPU of that name, or the best one; software if there is no other.
    ///
    /// # Errors
    /// [`StressError::Device`] with the reason.
    pub(super) fn open(adapter: Option<&str>) -> Result<Self, StressError> {
        let request = AdapterRequest::any(adapter.map(str::to_owned));
        let gpu = GpuBackend::new(&request)?;
        Ok(Self { gpu, request })
    }

    /// Returns the request of a scene for the same GPU.
    pub(super) fn backend(&self) -> BackendRequest {
        BackendRequest {
            choice: BackendChoice::Gpu,
            adapter: self.request.name.clone(),
            allow_software: true,
            min_gpu_constraints: None,
        }
    }

    /// Returns the adapter's name and driver.
    pub(super) fn describe(&self) -> String {
        let adapter = self.gpu.adapter();
        format!("{} ({})", adapter.name, adapter.driver)
    }

    pub(super) fn add(
        &mut self,
        surface: &Surface,
        solver: &mut Solver,
    ) -> Result<Place, StressError> {
        Ok(self.gpu.add(surface, solver)?)
    }

    pub(super) fn remove(&mut self, place: Place) {
        self.gpu.remove(place);
    }

    /// Steps without waiting.
    pub(super) fn step(
        &mut self,
        place: Place,
        solver: &mut Solver,
        dt: f32,
        params: &SolverParams,
    ) -> Result<(), StressError> {
        self.gpu.step([(place, solver)], dt, params)?;
        Ok(())
    }

    /// Uploads the edits of a body.
    pub(super) fn update(
        &mut self,
        place: Place,
        surface: &Surface,
        solver: &mut Solver,
    ) -> Result<(), StressError> {
        Ok(self.gpu.update(place, surface, solver)?)
    }

    /// Reads positions and velocities back.
    pub(super) fn read(
        &mut self,
        place: Place,
        surface: &mut Surface,
        solver: &mut Solver,
    ) -> Result<(), StressError> {
        Ok(self.gpu.read(place, surface, solver)?)
    }
}
