//! GPU time of steps, measured with timestamp queries.

use super::backend::GpuBackend;
use super::context::Context;
use super::error::GpuError;
use super::readback::Readback;
use wgpu::{
    Buffer, BufferUsages, CommandEncoder, ComputePassTimestampWrites, QuerySet, QuerySetDescriptor,
    QueryType, SubmissionIndex,
};

/// Size of the start and end timestamps of a pass \[bytes\].
const STAMPS: u32 = 2;
const BYTES: u64 = 8 * STAMPS as u64;

/// Timestamp queries at start and end of a pass.
#[derive(Debug)]
pub(super) struct Timestamps {
    queries: QuerySet,
    stamps: Buffer,
    readback: Readback,
}

impl Timestamps {
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

    /// Returns the descriptor that makes a pass write its timestamps.
    pub(super) fn writes(&self) -> ComputePassTimestampWrites<'_> {
        ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        }
    }

    /// Encodes the readback of the timestamps.
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

    /// Sets the submission of the timestamps.
    pub(super) fn submitted(&mut self, submission: &SubmissionIndex) {
        self.readback.submitted(submission);
    }
}

impl GpuBackend {
    /// Starts or stops timing every step; returns true if steps are timed.
    ///
    /// Requires an adapter with [`AdapterSummary::timestamps`](crate::AdapterSummary::timestamps).
    ///
    /// # Errors
    /// [`GpuError`] if the queries cannot be created.
    pub fn time_steps(&mut self, is_wanted: bool) -> Result<bool, GpuError> {
        if !is_wanted || !self.context.has_timestamps() {
            self.timestamps = None;
        } else if self.timestamps.is_none() {
            self.timestamps = Some(Timestamps::new(&self.context)?);
        }
        Ok(self.timestamps.is_some())
    }

    /// Blocks and returns the GPU time of the last step, first to last dispatch \[s\].
    ///
    /// Returns `None` if the step was not timed or its time was read before.
    ///
    /// # Errors
    /// As [`GpuBackend::wait`].
    pub fn step_seconds(&mut self) -> Result<Option<f64>, GpuError> {
        let Some(timestamps) = &mut self.timestamps else {
            return Ok(None);
        };
        let stamps = timestamps.readback.fetch(&self.context, |data| {
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
