//! Reads states and bounding boxes of GPU bodies back to the CPU.

use super::backend::{GpuBackend, GpuBody, find_mut};
use super::body::{Arenas, MOTIONS, POSITIONS, REPORTS};
use super::edit::check_slots;
use super::error::GpuError;
use super::layout::Report;
use super::readback::Part;
use super::solid::{DeviceSolid, first_non_finite};
use crate::error::StepError;
use crate::solver::Solver;
use incise_mesh::{Aabb, Surface, VertexId};

impl GpuBackend {
    /// Requests that the next step copy the body's state, for [`GpuBackend::read`] after it.
    ///
    /// # Errors
    /// [`GpuError::UnknownBody`].
    pub fn prefetch(&mut self, body: GpuBody) -> Result<(), GpuError> {
        self.resident_mut(body)?.wants_state = true;
        Ok(())
    }

    /// Requests that the next step compute the body's box, for [`GpuBackend::bounds`] after it.
    ///
    /// # Errors
    /// [`GpuError::UnknownBody`].
    pub fn prefetch_bounds(&mut self, body: GpuBody) -> Result<(), GpuError> {
        self.resident_mut(body)?.wants_report = true;
        Ok(())
    }

    /// Reads positions, velocities and contacts back; blocks until the GPU has finished.
    ///
    /// Contacts that were set after the last step stay as they are.
    ///
    /// # Errors
    /// [`StepError::NonFinitePosition`] in [`GpuError::Step`] if a position is not finite;
    /// [`GpuError::StaleBody`] after edits without [`GpuBackend::update`];
    /// [`GpuError::ForeignSolver`] for the solver of another body. The CPU copy is then unchanged.
    pub fn read(
        &mut self,
        body: GpuBody,
        surface: &mut Surface,
        solver: &mut Solver,
    ) -> Result<(), GpuError> {
        let sent = self.send_small_changes(body, solver);
        self.flush()?;
        sent?;
        let i = body.slot() as usize;
        let resident = self.resident(body)?;
        if surface.positions().len() != resident.body.vertex_count as usize {
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

    /// Applies the pending state.
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
            let (report, data) = data.split_at(size_of::<Report>());
            let report = bytemuck::pod_read_unaligned::<Report>(report);
            if let Some(solid) = &resident.body.solid {
                return take_solid(solid, &report, data, surface, solver);
            }
            finite(&report)?;
            let size = size_of_val(surface.positions());
            let (positions, data) = data.split_at(size);
            let (motions, contacts) = data.split_at(2 * size);
            let vector = |bytes: &[u8]| bytemuck::pod_read_unaligned::<[f32; 4]>(bytes);
            for (to, from) in surface
                .positions_mut()
                .iter_mut()
                .zip(positions.chunks_exact(16))
            {
                let [x, y, z, _] = vector(from);
                *to = [x, y, z, to[3]];
            }
            solver.set_slack(report.slack());
            let particles = solver.particles_mut();
            let to = (particles.velocities.iter_mut()).zip(&mut particles.corrections);
            for ((velocity, correction), from) in to.zip(motions.chunks_exact(32)) {
                (*velocity, *correction) = (vector(&from[..16]), vector(&from[16..]));
            }
            resident
                .body
                .contacts
                .end_copy(contacts, solver.contacts_mut());
            Ok(())
        })?;
        shown.unwrap_or(Err(GpuError::UnknownBody))?;
        resident.host = frame.unwrap_or(resident.host);
        Ok(())
    }

    /// Returns the bounding box of the body, computed on the GPU; blocks until it is done.
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

    /// Encodes the copy of a body's state.
    pub(super) fn request_state(
        &mut self,
        slot: usize,
        encoder: &mut wgpu::CommandEncoder,
    ) -> Result<(), GpuError> {
        if let Some(resident) = &mut self.residents[slot] {
            let body = &mut resident.body;
            let start = u64::from(body.first_vertex()) * 16;
            let bytes = u64::from(body.vertex_count) * 16;
            let report = report_part(&self.arenas, body.slot);
            let parts = match &mut body.solid {
                Some(solid) => {
                    let [positions, motions, cells] = solid.begin_copy(&self.arenas);
                    [report, positions, motions, cells]
                }
                None => [
                    report,
                    (self.arenas.vertices.buffer(POSITIONS), start, bytes),
                    (self.arenas.vertices.buffer(MOTIONS), 2 * start, 2 * bytes),
                    body.contacts.begin_copy(&self.arenas),
                ],
            };
            let frame = resident.frame;
            resident
                .state
                .request(&self.context, encoder, &parts, frame)?;
        }
        Ok(())
    }

    /// Encodes the copy of a body's report with its motion.
    pub(super) fn request_motion(
        &mut self,
        slot: usize,
        encoder: &mut wgpu::CommandEncoder,
    ) -> Result<(), GpuError> {
        if let Some(resident) = &mut self.residents[slot] {
            resident.measures_motion = false;
            let part = [report_part(&self.arenas, resident.body.slot)];
            let frame = resident.frame;
            resident
                .motion
                .request(&self.context, encoder, &part, frame)?;
        }
        Ok(())
    }

    /// Encodes the copy of a body's report.
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

/// Copies the downloaded state of a solid to its solver, and embeds its surface.
fn take_solid(
    solid: &DeviceSolid,
    report: &Report,
    data: &[u8],
    surface: &mut Surface,
    solver: &mut Solver,
) -> Result<(), GpuError> {
    if let Some(interior) = solver.interior_mut() {
        if let Some((_, substep)) = report.non_finite() {
            // The report has a node, of which there may be no vertex.
            let slots = 0..surface.positions().len();
            let vertex = first_non_finite(data, interior, slots);
            return Err(StepError::NonFinitePosition { vertex, substep }.into());
        }
        solid.end_copy(data, interior);
    }
    solver.set_slack(report.slack());
    solver.embed(surface);
    Ok(())
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
