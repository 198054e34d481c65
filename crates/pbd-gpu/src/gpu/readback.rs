//! Asynchronous copies from GPU buffers to CPU memory.

use super::context::{Context, WAIT};
use super::error::GpuError;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use wgpu::{Buffer, BufferUsages, CommandEncoder, MapMode, SubmissionIndex};

/// Offset and length of a part of a buffer \[bytes\].
pub(super) type Part<'a> = (&'a Buffer, u64, u64);

/// A mappable buffer and its pending copy.
#[derive(Debug, Default)]
pub(super) struct Readback {
    buffer: Option<Buffer>,
    flight: Option<Flight>,
}

/// A pending copy.
#[derive(Debug)]
struct Flight {
    bytes: u64,
    /// Submission of the copy, once it is submitted.
    submission: Option<SubmissionIndex>,
    mapping: Arc<Mapping>,
    /// Frame whose final state is copied.
    frame: u64,
}

/// The result of a mapping request, set by its callback.
#[derive(Debug, Default)]
struct Mapping {
    /// Success or failure; `None` while it is pending.
    state: Mutex<Option<bool>>,
    reported: Condvar,
}

impl Mapping {
    fn lock(&self) -> MutexGuard<'_, Option<bool>> {
        // A single value is consistent, so a poisoned lock is harmless.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn report(&self, is_mapped: bool) {
        *self.lock() = Some(is_mapped);
        self.reported.notify_all();
    }

    /// Blocks until the callback has run; `None` after a timeout.
    ///
    /// It runs on any thread that waits for the device, such as a renderer's.
    fn wait(&self) -> Option<bool> {
        let is_pending = |state: &mut Option<bool>| state.is_none();
        let waited = self
            .reported
            .wait_timeout_while(self.lock(), WAIT, is_pending);
        *waited.unwrap_or_else(PoisonError::into_inner).0
    }
}

impl Readback {
    /// Returns true if a copy of `frame` is pending.
    pub(super) fn shows(&self, frame: u64) -> bool {
        self.flight.as_ref().is_some_and(|f| f.frame == frame)
    }

    /// Returns the frame of the pending copy.
    pub(super) fn frame(&self) -> Option<u64> {
        self.flight.as_ref().map(|flight| flight.frame)
    }

    /// Returns true if the pending copy is complete or has failed.
    pub(super) fn has_arrived(&self) -> bool {
        let flight = self.flight.as_ref();
        flight.is_some_and(|flight| flight.mapping.lock().is_some())
    }

    /// Encodes copies of the parts, one after the other, and discards a pending copy.
    pub(super) fn request(
        &mut self,
        context: &Context,
        encoder: &mut CommandEncoder,
        parts: &[Part<'_>],
        frame: u64,
    ) -> Result<(), GpuError> {
        self.forget();
        let bytes = parts.iter().map(|(_, _, bytes)| bytes).sum();
        let buffer = match self.buffer.take() {
            Some(buffer) if buffer.size() >= bytes => buffer,
            _ => context.buffer(
                "readback",
                bytes + bytes / 4,
                BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            )?,
        };
        let mut at = 0;
        for &(from, offset, bytes) in parts.iter().filter(|(_, _, bytes)| *bytes > 0) {
            encoder.copy_buffer_to_buffer(from, offset, &buffer, at, bytes);
            at += bytes;
        }
        let mapping = Arc::<Mapping>::default();
        let reported = Arc::clone(&mapping);
        encoder.map_buffer_on_submit(&buffer, MapMode::Read, 0..bytes, move |done| {
            reported.report(done.is_ok());
        });
        self.buffer = Some(buffer);
        self.flight = Some(Flight {
            bytes,
            submission: None,
            mapping,
            frame,
        });
        Ok(())
    }

    /// Sets the submission of the copy.
    pub(super) fn submitted(&mut self, submission: &SubmissionIndex) {
        if let Some(flight) = &mut self.flight {
            flight.submission.get_or_insert_with(|| submission.clone());
        }
    }

    /// Blocks until the copy is complete and passes its bytes on; `None` without a pending copy.
    pub(super) fn fetch<T>(
        &mut self,
        context: &Context,
        show: impl FnOnce(&[u8]) -> T,
    ) -> Result<Option<T>, GpuError> {
        let Some(flight) = self.flight.take() else {
            return Ok(None);
        };
        // After an error the mapping may still be pending, so the buffer is not reused.
        let Some(buffer) = self.buffer.take() else {
            return Ok(None);
        };
        let reported = *flight.mapping.lock();
        let is_mapped = match (reported, flight.submission) {
            (None, Some(submission)) => {
                context.wait(submission)?;
                flight.mapping.wait().ok_or(GpuError::Timeout {
                    seconds: WAIT.as_secs_f64(),
                })?
            }
            // Commands that were not submitted map nothing.
            (reported, _) => reported == Some(true),
        };
        if !is_mapped {
            context.check()?;
            return Err(GpuError::Driver {
                what: "reading back".to_owned(),
                message: "the buffer was not mapped".to_owned(),
            });
        }
        let shown = match buffer.slice(0..flight.bytes).get_mapped_range() {
            Ok(view) => show(&view),
            Err(error) => {
                return Err(GpuError::Driver {
                    what: "reading back".to_owned(),
                    message: error.to_string(),
                });
            }
        };
        buffer.unmap();
        self.buffer = Some(buffer);
        Ok(Some(shown))
    }

    /// Discards a pending copy.
    pub(super) fn forget(&mut self) {
        let Some(flight) = self.flight.take() else {
            return;
        };
        match &self.buffer {
            Some(buffer) if flight.submission.is_some() => buffer.unmap(),
            // Commands that were not submitted have not requested a mapping.
            _ => self.buffer = None,
        }
    }
}
