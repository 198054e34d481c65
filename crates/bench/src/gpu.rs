//! The GPU of the benches `step` and `accuracy`; builds without the feature `gpu` have none.

#[cfg(feature = "gpu")]
use incise_pbd_gpu::{AdapterRequest, GpuBackend, GpuError};

/// An open GPU.
#[cfg(feature = "gpu")]
pub(crate) struct Device {
    request: AdapterRequest,
    pub(crate) gpu: GpuBackend,
}

#[cfg(feature = "gpu")]
impl Device {
    /// Opens the GPU of that name, or the best one; software if there is no other.
    ///
    /// # Errors
    /// [`GpuError`].
    pub(crate) fn open(adapter: Option<&str>) -> Result<Self, GpuError> {
        let request = AdapterRequest::any(adapter.map(str::to_owned));
        let gpu = GpuBackend::new(&request)?;
        Ok(Self { request, gpu })
    }

    /// Returns the name of the adapter.
    #[cfg(feature = "reference")]
    pub(crate) fn name(&self) -> String {
        self.gpu.adapter().name.clone()
    }

    /// Measures on the GPU. After an error the next measurement starts on a new device.
    ///
    /// # Errors
    /// The error of `run`.
    pub(crate) fn measure<T, E>(
        &mut self,
        run: impl FnOnce(&mut GpuBackend) -> Result<T, E>,
    ) -> Result<T, E> {
        let done = run(&mut self.gpu);
        if done.is_err()
            && let Ok(gpu) = GpuBackend::new(&self.request)
        {
            self.gpu = gpu;
        }
        done
    }
}

/// A GPU; this build has none.
#[cfg(not(feature = "gpu"))]
#[derive(Debug)]
pub(crate) enum Device {}

/// The error of opening a GPU in a build without support for it.
#[cfg(not(feature = "gpu"))]
#[derive(Debug, thiserror::Error)]
#[error("this build has no GPU support; build it with the feature gpu")]
pub(crate) struct NoGpu;

#[cfg(not(feature = "gpu"))]
impl Device {
    /// Opens no GPU.
    ///
    /// # Errors
    /// [`NoGpu`], always.
    pub(crate) fn open(_: Option<&str>) -> Result<Self, NoGpu> {
        Err(NoGpu)
    }

    #[cfg(feature = "reference")]
    pub(crate) fn name(&self) -> String {
        match *self {}
    }
}
