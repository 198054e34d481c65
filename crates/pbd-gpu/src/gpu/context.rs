//! An open GPU device with error handling.
//!
//! wgpu reports a failed call to the innermost error scope or, without one, to a handler that
//! panics. Here calls are made within [`Context::scoped`]. Errors outside of it are collected in
//! [`Faults`] until the next [`Context::check`].

use super::adapter::{
    AdapterRequest, AdapterSummary, check_limits, choose, choose_among, limits_to_open,
};
use super::error::GpuError;
use super::pipelines::SharedPipelines;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use wgpu::{Buffer, BufferUsages, Device, ErrorFilter, Features, PollType, Queue};

/// Time limit of [`Context::wait`], far above a frame of large bodies on software adapters.
pub(super) const WAIT: Duration = Duration::from_secs(120);

/// A wgpu device with its queue, its collected errors and the kernels compiled for it.
///
/// Clones share all of them: backends on clones of a context compile each kernel once. An error
/// outside of [`Context::scoped`] is returned by the first clone that checks.
#[derive(Debug, Clone)]
pub struct Context {
    adapter: AdapterSummary,
    device: Device,
    queue: Queue,
    faults: Arc<Faults>,
    pipelines: Arc<Mutex<SharedPipelines>>,
}

/// Errors that were reported outside of any error scope.
#[derive(Debug, Default)]
struct Faults(Mutex<Reported>);

#[derive(Debug, Default)]
struct Reported {
    /// Reason of the device's loss, which is permanent.
    lost: Option<String>,
    /// First error since the last check; later ones are consequences.
    error: Option<GpuError>,
}

impl Faults {
    fn lock(&self) -> MutexGuard<'_, Reported> {
        // The data is consistent after every statement, so a poisoned lock is harmless.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn lose(&self, reason: String) {
        self.lock().lost.get_or_insert(reason);
    }

    fn check(&self) -> Result<(), GpuError> {
        let mut reported = self.lock();
        if let Some(reason) = reported.lost.clone() {
            return Err(GpuError::DeviceLost { reason });
        }
        reported.error.take().map_or(Ok(()), Err)
    }
}

impl Context {
    /// Opens the requested adapter.
    ///
    /// # Errors
    ///
    /// [`GpuError::NoAdapter`] if no adapter matches; [`GpuError::LimitTooSmall`] if no matching
    /// adapter is sufficient; [`GpuError::Request`] if the driver fails.
    pub fn open(request: &AdapterRequest) -> Result<Self, GpuError> {
        let (summary, adapter) = choose(request)?;
        Self::open_chosen(request, summary, &adapter)
    }

    /// Opens the first of the given adapters that matches the request and satisfies `is_fit`.
    ///
    /// Use `is_fit` to require, for example, presentation to a window. It is not called for
    /// adapters after the result, since the query crashes some drivers.
    ///
    /// # Errors
    ///
    /// As [`Context::open`].
    pub fn open_among(
        adapters: Vec<wgpu::Adapter>,
        request: &AdapterRequest,
        is_fit: impl Fn(&wgpu::Adapter) -> bool,
    ) -> Result<(Self, wgpu::Adapter), GpuError> {
        let (summary, adapter) = choose_among(adapters, request, is_fit)?;
        let context = Self::open_chosen(request, summary, &adapter)?;
        Ok((context, adapter))
    }

    fn open_chosen(
        request: &AdapterRequest,
        summary: AdapterSummary,
        adapter: &wgpu::Adapter,
    ) -> Result<Self, GpuError> {
        let limits = limits_to_open(request, &adapter.limits());
        check_limits(&summary.name, &limits, request.storage_binding)?;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("incise"),
            required_features: Features::TIMESTAMP_QUERY & adapter.features(),
            required_limits: limits,
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(|error| {
                GpuError::Request {
                    adapter: summary.name.clone(),
                    message: error.to_string(),
                }
            })?;
        let context = Self {
            adapter: summary,
            device,
            queue,
            faults: Arc::default(),
            pipelines: Arc::default(),
        };
        context.listen();
        Ok(context)
    }

    /// Creates a context on a device that the caller has opened.
    ///
    /// The error handlers of the device are unchanged; [`Context::listen`] replaces them.
    ///
    /// # Errors
    ///
    /// [`GpuError::LimitTooSmall`] if the limits of the device are below those of the kernels.
    pub fn from_device(
        adapter: &wgpu::Adapter,
        device: Device,
        queue: Queue,
    ) -> Result<Self, GpuError> {
        let summary = AdapterSummary::new(adapter);
        check_limits(&summary.name, &device.limits(), 0)?;
        Ok(Self {
            adapter: summary,
            device,
            queue,
            faults: Arc::default(),
            pipelines: Arc::default(),
        })
    }

    /// Installs handlers for device loss and for errors outside of scopes.
    ///
    /// They replace the previous handlers. [`Context::open`] does this itself.
    pub fn listen(&self) {
        let faults = Arc::clone(&self.faults);
        self.device
            .set_device_lost_callback(move |reason, message| {
                faults.lose(format!("{reason:?}: {message}"));
            });
        let faults = Arc::clone(&self.faults);
        self.device.on_uncaptured_error(Arc::new(move |error| {
            let error = GpuError::of_call("a call on the device", &error);
            faults.lock().error.get_or_insert(error);
        }));
    }

