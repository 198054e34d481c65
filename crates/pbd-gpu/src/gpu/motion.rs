//! How far bodies move, for who wants to know which of them are at rest.

use super::backend::{GpuBackend, GpuBody};
use super::body::REPORTS;
use super::error::GpuError;
use super::layout::Report;
use super::read::finite;
use incise_mesh::Aabb;
use std::mem::offset_of;

impl GpuBackend {
    /// Has the device note from the next step on how far the body's vertices move, until
    /// [`GpuBackend::prefetch_motion`]. What was noted before is forgotten.
    ///
    /// # Errors
    /// [`GpuError::UnknownBody`].
    pub fn watch(&mut self, body: GpuBody) -> Result<(), GpuError> {
        self.resident_mut(body)?.is_watched = true;
        let report = u64::from(body.slot()) * size_of::<Report>() as u64;
        let word = report + offset_of!(Report, farthest) as u64;
        let buffer = self.arenas.bodies.buffer(REPORTS);
        let nothing = 0_u32.to_le_bytes();
        self.uploads.send(&self.context, buffer, word, &nothing);
        Ok(())
    }

    /// The next step is the last one that counts, and has what was noted copied to the host behind its work, for a
    /// [`GpuBackend::motion`] after it: three steps later it is there.
    ///
    /// # Errors
    /// [`GpuError::UnknownBody`].
    pub fn prefetch_motion(&mut self, body: GpuBody) -> Result<(), GpuError> {
        self.resident_mut(body)?.wants_motion = true;
        Ok(())
    }

    /// The farthest that a vertex moved along an axis in a substep of the steps that counted \[m\], and the body's box
    /// after the last of them. None if nobody asked for it.
    ///
    /// # Errors
    /// As [`GpuBackend::read`].
    pub fn motion(&mut self, body: GpuBody) -> Result<Option<(f32, Aabb)>, GpuError> {
        self.resident(body)?;
        let Some(resident) = &mut self.residents[body.slot() as usize] else {
            return Err(GpuError::UnknownBody);
        };
        let bytes = &mut self.bytes_read;
        let shown = resident.motion.fetch(&self.context, |data| {
            *bytes += data.len() as u64;
            let report = bytemuck::pod_read_unaligned::<Report>(data);
            finite(&report)?;
            let [min, max] = report.bounds();
            Ok((f32::from_bits(report.farthest), Aabb { min, max }))
        })?;
        shown.transpose()
    }
}
