//! Bodies on a GPU.

use super::failure::Failure;
use super::stage::Way;
use incise_mesh::Surface;
use incise_pbd_gpu::{AdapterRequest, GpuBackend, GpuBody, Schedule, Solver, SolverParams};

/// An open GPU.
#[derive(Debug)]
pub(super) struct Device(GpuBackend);

/// A body on it.
pub(super) type Place = GpuBody;

impl Device {
    /// Opens the GPU of that name, else the best there is, software if there is nothing else.
    ///
    /// # Errors
    /// Why there is none.
    pub(super) fn open(adapter: Option<&str>) -> Result<Self, Failure> {
        let request = AdapterRequest {
            name: adapter.map(str::to_owned),
            allow_software: true,
            ..AdapterRequest::default()
        };
        Ok(Self(GpuBackend::new(&request)?))
    }

    /// The adapter's name and driver.
    pub(super) fn describe(&self) -> String {
        let adapter = self.0.adapter();
        format!("{} ({})", adapter.name, adapter.driver)
    }

    /// Takes one way for all bodies that can go it.
    pub(super) fn force(&mut self, way: Way) {
        self.0.force_schedule(match way {
            Way::Own => None,
            Way::WholeBody => Some(Schedule::WholeBody),
            Way::Colors => Some(Schedule::Colors),
            Way::Patches => Some(Schedule::Patches),
        });
    }

    /// Ends it, as a driver that is updated would.
    pub(super) fn lose(&self) {
        self.0.context().destroy();
    }

    pub(super) fn add(&mut self, surface: &Surface, solver: &mut Solver) -> Result<Place, Failure> {
        Ok(self.0.add(surface, solver)?)
    }

    pub(super) fn remove(&mut self, place: Place) {
        self.0.remove(place);
    }

    /// Steps without waiting.
    pub(super) fn step(
        &mut self,
        place: Place,
        solver: &mut Solver,
        dt: f32,
        params: &SolverParams,
    ) -> Result<(), Failure> {
        self.0.step([(place, solver)], dt, params)?;
        Ok(())
    }

    /// Sends what was edited on the host.
    pub(super) fn update(
        &mut self,
        place: Place,
        surface: &Surface,
        solver: &mut Solver,
    ) -> Result<(), Failure> {
        Ok(self.0.update(place, surface, solver)?)
    }

    /// Brings positions and velocities back.
    pub(super) fn read(
        &mut self,
        place: Place,
        surface: &mut Surface,
        solver: &mut Solver,
    ) -> Result<(), Failure> {
        Ok(self.0.read(place, surface, solver)?)
    }
}
