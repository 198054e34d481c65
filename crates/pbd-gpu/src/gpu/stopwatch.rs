//! How long a step takes on the device itself.

use super::backend::GpuBackend;
use super::context::Context;
use super::error::GpuError;
use super::readback::Readback;
use wgpu::{
    Buffer, BufferUsages, CommandEncoder, ComputePassTimestampWrites, QuerySet, QuerySetDescriptor,
    QueryType, SubmissionIndex,
};

/// The start and the end of a pass, 8 bytes each.
const STAMPS: u32 = 2;
const BYTES: u64 = 8 * STAMPS as u64;

/// Notes when the device begins a pass and when it has done it.
#[derive(Debug)]
pub(super) struct Stopwatch {
    queries: QuerySet,
    stamps: Buffer,
    readback: Readback,
}

impl Stopwatch {
    fn new(context: &Context) -> Result<Self, GpuError> {
        let queries = context.scoped("timestamps", || {
            context.device().create_query_set(&QuerySetDescriptor {
                label: Some("timestamps"),
                ty: QueryType::Timestamp,
                count: STAMPS,
            })
        })?;
        let usage = BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC;
        Ok(Self {
            queries,
            stamps: context.buffer("timestamps", BYTES, usage)?,
            readback: Readback::default(),
        })
    }

    /// What has a pass write its stamps.
    pub(super) fn writes(&self) -> ComputePassTimestampWrites<'_> {
        ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        }
    }

    /// Has the stamps brought home when the commands are submitted.
    pub(super) fn request(
        &mut self,
        context: &Context,
        encoder: &mut CommandEncoder,
        frame: u64,
    ) -> Result<(), GpuError> {
        encoder.resolve_query_set(&self.queries, 0..STAMPS, &self.stamps, 0);
        let parts = [(&self.stamps, 0, BYTES)];
        self.readback.request(context, encoder, &parts, frame)
    }

    /// Tells with which submission the stamps went off.
    pub(super) fn submitted(&mut self, submission: &SubmissionIndex) {
        self.readback.submitted(submission);
    }
}

impl GpuBackend {
    /// Has the device time every step from now on, or none any more. Returns whether it does: one without timestamps
    /// ([`AdapterLimits::timestamps`](crate::AdapterLimits)) cannot.
    ///
    /// # Errors
    /// [`GpuError`] when the device refuses what it takes.
    pub fn time_steps(&mut self, is_wanted: bool) -> Result<bool, GpuError> {
        if !is_wanted || !self.context.has_timestamps() {
            self.stopwatch = None;
        } else if self.stopwatch.is_none() {
            self.stopwatch = Some(Stopwatch::new(&self.context)?);
        }
        Ok(self.stopwatch.is_some())
    }

    /// How long the last step took on the device, from the start of its first dispatch to the end of its last one \[s\]; waits
    /// for it. None for a step that was not timed, and when it was asked for before.
    ///
    /// # Errors
    /// As [`GpuBackend::wait`].
    pub fn step_seconds(&mut self) -> Result<Option<f64>, GpuError> {
        let Some(stopwatch) = &mut self.stopwatch else {
            return Ok(None);
        };
        let stamps = stopwatch.readback.fetch(&self.context, |data| {
            let stamp = |half: &[u8]| u64::from_le_bytes(half.try_into().unwrap_or_default());
            let (begin, end) = data.split_at(data.len() / 2);
            stamp(end).saturating_sub(stamp(begin))
        })?;
        let period = f64::from(self.context.queue().get_timestamp_period());
        #[expect(
            clippy::cast_precision_loss,
            reason = "a step takes far fewer than 2^53 ns"
        )]
        let seconds = stamps.map(|ticks| ticks as f64 * period * 1e-9);
        Ok(seconds)
    }
}
