//! Measures the motion of GPU bodies, by which a scene detects bodies at rest.

use super::backend::{GpuBackend, GpuBody};
use super::body::REPORTS;
use super::error::GpuError;
use super::layout::Report;
use super::read::finite;
use incise_mesh::Aabb;
use std::mem::offset_of;

impl GpuBackend {
    /// Starts to measure the motion of a body from the next step on.
    ///
    /// [`GpuBackend::prefetch_motion`] ends the measurement.
    ///
    /// # Errors
    /// [`GpuError::UnknownBody`].
    pub fn measure_motion(&mut self, body: GpuBody) -> Result<(), GpuError> {
        self.resident_mut(body)?.measures_motion = true;
        let report = u64::from(body.slot()) * size_of::<Report>() as u64;
        let word = report + offset_of!(Report, max_displacement) as u64;
        let buffer = self.arenas.bodies.buffer(REPORTS);
        let zero = 0_u32.to_le_bytes();
        self.uploads.send(&self.context, buffer, word, &zero);
        Ok(())
    }

    /// Ends the measurement after the next step and requests its readback.
    ///
    /// [`GpuBackend::motion`] returns it; three steps later it does not block.
    ///
    /// # Errors
    /// [`GpuError::UnknownBody`].
    pub fn prefetch_motion(&mut self, body: GpuBody) -> Result<(), GpuError> {
        self.resident_mut(body)?.wants_motion = true;
        Ok(())
    }

    /// Returns the maximum displacement along an axis in a substep \[m\], and the bounding box.
    ///
    /// The box is that after the last measured step. Returns `None` without a request.
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
            Ok((f32::from_bits(report.max_displacement), Aabb { min, max }))
        })?;
        shown.transpose()
    }
}
