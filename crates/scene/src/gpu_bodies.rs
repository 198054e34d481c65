//! [`GpuBodies`]: the interface through which a scene uses a GPU, and how one is opened.
//!
//! The implementation is in `gpu_bodies/resident.rs`. A build without the feature `gpu` has none,
//! so that a scene there never holds a value of this trait.

#[cfg(feature = "gpu")]
mod resident;

use crate::backend::BackendRequest;
use crate::body::{Body, BodyId};
use crate::error::{FallbackReason, SceneError};
use crate::params::SceneParams;
use crate::residency::Residency;
use crate::scene::Bodies;
use crate::sleep::Sleep;
use crate::stats::FrameStats;
use incise_mesh::{Aabb, Surface};
use std::fmt;

#[cfg(feature = "gpu")]
pub(crate) use resident::ResidentBodies;

/// The bodies of a scene that a GPU steps, by the bodies' indices in the scene.
pub(crate) trait GpuBodies: fmt::Debug + Send + Sync {
    /// Returns the name of the adapter.
    fn adapter_name(&self) -> &str;

    /// Returns the minimum number of constraints of a body to be stepped here.
    fn min_constraints(&self) -> usize;

    /// Returns where the newest state of a body is.
    fn residency(&self, i: usize) -> Residency;

    /// Returns whether a body is in GPU memory.
    fn holds(&self, i: usize) -> bool {
        self.residency(i) != Residency::CpuOnly
    }

    /// Uploads a body if it is large enough and not here yet.
    fn add(&mut self, id: BodyId, body: &mut Body) -> Result<(), SceneError>;

    /// Frees the memory of a body.
    fn remove(&mut self, i: usize);

    /// Brings the CPU copy of a body up to date; returns whether it was out of date.
    fn read_back(&mut self, i: usize, body: &mut Body) -> Result<bool, SceneError>;

    /// Returns the bounding box of the GPU state; `None` if the CPU copy is to be measured.
    fn bounds(&mut self, i: usize) -> Result<Option<Aabb>, SceneError>;

    /// Requests that the next step copies the body's state back: a sweep is near.
    fn request_prefetch(&mut self, i: usize);

    /// Records that the CPU copy, which is up to date, was cut.
    fn record_cut(&mut self, i: usize);

    /// Records that the CPU copy, which is up to date, will be edited from outside.
    fn begin_edit(&mut self, i: usize, surface: &Surface);

    /// Uploads the edits and cuts of a body.
    fn upload_edits(&mut self, i: usize, body: &mut Body) -> Result<(), SceneError>;

    /// Submits a frame of all bodies here that are awake; returns before the GPU has finished.
    fn step(
        &mut self,
        bodies: &mut Bodies,
        params: &SceneParams,
        sleep: &mut Sleep,
        stats: &mut FrameStats,
    ) -> Result<(), SceneError>;

    /// Waits until the GPU has finished all submitted work.
    fn wait(&self) -> Result<(), SceneError>;

    /// Reads back everything that a GPU, which may have failed, still returns.
    fn save(&mut self, bodies: &mut Bodies);

    /// Returns the solver's GPU backend.
    #[cfg(feature = "gpu")]
    fn backend(&self) -> &incise_pbd_gpu::GpuBackend;

    /// Returns the solver's GPU backend.
    #[cfg(feature = "gpu")]
    fn backend_mut(&mut self) -> &mut incise_pbd_gpu::GpuBackend;

    /// Returns the handle of a body in [`GpuBodies::backend`].
    #[cfg(feature = "gpu")]
    fn handle(&self, i: usize) -> Option<incise_pbd_gpu::GpuBody>;
}

/// Opens the requested GPU.
#[cfg(feature = "gpu")]
pub(crate) fn open(request: &BackendRequest) -> Result<Box<dyn GpuBodies>, SceneError> {
    Ok(Box::new(ResidentBodies::open(request)?))
}

/// Opens a GPU that is faster than the CPU for some bodies.
#[cfg(feature = "gpu")]
pub(crate) fn open_if_faster(
    request: &BackendRequest,
    params: &SceneParams,
) -> Result<Box<dyn GpuBodies>, FallbackReason> {
    Ok(Box::new(ResidentBodies::open_if_faster(request, params)?))
}

/// Returns the error of a build without GPU support.
#[cfg(not(feature = "gpu"))]
pub(crate) fn open(_request: &BackendRequest) -> Result<Box<dyn GpuBodies>, SceneError> {
    Err(SceneError::NoGpuBackend)
}

/// Returns the reason of a build without GPU support.
#[cfg(not(feature = "gpu"))]
pub(crate) fn open_if_faster(
    _request: &BackendRequest,
    _params: &SceneParams,
) -> Result<Box<dyn GpuBodies>, FallbackReason> {
    Err(SceneError::NoGpuBackend.into())
}
