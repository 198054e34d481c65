//! Bodies on a GPU.

use super::failure::Failure;
use super::stage::Way;
use incise_mesh::Surface;
use incise_pbd_gpu::{AdapterRequest, GpuBackend, GpuBody, Schedule, Solver, SolverParams};
use incise_scene::{BackendChoice, BackendRequest};

/// An open GPU.
#[derive(Debug)]
pub(super) struct Device {
    gpu: GpuBackend,
    /// What it was opened for.
    request: AdapterRequest,
}

/// A body on it.
pub(super) type Place = GpuBody;

impl Device {
    /// Opens the GPU of that name, else the best there is, software if there is nothing else.
    ///
    /// # Errors
    /// Why there is none.
    pub(super) fn open(adapter: Option<&str>) -> Result<Self, Failure> {
        let request = AdapterRequest::any(adapter.map(str::to_owned));
        Self::of(request)
    }

    /// Opens the same GPU once more.
    ///
    /// # Errors
    /// As [`Device::open`].
    pub(super) fn again(&self) -> Result<Self, Failure> {
        Self::of(self.request.clone())
    }

    /// Opens the same GPU once more, with the limits of any WebGPU device.
    ///
    /// # Errors
    /// As [`Device::open`].
    pub(super) fn portable(&self) -> Result<Self, Failure> {
        Self::of(AdapterRequest {
            portable_limits: true,
            ..self.request.clone()
        })
    }

    fn of(request: AdapterRequest) -> Result<Self, Failure> {
        let gpu = GpuBackend::new(&request)?;
        Ok(Self { gpu, request })
    }

    /// What opens it for a scene.
    pub(super) fn backend(&self) -> BackendRequest {
        BackendRequest {
            choice: BackendChoice::Gpu,
            adapter: self.request.name.clone(),
            allow_software: true,
            device_from: None,
        }
    }

    /// The bytes that bodies have room for before buffers are replaced by larger ones.
    pub(super) fn reserved(&self) -> u64 {
        self.gpu.memory().reserved
    }

    /// The adapter's name and driver.
    pub(super) fn describe(&self) -> String {
        let adapter = self.gpu.adapter();
        format!("{} ({})", adapter.name, adapter.driver)
    }

    /// Takes one way for all bodies that can go it.
    pub(super) fn force(&mut self, way: Way) {
        self.gpu.force_schedule(match way {
            Way::Own => None,
            Way::WholeBody => Some(Schedule::WholeBody),
            Way::Colors => Some(Schedule::Colors),
            Way::Patches => Some(Schedule::Patches),
        });
    }

    /// Ends it, as a driver that is updated would.
    pub(super) fn lose(&self) {
        self.gpu.context().destroy();
    }

    pub(super) fn add(&mut self, surface: &Surface, solver: &mut Solver) -> Result<Place, Failure> {
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
    ) -> Result<(), Failure> {
        self.gpu.step([(place, solver)], dt, params)?;
        Ok(())
    }

    /// Sends what was edited on the host.
    pub(super) fn update(
        &mut self,
        place: Place,
        surface: &Surface,
        solver: &mut Solver,
    ) -> Result<(), Failure> {
        Ok(self.gpu.update(place, surface, solver)?)
    }

    /// Brings positions and velocities back.
    pub(super) fn read(
        &mut self,
        place: Place,
        surface: &mut Surface,
        solver: &mut Solver,
    ) -> Result<(), Failure> {
        Ok(self.gpu.read(place, surface, solver)?)
    }
}
