//! What comes back from the device, while it goes on working where that is possible.

use super::context::Context;
use super::error::GpuError;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use wgpu::{Buffer, BufferUsages, CommandEncoder, MapMode, SubmissionIndex};

const PENDING: u8 = 0;
const MAPPED: u8 = 1;
const FAILED: u8 = 2;

/// A part of a buffer: where it starts and how long it is \[bytes\].
pub(super) type Part<'a> = (&'a Buffer, u64, u64);

/// A buffer that the host can read, and the copy that is on its way into it.
#[derive(Debug, Default)]
pub(super) struct Readback {
    buffer: Option<Buffer>,
    flight: Option<Flight>,
}

/// A copy on its way.
#[derive(Debug)]
struct Flight {
    bytes: u64,
    /// None until it is submitted.
    submission: Option<SubmissionIndex>,
    state: Arc<AtomicU8>,
    /// The frame whose end it shows.
    frame: u64,
}

impl Readback {
    /// Whether a copy of the end of `frame` is on its way.
    pub(super) fn shows(&self, frame: u64) -> bool {
        self.flight.as_ref().is_some_and(|f| f.frame == frame)
    }

    /// The frame whose end the copy on its way shows.
    pub(super) fn frame(&self) -> Option<u64> {
        self.flight.as_ref().map(|flight| flight.frame)
    }

    /// Whether the copy on its way is there, or will never be.
    pub(super) fn has_arrived(&self) -> bool {
        let state = |flight: &Flight| flight.state.load(Ordering::Acquire);
        self.flight.as_ref().is_some_and(|f| state(f) != PENDING)
    }

    /// Has the parts copied, one behind the other, when the commands are submitted. Forgets a copy
    /// that nobody has fetched.
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
        for &(from, offset, bytes) in parts {
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

    /// Tells with which submission the copy went off.
    pub(super) fn submitted(&mut self, submission: &SubmissionIndex) {
        if let Some(flight) = &mut self.flight {
            flight.submission.get_or_insert_with(|| submission.clone());
        }
    }

    /// Waits for the copy and shows it. None if there is none.
    pub(super) fn fetch<T>(
        &mut self,
        context: &Context,
        show: impl FnOnce(&[u8]) -> T,
    ) -> Result<Option<T>, GpuError> {
        let Some(flight) = self.flight.take() else {
            return Ok(None);
        };
        // What an error leaves may still be about to be mapped: it is not used again.
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

    /// Gives up a copy that nobody has fetched.
    pub(super) fn forget(&mut self) {
        let Some(flight) = self.flight.take() else {
            return;
        };
        match &self.buffer {
            Some(buffer) if flight.submission.is_some() => buffer.unmap(),
            // It was never asked to be mapped, as its commands went nowhere.
            _ => self.buffer = None,
        }
    }
}
