//! Asynchronous copies from GPU buffers to CPU memory.

use super::context::Context;
use super::error::GpuError;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use wgpu::{Buffer, BufferUsages, CommandEncoder, MapMode, SubmissionIndex};

const PENDING: u8 = 0;
const MAPPED: u8 = 1;
const FAILED: u8 = 2;

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
    state: Arc<AtomicU8>,
    /// Frame whose final state is copied.
    frame: u64,
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
        let state = |flight: &Flight| flight.state.load(Ordering::Acquire);
        self.flight.as_ref().is_some_and(|f| state(f) != PENDING)
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
        let state = Arc::new(AtomicU8::new(PENDING));
        let seen = Arc::clone(&state);
        encoder.map_buffer_on_submit(&buffer, MapMode::Read, 0..bytes, move |done| {
            let now = if done.is_ok() { MAPPED } else { FAILED };
            seen.store(now, Ordering::Release);
        });
        self.buffer = Some(buffer);
        self.flight = Some(Flight {
            bytes,
            submission: None,
            state,
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
        if flight.state.load(Ordering::Acquire) == PENDING
            && let Some(submission) = flight.submission
        {
            context.wait(submission)?;
        }
        if flight.state.load(Ordering::Acquire) != MAPPED {
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
