//! What the host reads of bodies that live on a device.

use super::backend::{GpuBackend, GpuBody, find_mut};
use super::body::{Arenas, POSITIONS, REPORTS, VELOCITIES};
use super::edit::check_slots;
use super::error::GpuError;
use super::layout::Report;
use super::readback::Part;
use crate::error::StepError;
use crate::solver::Solver;
use incise_mesh::{Aabb, Surface, VertexId};

impl GpuBackend {
    /// Has the next step copy the body's state to the host behind its work, so that a
    /// [`GpuBackend::read`] after it finds it there instead of waiting for a copy of its own.
    ///
    /// # Errors
    /// [`GpuError::UnknownBody`].
    pub fn prefetch(&mut self, body: GpuBody) -> Result<(), GpuError> {
        self.resident_mut(body)?.wants_state = true;
        Ok(())
    }

    /// Has the next step find the body's box, for a [`GpuBackend::bounds`] after it.
    ///
    /// # Errors
    /// [`GpuError::UnknownBody`].
    pub fn prefetch_bounds(&mut self, body: GpuBody) -> Result<(), GpuError> {
        self.resident_mut(body)?.wants_report = true;
        Ok(())
    }

    /// Brings positions and velocities to the host: waits until the device is done with them.
    ///
    /// # Errors
    /// [`StepError::NonFinitePosition`] in [`GpuError::Step`] when a position stopped being a number;
    /// [`GpuError::StaleBody`] when surface and solver were edited and the device has not been told;
    /// [`GpuError::ForeignSolver`] when the body follows another solver. The host's copy is as it was
    /// then.
    pub fn read(
        &mut self,
        body: GpuBody,
        surface: &mut Surface,
        solver: &mut Solver,
    ) -> Result<(), GpuError> {
        let told = self.send_small_changes(body, solver);
        self.flush()?;
        told?;
        let i = body.slot() as usize;
        let resident = self.resident(body)?;
        if surface.positions.len() != resident.body.vertex_count as usize {
            return Err(GpuError::StaleBody);
        }
        check_slots(surface, solver)?;
        if !resident.state.shows(resident.frame) {
            let mut encoder = super::encoder(&self.context, "read");
            self.request_state(i, &mut encoder)?;
            let submission = self.context.queue().submit([encoder.finish()]);
            self.context.check()?;
            if let Some(resident) = &mut self.residents[i] {
                resident.state.submitted(&submission);
            }
        }
        self.take_state(body, surface, solver)
    }

    /// Takes over the state that is on its way.
    pub(super) fn take_state(
        &mut self,
        body: GpuBody,
        surface: &mut Surface,
        solver: &mut Solver,
    ) -> Result<(), GpuError> {
        check_slots(surface, solver)?;
        let resident = find_mut(&mut self.residents, body)?;
        let frame = resident.state.frame();
        let bytes = &mut self.bytes_read;
        let shown = resident.state.fetch(&self.context, |data| {
            *bytes += data.len() as u64;
            let (vectors, report) = data.split_at(data.len() - size_of::<Report>());
            let report = bytemuck::pod_read_unaligned::<Report>(report);
            finite(&report)?;
            let (positions, velocities) = vectors.split_at(vectors.len() / 2);
            let vector = |bytes: &[u8]| bytemuck::pod_read_unaligned::<[f32; 4]>(bytes);
            for (to, from) in surface.positions.iter_mut().zip(positions.chunks_exact(16)) {
                let [x, y, z, _] = vector(from);
                *to = [x, y, z, to[3]];
            }
            for (to, from) in (solver.velocities.iter_mut()).zip(velocities.chunks_exact(16)) {
                *to = vector(from);
            }
            Ok(())
        })?;
        shown.unwrap_or(Err(GpuError::UnknownBody))?;
        resident.host = frame.unwrap_or(resident.host);
        Ok(())
    }

    /// The box of the body's vertices, found on the device: waits until it is done.
    ///
    /// # Errors
    /// As [`GpuBackend::read`].
    pub fn bounds(&mut self, body: GpuBody) -> Result<Aabb, GpuError> {
        let i = body.slot() as usize;
        let resident = self.resident(body)?;
        if !resident.report.shows(resident.frame) {
            self.reduce_bounds(body.slot())?;
        }
        let Some(resident) = &mut self.residents[i] else {
            return Err(GpuError::UnknownBody);
        };
        let bytes = &mut self.bytes_read;
        let shown = resident.report.fetch(&self.context, |data| {
            *bytes += data.len() as u64;
            let report = bytemuck::pod_read_unaligned::<Report>(data);
            finite(&report)?;
            let [min, max] = report.bounds();
            Ok(Aabb { min, max })
        })?;
        shown.unwrap_or(Err(GpuError::UnknownBody))
    }

    /// Has the state of a body copied.
    pub(super) fn request_state(
        &mut self,
        slot: usize,
        encoder: &mut wgpu::CommandEncoder,
    ) -> Result<(), GpuError> {
        if let Some(resident) = &mut self.residents[slot] {
            let body = &resident.body;
            let start = u64::from(body.first_vertex()) * 16;
            let bytes = u64::from(body.vertex_count) * 16;
            let parts = [
                (self.arenas.vertices.buffer(POSITIONS), start, bytes),
                (self.arenas.vertices.buffer(VELOCITIES), start, bytes),
                report_part(&self.arenas, body.slot),
            ];
            let frame = resident.frame;
            resident
                .state
                .request(&self.context, encoder, &parts, frame)?;
        }
        Ok(())
    }

    /// Has the report of a body copied, with what was noted of its motion.
    pub(super) fn request_motion(
        &mut self,
        slot: usize,
        encoder: &mut wgpu::CommandEncoder,
    ) -> Result<(), GpuError> {
        if let Some(resident) = &mut self.residents[slot] {
            resident.is_watched = false;
            let part = [report_part(&self.arenas, resident.body.slot)];
            let frame = resident.frame;
            resident
                .motion
                .request(&self.context, encoder, &part, frame)?;
        }
        Ok(())
    }

    /// Has the report of a body copied.
    pub(super) fn request_report(
        &mut self,
        slot: usize,
        encoder: &mut wgpu::CommandEncoder,
    ) -> Result<(), GpuError> {
        if let Some(resident) = &mut self.residents[slot] {
            let part = [report_part(&self.arenas, resident.body.slot)];
            let frame = resident.frame;
            resident
                .report
                .request(&self.context, encoder, &part, frame)?;
        }
        Ok(())
    }
}

pub(super) fn report_part(arenas: &Arenas, slot: u32) -> Part<'_> {
    let bytes = size_of::<Report>() as u64;
    (
        arenas.bodies.buffer(REPORTS),
        u64::from(slot) * bytes,
        bytes,
    )
}

pub(super) fn finite(report: &Report) -> Result<(), GpuError> {
    match report.non_finite() {
        None => Ok(()),
        Some((vertex, substep)) => Err(GpuError::Step(StepError::NonFinitePosition {
            vertex: VertexId(vertex),
            substep,
        })),
    }
}
