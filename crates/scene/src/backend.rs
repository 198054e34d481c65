//! Choice of CPU or GPU for a scene, its report, and the fallback from GPU to CPU.

use crate::body::BodyId;
use crate::error::{FallbackReason, SceneError};
use crate::gpu_bodies::{self, GpuBodies};
use crate::params::SceneParams;
use crate::scene::Scene;

/// The backend that steps bodies.
///
/// All three exist in every build; without the feature `gpu`, [`BackendChoice::Gpu`] is an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BackendChoice {
    /// The CPU.
    #[default]
    Cpu,
    /// A GPU, for all bodies. Its failures are errors of the scene.
    Gpu,
    /// A hardware GPU for bodies that it steps faster, the CPU for all others.
    ///
    /// The scene continues on the CPU after a GPU failure. The minimum size of a GPU body is
    /// measured when the scene is created, so a body near that size may run on the GPU in one
    /// process and on the CPU in the next. Each backend alone is deterministic; set
    /// [`BackendRequest::min_gpu_constraints`] to fix the choice too.
    Auto,
}

impl BackendChoice {
    /// Returns a name for tables and command lines.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Gpu => "gpu",
            Self::Auto => "auto",
        }
    }
}

/// The backend that a scene is to use.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct BackendRequest {
    /// CPU, GPU or both.
    pub choice: BackendChoice,
    /// A part of the adapter's name, in any case; `None` takes the first adapter.
    pub adapter: Option<String>,
    /// Whether [`BackendChoice::Gpu`] accepts an adapter that computes on the CPU.
    ///
    /// A named adapter is always accepted. [`BackendChoice::Auto`] never accepts one.
    pub allow_software: bool,
    /// For [`BackendChoice::Auto`]: minimum number of constraints of a GPU body.
    ///
    /// `None` measures it.
    pub min_gpu_constraints: Option<usize>,
}

/// The backend of a scene, and the reason if it is not the requested one.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct BackendReport {
    /// The requested backend.
    pub choice: BackendChoice,
    /// The name of the GPU, while the scene has one.
    pub adapter: Option<String>,
    /// Minimum number of constraints of a GPU body.
    pub min_gpu_constraints: Option<usize>,
    /// The bodies that the GPU steps, ascending. The CPU steps all others.
    pub gpu_bodies: Vec<BodyId>,
    /// The reason why the CPU steps bodies that the GPU was to step.
    pub fallback_reason: Option<FallbackReason>,
}

/// The requested backend and the last fallback.
#[derive(Debug, Default)]
pub(crate) struct BackendState {
    choice: BackendChoice,
    fallback_reason: Option<FallbackReason>,
    /// Whether the fallback is not in any frame's statistics yet.
    is_unreported: bool,
}

impl BackendState {
    fn record_fallback(&mut self, reason: FallbackReason) {
        self.fallback_reason = Some(reason);
        self.is_unreported = true;
    }

    /// Returns whether there was a fallback since the last call.
    pub(crate) fn take_fallback(&mut self) -> bool {
        std::mem::take(&mut self.is_unreported)
    }
}

impl Scene {
    /// Creates an empty scene on the requested backend.
    ///
    /// # Errors
    /// For [`BackendChoice::Gpu`]: there is no such GPU, or this build has no GPU backend. The
    /// other choices succeed; [`Scene::backend_report`] has the reason if [`BackendChoice::Auto`]
    /// uses the CPU.
    pub fn with_backend(params: SceneParams, request: &BackendRequest) -> Result<Self, SceneError> {
        let mut scene = Self::new(params);
        scene.backend.choice = request.choice;
        match request.choice {
            BackendChoice::Cpu => {}
            BackendChoice::Gpu => scene.gpu = Some(gpu_bodies::open(request)?),
            BackendChoice::Auto => match gpu_bodies::open_if_faster(request, &scene.params) {
                Ok(gpu) => scene.gpu = Some(gpu),
                Err(reason) => scene.backend.record_fallback(reason),
            },
        }
        Ok(scene)
    }

