//! Encodes the program of a frame into a submission, with the requested copies.

use super::backend::{FRAMES_IN_FLIGHT, GpuBackend};
use super::error::GpuError;
use super::pipelines::{Kernel, Pipelines, workgroups};
use super::program::{Dispatch, Program};
use super::timestamps::Timestamps;
use super::uniforms::PASS_STRIDE;
use wgpu::{BindGroup, ComputePass, ComputePassDescriptor};

/// The parts of a program that a frame may leave out.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Optional {
    /// The sums of the forces of cells.
    pub(super) sums: bool,
    pub(super) guard: bool,
    /// The bounding boxes.
    pub(super) bounds: bool,
}

impl GpuBackend {
    /// Encodes and submits a number of substeps of the program, and the requested copies.
    pub(super) fn submit(&mut self, substeps: u32, optional: Optional) -> Result<(), GpuError> {
        let mut encoder = super::encoder(&self.context, "step");
        let groups = self
            .uniforms
            .groups(&self.context, &self.pipelines, &self.arenas)?;
        {
            let descriptor = ComputePassDescriptor {
                label: Some("step"),
                timestamp_writes: self.timestamps.as_ref().map(Timestamps::writes),
            };
            let mut encoding = Encoding {
                pass: encoder.begin_compute_pass(&descriptor),
                pipelines: &self.pipelines,
                uniforms: &groups[1],
                last: None,
            };
            encoding.pass.set_bind_group(0, &groups[0], &[]);
            if optional.sums {
                encoding.dispatches(self.program.sums.iter(), 0);
            }
            if optional.guard {
                encoding.dispatches(self.program.guard[0].iter(), 0);
            }
            encoding.dispatches(self.program.near.iter(), 0);
            encoding.program(&self.program, substeps);
            if optional.guard {
                encoding.dispatches(self.program.guard[1].iter(), 0);
            }
            encoding.dispatches(self.program.embedding.iter(), 0);
            if optional.bounds {
                encoding.dispatches(self.program.bounds.iter().flatten(), 0);
            }
        }
        if let Some(timestamps) = &mut self.timestamps {
            timestamps.request(&self.context, &mut encoder, self.frame)?;
        }
        let slots = std::mem::take(&mut self.program_of);
        let done = self.request_copies(&slots, &mut encoder);
        self.program_of = slots;
        done?;
        let submission = self.context.queue().submit([encoder.finish()]);
        self.in_flight.rotate_left(1);
        self.in_flight[FRAMES_IN_FLIGHT - 1] = Some(submission.clone());
        self.context.check()?;
        if let Some(timestamps) = &mut self.timestamps {
            timestamps.submitted(&submission);
        }
        for i in 0..self.program_of.len() {
            let slot = self.program_of[i];
            if let Some(resident) = self.resident_at(slot) {
                resident.state.submitted(&submission);
                resident.report.submitted(&submission);
                resident.motion.submitted(&submission);
            }
        }
        Ok(())
    }

    /// Blocks until fewer than [`FRAMES_IN_FLIGHT`] frames are pending.
    pub(super) fn follow_up(&mut self) -> Result<(), GpuError> {
        match self.in_flight[0].take() {
            Some(oldest) => self.context.wait(oldest),
            None => Ok(()),
        }
    }

    fn request_copies(
        &mut self,
        slots: &[u32],
        encoder: &mut wgpu::CommandEncoder,
    ) -> Result<(), GpuError> {
        for &slot in slots {
            let Some(resident) = self.resident_at(slot) else {
                continue;
            };
            let state = std::mem::take(&mut resident.wants_state);
            let report = std::mem::take(&mut resident.wants_report);
            let motion = std::mem::take(&mut resident.wants_motion);
            if state {
                self.request_state(slot as usize, encoder)?;
            }
            if report {
                self.request_report(slot as usize, encoder)?;
            }
            if motion {
                self.request_motion(slot as usize, encoder)?;
            }
        }
        Ok(())
    }
}

/// A compute pass under construction.
struct Encoding<'a> {
    pass: ComputePass<'a>,
    pipelines: &'a Pipelines,
    uniforms: &'a BindGroup,
    /// Current kernel.
    last: Option<Kernel>,
}

impl Encoding<'_> {
    fn program(&mut self, program: &Program, substeps: u32) {
        let begun =
            |dispatch: &&Dispatch| program.passes[dispatch.pass as usize].substep < substeps;
        self.dispatches(program.whole.iter().filter(begun), 0);
        for substep in 0..substeps {
            self.dispatches(program.prologue.iter(), substep);
            for _ in 0..program.iterations {
                self.dispatches(program.iteration.iter(), substep);
                for _ in 1..program.contact_rounds {
                    self.dispatches(program.contact_round.iter(), substep);
                }
            }
            self.dispatches(program.epilogue.iter(), substep);
        }
    }

    fn dispatches<'d>(&mut self, list: impl Iterator<Item = &'d Dispatch>, substep: u32) {
        for dispatch in list {
            let Some(pipeline) = self.pipelines.get(dispatch.kernel) else {
                continue;
            };
            if self.last != Some(dispatch.kernel) {
                self.pass.set_pipeline(pipeline);
                self.last = Some(dispatch.kernel);
            }
            let record = dispatch.pass + if dispatch.by_substep { substep } else { 0 };
            let offset = record * PASS_STRIDE;
            self.pass.set_bind_group(1, self.uniforms, &[offset]);
            let [x, y] = workgroups(dispatch.groups);
            self.pass.dispatch_workgroups(x, y, 1);
        }
    }
}
