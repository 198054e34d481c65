//! Device calls inside wgpu error scopes, so that failures become `RenderError`s.
//!
//! Outside of an error scope, wgpu reports a failed call to the device's handler, which panics by
//! default. The device belongs to the caller, and so does its handler.

use crate::error::RenderError;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;
use wgpu::{Buffer, BufferUsages, Device, ErrorFilter, PollError, PollType, SubmissionIndex};

/// Time limit of an image. Software adapters take seconds for the largest ones.
pub(super) const WAIT: Duration = Duration::from_secs(120);

/// Runs device calls and returns their error, if any. `what` names the operation.
pub(super) fn scoped<T>(
    device: &Device,
    what: &'static str,
    calls: impl FnOnce() -> T,
) -> Result<T, RenderError> {
    let internal = device.push_error_scope(ErrorFilter::Internal);
    let memory = device.push_error_scope(ErrorFilter::OutOfMemory);
    let validation = device.push_error_scope(ErrorFilter::Validation);
    let made = calls();
    // Running out of memory also causes validation errors, so it takes precedence.
    let validation = pollster::block_on(validation.pop());
    let memory = pollster::block_on(memory.pop());
    let internal = pollster::block_on(internal.pop());
    match memory.or(internal).or(validation) {
        None => Ok(made),
        Some(wgpu::Error::OutOfMemory { .. }) => Err(RenderError::OutOfMemory { what }),
        Some(wgpu::Error::Validation { description, .. }) => Err(RenderError::Validation {
            what,
            message: description.trim().to_owned(),
        }),
        Some(wgpu::Error::Internal { description, .. }) => Err(RenderError::Driver {
            what,
            message: description.trim().to_owned(),
        }),
    }
}

/// Creates a buffer of at least `bytes` bytes, rounded up to a positive multiple of 16.
pub(super) fn create_buffer(
    device: &Device,
    what: &'static str,
    bytes: u64,
    usage: BufferUsages,
) -> Result<Buffer, RenderError> {
    let limits = device.limits();
    let limit = if usage.contains(BufferUsages::STORAGE) {
        let binding = limits.max_storage_buffer_binding_size;
        binding.min(limits.max_buffer_size)
    } else {
        limits.max_buffer_size
    };
    let size = bytes.max(1).checked_next_multiple_of(16);
    let Some(size) = size.filter(|&size| size <= limit) else {
        return Err(RenderError::BufferTooLarge { what, bytes, limit });
    };
    scoped(device, what, || {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(what),
            size,
            usage,
            mapped_at_creation: false,
        })
    })
}

/// Blocks until a submission is done.
///
/// Its callbacks have run, or run on another thread that waits for the device.
pub(super) fn wait(device: &Device, submission: SubmissionIndex) -> Result<(), RenderError> {
    let until = PollType::Wait {
        submission_index: Some(submission),
        timeout: Some(WAIT),
    };
    // wgpu panics if the device is lost during the wait.
    match catch_unwind(AssertUnwindSafe(|| device.poll(until))) {
        Ok(Ok(_)) => Ok(()),
        Ok(Err(PollError::Timeout)) => Err(RenderError::Timeout {
            seconds: WAIT.as_secs(),
        }),
        Ok(Err(error @ PollError::WrongSubmissionIndex(..))) => Err(RenderError::Validation {
            what: "waiting for the GPU",
            message: error.to_string(),
        }),
        Err(panic) => {
            let reason = panic.downcast_ref::<String>().cloned();
            Err(RenderError::DeviceLost {
                reason: reason.unwrap_or_else(|| "the driver failed while waiting".to_owned()),
            })
        }
    }
}