    /// Creates an empty scene on an open GPU, for example a renderer's.
    ///
    /// Any adapter is accepted. [`BackendChoice::Auto`] measures the minimum size of a GPU body
    /// and falls back on failure; [`BackendChoice::Cpu`] does not use the GPU.
    ///
    /// # Errors
    /// [`SceneError::Gpu`] when the first buffers cannot be created.
    #[cfg(feature = "gpu")]
    pub fn with_context(
        params: SceneParams,
        request: &BackendRequest,
        context: incise_pbd_gpu::Context,
    ) -> Result<Self, SceneError> {
        use crate::gpu_bodies::ResidentBodies;
        let mut scene = Self::new(params);
        scene.backend.choice = request.choice;
        match request.choice {
            BackendChoice::Cpu => {}
            BackendChoice::Gpu => {
                scene.gpu = Some(Box::new(ResidentBodies::with_context(context)?));
            }
            BackendChoice::Auto => {
                let gpu = ResidentBodies::with_context(context).map_err(FallbackReason::from);
                match gpu.and_then(|gpu| gpu.if_faster(request, &scene.params)) {
                    Ok(gpu) => scene.gpu = Some(Box::new(gpu)),
                    Err(reason) => scene.backend.record_fallback(reason),
                }
            }
        }
        Ok(scene)
    }

    /// Returns the backend of the scene, its GPU bodies and the reason of a fallback.
    #[must_use]
    pub fn backend_report(&self) -> BackendReport {
        let gpu = self.gpu.as_deref();
        BackendReport {
            choice: self.backend.choice,
            adapter: gpu.map(|gpu| gpu.adapter_name().to_owned()),
            min_gpu_constraints: gpu.map(GpuBodies::min_constraints),
            gpu_bodies: (0..self.bodies.len())
                .filter(|&i| gpu.is_some_and(|gpu| gpu.holds(i)))
                .map(|i| self.body_id(i))
                .collect(),
            fallback_reason: self.backend.fallback_reason.clone(),
        }
    }

    /// Returns the solver's GPU backend, for a renderer that draws from its buffers.
    #[cfg(feature = "gpu")]
    #[must_use]
    pub fn gpu(&self) -> Option<&incise_pbd_gpu::GpuBackend> {
        self.gpu.as_ref().map(|gpu| gpu.backend())
    }

    /// Returns the handle of a body in [`Scene::gpu`]; `None` for a CPU body.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`].
    #[cfg(feature = "gpu")]
    pub fn gpu_body(&self, id: BodyId) -> Result<Option<incise_pbd_gpu::GpuBody>, SceneError> {
        let i = self.index(id)?;
        Ok(self.gpu.as_ref().and_then(|gpu| gpu.handle(i)))
    }

    /// Forces one GPU schedule for all bodies, to compare schedules; `None` chooses per body.
    #[cfg(feature = "gpu")]
    pub fn force_schedule(&mut self, schedule: Option<incise_pbd_gpu::Schedule>) {
        if let Some(gpu) = &mut self.gpu {
            gpu.backend_mut().force_schedule(schedule);
        }
    }

    /// Moves all bodies to the CPU.
    ///
    /// They continue from their present state, or from the last readback if the GPU has failed.
    pub fn fall_back(&mut self) {
        self.leave_gpu(FallbackReason::Requested);
    }

    fn leave_gpu(&mut self, reason: FallbackReason) {
        if let Some(mut gpu) = self.gpu.take() {
            gpu.save(&mut self.bodies);
            // The last readback of a sleeping body may date from before it came to rest.
            self.sleep.wake_all();
            self.backend.record_fallback(reason);
        }
    }

    /// Handles a GPU error: [`BackendChoice::Auto`] falls back, all others return the error.
    ///
    /// Only `body` moves to the CPU if the GPU has no memory for it, else all bodies.
    pub(crate) fn recover(
        &mut self,
        body: Option<usize>,
        error: SceneError,
    ) -> Result<(), SceneError> {
        if self.backend.choice != BackendChoice::Auto || !error.is_gpu_failure() {
            return Err(error);
        }
        match (body, &mut self.gpu) {
            (Some(i), Some(gpu)) if error.is_out_of_gpu_memory() => {
                gpu.remove(i);
                self.sleep.wake(i);
                self.backend.record_fallback(error.into());
            }
            _ => self.leave_gpu(error.into()),
        }
        Ok(())
    }
}
