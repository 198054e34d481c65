//! An open device, and what becomes of its errors.
//!
//! wgpu reports a refused call to the innermost error scope or, without one, to a handler that
//! panics. Here nothing panics: calls are made within [`Context::scoped`], and whatever is reported
//! outside of it waits in [`Faults`] for the next [`Context::check`].

use super::adapter::{
    AdapterRequest, AdapterSummary, check_limits, choose, choose_among, limits_to_open,
};
use super::error::GpuError;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use wgpu::{Buffer, BufferUsages, Device, ErrorFilter, Features, PollType, Queue};

/// How long [`Context::wait`] waits. Drivers give up on a GPU after seconds; software needs longer
/// for a frame of large bodies, and nothing needs this long.
const WAIT: Duration = Duration::from_secs(120);

/// A device, its queue and what went wrong on it.
#[derive(Debug)]
pub struct Context {
    adapter: AdapterSummary,
    device: Device,
    queue: Queue,
    faults: Arc<Faults>,
}

/// What was reported outside of any call that could have returned it.
#[derive(Debug, Default)]
struct Faults(Mutex<Reported>);

#[derive(Debug, Default)]
struct Reported {
    /// Why the device is lost. It stays so.
    lost: Option<String>,
    /// The first error since the last check: the later ones follow from it.
    error: Option<GpuError>,
}

impl Faults {
    fn lock(&self) -> MutexGuard<'_, Reported> {
        // What is written under the lock is whole after every statement.
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
    /// Opens the adapter that is asked for.
    ///
    /// # Errors
    ///
    /// [`GpuError::NoAdapter`] if there is none, [`GpuError::LimitTooSmall`] if none of those asked
    /// for can do enough, [`GpuError::Request`] if the driver opens no device.
    pub fn open(request: &AdapterRequest) -> Result<Self, GpuError> {
        let (summary, adapter) = choose(request)?;
        Self::open_chosen(request, summary, &adapter)
    }

    /// As [`Context::open`], of adapters that somebody else has found and the first of them that `is_fit`: that can draw
    /// in a window, say. Returns it too. Those after it are not asked: there are drivers that crash at such questions.
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
        };
        context.listen();
        Ok(context)
    }

    /// A context on a device that somebody else has opened, a renderer say.
    ///
    /// The device's handlers stay as they are: if nobody handles its loss and its errors, call
    /// [`Context::listen`].
    ///
    /// # Errors
    ///
    /// [`GpuError::LimitTooSmall`] if the device was opened with less than the kernels need.
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
        })
    }

    /// Makes this context the one that hears of the device's loss and of errors outside of any
    /// scope, in place of who heard of them before. [`Context::open`] has done so.
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

    /// The adapter that was opened.
    pub fn adapter(&self) -> &AdapterSummary {
        &self.adapter
    }

    /// The device.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// The queue of the device.
    pub fn queue(&self) -> &Queue {
        &self.queue
    }

    /// Whether passes can be timed on the device.
    pub fn has_timestamps(&self) -> bool {
        self.device.features().contains(Features::TIMESTAMP_QUERY)
    }

    /// Returns what was reported since the last check.
    ///
    /// # Errors
    ///
    /// [`GpuError::DeviceLost`] from the loss on, else the first error of a call outside of
    /// [`Context::scoped`], once.
    pub fn check(&self) -> Result<(), GpuError> {
        self.faults.check()
    }

    /// Makes calls on the device or queue and returns what they were refused for. `what` says in a
    /// few words what they do.
    ///
    /// # Errors
    ///
    /// What [`Context::check`] finds before or after the calls, [`GpuError::Validation`],
    /// [`GpuError::OutOfMemory`] or [`GpuError::Driver`]. What the calls made is then of no use.
    pub fn scoped<T>(&self, what: &str, calls: impl FnOnce() -> T) -> Result<T, GpuError> {
        self.check()?;
        let internal = self.device.push_error_scope(ErrorFilter::Internal);
        let memory = self.device.push_error_scope(ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(ErrorFilter::Validation);
        let made = calls();
        // Out of memory makes invalid what was to be made, so it is the reason for what else is said.
        let validation = pollster::block_on(validation.pop());
        let memory = pollster::block_on(memory.pop());
        let internal = pollster::block_on(internal.pop());
        self.check()?;
        match memory.or(internal).or(validation) {
            None => Ok(made),
            Some(error) => Err(GpuError::of_call(what, &error)),
        }
    }

    /// Makes a buffer of at least `bytes` bytes: at least 4, and a multiple of 4.
    ///
    /// # Errors
    ///
    /// [`GpuError::BufferTooLarge`] for more than the device takes, and what [`Context::scoped`]
    /// returns.
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

    /// Blocks until submitted work is done, and calls what waits for it.
    ///
    /// # Errors
    ///
    /// [`GpuError::Timeout`] if it does not end within two minutes, and what [`Context::check`]
    /// finds.
    pub fn wait(&self, submission: wgpu::SubmissionIndex) -> Result<(), GpuError> {
        self.wait_for(submission, WAIT)
    }

    /// Blocks like [`Context::wait`], but not longer than `timeout`. What was submitted goes on and can
    /// be waited for again.
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

    /// Calls what waits for work that is done by now, without blocking.
    ///
    /// # Errors
    ///
    /// What [`Context::check`] finds.
    pub fn poll_once(&self) -> Result<(), GpuError> {
        self.poll(PollType::Poll)
    }

    fn poll(&self, until: PollType) -> Result<(), GpuError> {
        let timeout = match &until {
            PollType::Wait { timeout, .. } => timeout.unwrap_or_default(),
            PollType::Poll => Duration::ZERO,
        };
        // A device that is lost while it is waited for makes wgpu panic.
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

    /// Gives the device up at once, with all that lies on it. Every later call returns
    /// [`GpuError::DeviceLost`].
    pub fn destroy(&self) {
        self.device.destroy();
        self.faults.lose("it was destroyed".to_owned());
    }
}