    /// Returns the description of the adapter.
    pub fn adapter(&self) -> &AdapterSummary {
        &self.adapter
    }

    /// Returns the wgpu device.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// Returns the queue of the device.
    pub fn queue(&self) -> &Queue {
        &self.queue
    }

    /// Locks the pipelines that clones of this context share.
    pub(super) fn pipelines(&self) -> MutexGuard<'_, SharedPipelines> {
        // Each pipeline is stored whole, so a poisoned lock is harmless.
        self.pipelines
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns true if the device supports timestamp queries.
    pub fn has_timestamps(&self) -> bool {
        self.device.features().contains(Features::TIMESTAMP_QUERY)
    }

    /// Returns the error that was reported since the last check, if any.
    ///
    /// # Errors
    ///
    /// [`GpuError::DeviceLost`] from the loss on, else the first error of a call outside of
    /// [`Context::scoped`], once.
    pub fn check(&self) -> Result<(), GpuError> {
        self.faults.check()
    }

    /// Runs device or queue calls and returns their error, if any. `what` names the operation.
    ///
    /// # Errors
    ///
    /// Errors of [`Context::check`] before or after the calls; [`GpuError::Validation`],
    /// [`GpuError::OutOfMemory`] or [`GpuError::Driver`]. Created resources are then invalid.
    pub fn scoped<T>(&self, what: &str, calls: impl FnOnce() -> T) -> Result<T, GpuError> {
        self.check()?;
        let internal = self.device.push_error_scope(ErrorFilter::Internal);
        let memory = self.device.push_error_scope(ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(ErrorFilter::Validation);
        let made = calls();
        // Running out of memory also causes validation errors, so it takes precedence.
        let validation = pollster::block_on(validation.pop());
        let memory = pollster::block_on(memory.pop());
        let internal = pollster::block_on(internal.pop());
        self.check()?;
        match memory.or(internal).or(validation) {
            None => Ok(made),
            Some(error) => Err(GpuError::of_call(what, &error)),
        }
    }

    /// Creates a buffer of at least `bytes` bytes, rounded up to a positive multiple of 4.
    ///
    /// # Errors
    ///
    /// [`GpuError::BufferTooLarge`] above the limits of the device; errors of
    /// [`Context::scoped`].
    pub fn buffer(&self, label: &str, bytes: u64, usage: BufferUsages) -> Result<Buffer, GpuError> {
        let limits = self.device.limits();
        let limit = if usage.contains(BufferUsages::STORAGE) {
            let binding = limits.max_storage_buffer_binding_size;
            binding.min(limits.max_buffer_size)
        } else {
            limits.max_buffer_size
        };
        let size = bytes.max(1).checked_next_multiple_of(4);
        let Some(size) = size.filter(|&size| size <= limit) else {
            return Err(GpuError::BufferTooLarge {
                what: label.to_owned(),
                bytes,
                limit,
            });
        };
        self.scoped(label, || {
            self.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        })
    }

    /// Blocks until submitted work is done.
    ///
    /// Its callbacks have run, or run on another thread that waits for the device.
    ///
    /// # Errors
    ///
    /// [`GpuError::Timeout`] after two minutes; errors of [`Context::check`].
    pub fn wait(&self, submission: wgpu::SubmissionIndex) -> Result<(), GpuError> {
        self.wait_for(submission, WAIT)
    }

    /// Blocks like [`Context::wait`] for at most `timeout`; the submitted work continues.
    ///
    /// # Errors
    ///
    /// As of [`Context::wait`].
    pub fn wait_for(
        &self,
        submission: wgpu::SubmissionIndex,
        timeout: Duration,
    ) -> Result<(), GpuError> {
        self.poll(PollType::Wait {
            submission_index: Some(submission),
            timeout: Some(timeout),
        })
    }

    /// Runs the callbacks of completed work without blocking.
    ///
    /// # Errors
    ///
    /// Errors of [`Context::check`].
    pub fn poll_once(&self) -> Result<(), GpuError> {
        self.poll(PollType::Poll)
    }

    fn poll(&self, until: PollType) -> Result<(), GpuError> {
        let timeout = match &until {
            PollType::Wait { timeout, .. } => timeout.unwrap_or_default(),
            PollType::Poll => Duration::ZERO,
        };
        // wgpu panics if the device is lost during the wait.
        let polled = catch_unwind(AssertUnwindSafe(|| self.device.poll(until)));
        if let Err(panic) = &polled {
            let reason = panic.downcast_ref::<String>().cloned();
            self.faults
                .lose(reason.unwrap_or_else(|| "the driver failed while waiting".to_owned()));
        }
        self.check()?;
        match polled {
            Ok(Err(wgpu::PollError::Timeout)) => Err(GpuError::Timeout {
                seconds: timeout.as_secs_f64(),
            }),
            Ok(Err(error @ wgpu::PollError::WrongSubmissionIndex(..))) => {
                Err(GpuError::Validation {
                    what: "waiting for the device".to_owned(),
                    message: error.to_string(),
                })
            }
            Ok(Ok(_)) | Err(_) => Ok(()),
        }
    }

    /// Destroys the device with all of its resources.
    ///
    /// Every later call returns [`GpuError::DeviceLost`].
    pub fn destroy(&self) {
        self.device.destroy();
        self.faults.lose("it was destroyed".to_owned());
    }
}
