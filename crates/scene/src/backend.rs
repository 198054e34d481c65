//! What executes a scene: the processor, a device, or whichever is faster.

use crate::body::BodyId;
use crate::device::Device;
use crate::error::SceneError;
use crate::params::SceneParams;
use crate::scene::Scene;

/// What executes the solver. All three exist in every build; without the feature `gpu` only
/// [`BackendChoice::Gpu`] cannot be had.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BackendChoice {
    /// The processor.
    #[default]
    Cpu,
    /// A device, for all bodies. What goes wrong with it is an error of the scene.
    Gpu,
    /// A device for bodies that it steps faster, if there is a real one; the processor for all others,
    /// and for all as soon as anything goes wrong with the device.
    ///
    /// How large a body must be is measured when the scene is made, so a body near that size may be
    /// stepped by the device in one run and by the processor in the next. Each of them by itself gives
    /// the same bits in every run; set [`BackendRequest::device_from`] to have the choice fixed too.
    Auto,
}

impl BackendChoice {
    /// A name for tables and command lines.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Gpu => "gpu",
            Self::Auto => "auto",
        }
    }
}

/// Which backend a scene is to have.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct BackendRequest {
    /// What executes the solver.
    pub choice: BackendChoice,
    /// A part of the adapter's name in any case, if it is to be a certain one.
    pub adapter: Option<String>,
    /// Whether [`BackendChoice::Gpu`] takes an adapter that computes on the processor if there is no
    /// other. One that is named is taken in any case. [`BackendChoice::Auto`] never takes one.
    pub allow_software: bool,
    /// For [`BackendChoice::Auto`]: how many constraints a body must have to be stepped by the device.
    /// `None` measures it.
    pub device_from: Option<usize>,
}

/// What executes a scene, and why.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct BackendReport {
    /// What was asked for.
    pub choice: BackendChoice,
    /// The name of the device, while the scene has one.
    pub device: Option<String>,
    /// How many constraints a body must have to be stepped by the device.
    pub device_from: Option<usize>,
    /// The bodies that live on the device, ascending. All others are stepped by the processor.
    pub on_device: Vec<BodyId>,
    /// Why bodies are stepped by the processor that should have been by a device: no device, none
    /// that is faster, no room on it, or its end.
    pub fallback: Option<String>,
}

/// What a scene remembers of its backend.
#[derive(Debug, Default)]
pub(crate) struct BackendState {
    choice: BackendChoice,
    fallback: Option<String>,
    /// Whether nobody was told of the fallback so far.
    is_news: bool,
}

impl BackendState {
    fn note(&mut self, why: String) {
        self.fallback = Some(why);
        self.is_news = true;
    }

    /// Whether something happened that has not been told; it is told now.
    pub(crate) fn take_news(&mut self) -> bool {
        std::mem::take(&mut self.is_news)
    }
}

impl Scene {
    /// An empty scene on the backend that is asked for.
    ///
    /// # Errors
    /// For [`BackendChoice::Gpu`] that there is no such device, or that this build has no device backend.
    /// For the others none: [`Scene::backend_report`] tells if [`BackendChoice::Auto`] found no device.
    pub fn with_backend(params: SceneParams, request: &BackendRequest) -> Result<Self, SceneError> {
        let mut scene = Self::new(params);
        scene.backend.choice = request.choice;
        match request.choice {
            BackendChoice::Cpu => {}
            BackendChoice::Gpu => scene.device = Some(Device::open(request)?),
            BackendChoice::Auto => match Device::open_faster(request, &scene.params) {
                Ok(device) => scene.device = Some(device),
                Err(why) => scene.backend.note(why),
            },
        }
        Ok(scene)
    }

    /// An empty scene on a device that is open already, a renderer's say. It is taken whatever it is, and
    /// `request` says of it what it says of one that is looked for: for [`BackendChoice::Auto`] from
    /// which size on, and that the scene goes on without it. With [`BackendChoice::Cpu`] it is not used.
    ///
    /// # Errors
    /// [`SceneError::Gpu`] when the device refuses the first buffers.
    #[cfg(feature = "gpu")]
    pub fn with_context(
        params: SceneParams,
        request: &BackendRequest,
        context: incise_pbd_gpu::Context,
    ) -> Result<Self, SceneError> {
        let mut scene = Self::new(params);
        scene.backend.choice = request.choice;
        match request.choice {
            BackendChoice::Cpu => {}
            BackendChoice::Gpu => scene.device = Some(Device::on(context)?),
            BackendChoice::Auto => match Device::on(context).map_err(|error| error.to_string()) {
                Ok(device) => match device.if_faster(request, &scene.params) {
                    Ok(device) => scene.device = Some(device),
                    Err(why) => scene.backend.note(why),
                },
                Err(why) => scene.backend.note(why),
            },
        }
        Ok(scene)
    }

    /// What executes the scene: which device, which bodies are on it, and why others are not.
    #[must_use]
    pub fn backend_report(&self) -> BackendReport {
        let device = self.device.as_ref();
        let on_device = |i: &usize| device.is_some_and(|d| d.holds(*i));
        BackendReport {
            choice: self.backend.choice,
            device: device.map(|d| d.name().to_owned()),
            device_from: device.map(Device::takes_from),
            on_device: (0..self.bodies.len())
                .filter(on_device)
                .map(BodyId)
                .collect(),
            fallback: self.backend.fallback.clone(),
        }
    }

    /// The device backend, for a renderer that draws from its buffers, while the scene has one.
    #[cfg(feature = "gpu")]
    #[must_use]
    pub fn gpu(&self) -> Option<&incise_pbd_gpu::GpuBackend> {
        self.device.as_ref().map(Device::gpu)
    }

    /// A body's name in [`Scene::gpu`], if it lives there.
    #[cfg(feature = "gpu")]
    #[must_use]
    pub fn gpu_body(&self, id: BodyId) -> Option<incise_pbd_gpu::GpuBody> {
        self.device.as_ref()?.handle(id.0)
    }

    /// Asks the device for one schedule for all bodies, to compare schedules. `None` leaves the choice
    /// to the device again.
    #[cfg(feature = "gpu")]
    pub fn force_schedule(&mut self, schedule: Option<incise_pbd_gpu::Schedule>) {
        if let Some(device) = &mut self.device {
            device.gpu_mut().force_schedule(schedule);
        }
    }

    /// Leaves the device and goes on with the processor: from the bodies' present state as far as the
    /// device still hands it out, else from where the host's copies are.
    pub fn fall_back(&mut self) {
        self.leave_device("it was asked for".to_owned());
    }

    fn leave_device(&mut self, why: String) {
        if let Some(mut device) = self.device.take() {
            device.save(&mut self.bodies);
            // They may be where they were before they came to rest.
            self.sleep.wake_all();
            self.backend.note(why);
        }
    }

    /// What is to be done about an error of a frame: with [`BackendChoice::Auto`] the scene goes on
    /// without the device, or `body` does if it alone is to blame. Everything else is handed on.
    pub(crate) fn recover(
        &mut self,
        body: Option<usize>,
        error: SceneError,
    ) -> Result<(), SceneError> {
        if self.backend.choice != BackendChoice::Auto || !error.is_of_device() {
            return Err(error);
        }
        match (body, &mut self.device) {
            (Some(i), Some(device)) if error.is_no_room() => {
                device.remove(i);
                self.sleep.wake(i);
                self.backend.note(error.to_string());
            }
            _ => self.leave_device(error.to_string()),
        }
        Ok(())
    }
}
