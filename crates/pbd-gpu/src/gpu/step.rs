//! Steps all bodies by one frame, with a submission for those with the same plan.

use super::backend::{GpuBackend, GpuBody, find_mut};
use super::error::GpuError;
use super::layout::FrameUniform;
use super::program::{Program, Stepped};
use super::records::frame_record;
use super::solid::DeviceSolid;
use super::stats::{GpuStats, Schedule};
use super::submit::Optional;
use crate::error::StepError;
use crate::solver::Solver;
use crate::step::constants::StepConstants;
use crate::step::guard::GuardInputs;
use crate::step::params::SolverParams;
use crate::step::prepare::FrameInputs;
use crate::step::rounds::contact_rounds;
use bytemuck::Zeroable;
use incise_mesh::index_u32;

/// Maximum number of dispatches of a frame, which bounds the CPU memory of a submission.
const MAX_DISPATCHES: u32 = 1 << 20;

impl GpuBackend {
    /// Submits one frame of `dt` \[s\] for the bodies and returns without waiting for it.
    ///
    /// Blocks while three submissions are in flight. Each body is stepped independently. Bodies
    /// with the same number and length of [substeps](SolverParams::substeps), with contacts or
    /// without, share a submission.
    ///
    /// # Errors
    /// [`GpuError`] if a parameter is out of range, a solid has contacts, a body is unknown, has
    /// another solver or was edited without [`GpuBackend::update`], the frame needs too many
    /// dispatches, or the GPU fails. No body is stepped then, except in an earlier submission.
    /// [`GpuBackend::read`] reports positions that are not finite.
    pub fn step<'a>(
        &mut self,
        bodies: impl IntoIterator<Item = (GpuBody, &'a mut Solver)>,
        dt: f32,
        params: &SolverParams,
    ) -> Result<&GpuStats, GpuError> {
        params.check(dt)?;
        if !params.is_supported_on_gpu() {
            return Err(StepError::UnsupportedOnGpu.into());
        }
        self.context.check()?;
        let needed = |(body, solver): (GpuBody, &'a mut Solver)| {
            let (substeps, time_left) = solver.substeps_of(dt, params);
            let substeps = substeps.divided(solver.needed_parts(substeps.h, params));
            let press = solver.contacts().press();
            let contact_rounds = contact_rounds(substeps.h, press, params.gravity);
            let inputs = FrameInputs {
                dt,
                substeps,
                has_contacts: !solver.contacts().is_empty(),
                contact_rounds,
                reaches_colliders: true,
            };
            SteppedBody {
                body,
                solver,
                inputs,
                time_left,
            }
        };
        let mut bodies: Vec<_> = bodies.into_iter().map(needed).collect();
        if bodies
            .iter()
            .any(|body| body.solver.is_solid() && body.inputs.has_contacts)
        {
            return Err(StepError::UnsupportedOnGpu.into());
        }
        bodies.sort_by_key(SteppedBody::key);
        let mut stats = GpuStats::default();
        if bodies.is_empty() {
            self.submit_bodies(&mut [], params, &mut stats)?;
        }
        for equal in bodies.chunk_by_mut(|a, b| a.key() == b.key()) {
            self.submit_bodies(equal, params, &mut stats)?;
        }
        self.stats = stats;
        Ok(&self.stats)
    }

    /// Submits one frame of bodies of equal [key](SteppedBody::key); adds its work to `stats`.
    fn submit_bodies(
        &mut self,
        bodies: &mut [SteppedBody<'_>],
        params: &SolverParams,
        stats: &mut GpuStats,
    ) -> Result<(), GpuError> {
        let mut frame = FrameUniform::zeroed();
        self.stepped.clear();
        let (mut prepared, mut has_guard, mut has_sums) = (Ok(()), false, false);
        let substeps = bodies.first().map_or(0, |body| body.inputs.substeps.count);
        for stepped in bodies {
            let (body, solver) = (stepped.body, &mut *stepped.solver);
            prepared = self.send_small_changes(body, solver);
            prepared = prepared.and_then(|()| self.check_loops(body, solver));
            if prepared.is_err() {
                break;
            }
            solver.begin_pins();
            let constants = match solver.prepare(stepped.inputs, params) {
                Ok(constants) => constants,
                Err(error) => {
                    prepared = Err(error.into());
                    break;
                }
            };
            solver.set_time_left(stepped.time_left);
            let guard = solver.prepare_guard(&constants, false, params);
            if let Some(guard) = &guard {
                solver.follow_guard(guard);
            }
            has_guard |= guard.is_some();
            frame = FrameUniform {
                measures_motion: frame.measures_motion,
                ..frame_record(&constants, params)
            };
            if solver.is_solid() {
                // Its prediction repeats forces instead of displacements.
                frame.lift = 0.0;
            }
            self.update_body(body, solver, &constants, guard.as_ref(), stats)?;
            self.stepped.push(body.slot());
            let resident = self.resident(body)?;
            frame.measures_motion |= u32::from(resident.measures_motion);
            let solid = resident.body.solid.as_ref();
            has_sums |= solid.is_some_and(DeviceSolid::needs_sums);
        }
        // Also after an error, since the queued edits are for ranges that may be freed before the
        // next step.
        self.flush()?;
        prepared?;
        self.program_is_stale |=
            self.program.substeps < substeps || self.program_of != self.stepped;
        stats.program_built |= self.program_is_stale;
        self.update_program(substeps)?;
        self.uniforms
            .send_frame(&self.context, &mut self.uploads, frame);
        let dispatches = self.program.dispatches(substeps, true);
        if dispatches > MAX_DISPATCHES {
            let limit = MAX_DISPATCHES;
            return Err(GpuError::TooManyDispatches { dispatches, limit });
        }
        let wants_bounds = self.wants_bounds();
        if wants_bounds {
            self.make_bounds()?;
        }
        if has_guard {
            self.make_guard()?;
        }
        if has_sums {
            self.make_sums()?;
        }
        self.frame += 1;
        self.note_frame();
        stats.dispatches += self.program.dispatches(substeps, wants_bounds);
        stats.dispatches += 2 * u32::from(has_guard);
        if has_sums {
            stats.dispatches += index_u32(self.program.sums.len());
        }
        let optional = Optional {
            sums: has_sums,
            guard: has_guard,
            bounds: wants_bounds,
        };
        self.submit(substeps, optional)?;
        self.end_sums();
        self.follow_up()?;
        stats.bytes_uploaded += self.uploads.take_bytes();
        stats.bytes_read += std::mem::take(&mut self.bytes_read);
        stats.kernels_compiled += self.pipelines.take_compiled();
        Ok(())
    }

    /// Computes the box of a body without a pending report.
    pub(super) fn reduce_bounds(&mut self, slot: u32) -> Result<(), GpuError> {
        let Some(resident) = self.resident_at(slot) else {
            return Err(GpuError::UnknownBody);
        };
        resident.wants_report = true;
        // Requests of boxes are for the end of the next step.
        let wants_state = std::mem::take(&mut resident.wants_state);
        let wants_motion = std::mem::take(&mut resident.wants_motion);
        // Zero substeps skip the other dispatches of the program.
        let lanes = self.pipelines.lanes;
        let count = self.resident_at(slot).map_or(0, |r| r.body.vertex_count);
        self.program = Program::bounds_of(slot, count, lanes);
        self.program_of.clear();
        self.program_of.push(slot);
        self.program_is_stale = true;
        let made = self.make_program().and_then(|()| self.make_bounds());
        let optional = Optional {
            bounds: true,
            ..Optional::default()
        };
        let done = made.and_then(|()| self.submit(0, optional));
        if let Some(resident) = self.resident_at(slot) {
            resident.wants_state = wants_state;
            resident.wants_motion = wants_motion;
        }
        done
    }

    /// Checks that an adapter which limits loops can run those of a solid that are not shared.
    fn check_loops(&self, body: GpuBody, solver: &Solver) -> Result<(), GpuError> {
        let body = &self.resident(body)?.body;
        let Some(solid) = &body.solid else {
            return Ok(());
        };
        let colliders = solver.constraints().colliders.records().len();
        let needed = solid.serial_loops(body.vertex_count, solver.pins().len(), colliders);
        if needed <= self.pipelines.lanes.rounds {
            return Ok(());
        }
        Err(GpuError::LoopsTooShort {
            adapter: self.adapter().name.clone(),
        })
    }

    /// Uploads the record of a body and counts its work.
    fn update_body(
        &mut self,
        body: GpuBody,
        solver: &Solver,
        constants: &StepConstants,
        guard: Option<&GuardInputs>,
        stats: &mut GpuStats,
    ) -> Result<(), GpuError> {
        let lanes = self.pipelines.lanes;
        let resident = self.resident_mut(body)?;
        let before = resident.body.schedule;
        let stale = resident.plan.generation() != solver.plan().generation();
        if stale {
            resident.plan.clone_from(solver.plan());
        }
        let rounds = (resident.body).rounds(lanes.whole_body, solver.plan());
        if resident.body.schedule == Schedule::WholeBody && rounds > lanes.rounds {
            // A substep exceeds the limit of loops. Its runs stay as they are.
            resident.body.schedule = Schedule::Patches;
        }
        match resident.body.schedule {
            Schedule::WholeBody => stats.whole_bodies += 1,
            Schedule::Patches => stats.patch_bodies += 1,
        }
        let times = u64::from(constants.substeps) * u64::from(solver.plan().iterations());
        let there_and_back = 2 * times;
        stats.stretch_projections += there_and_back * solver.stretch().len() as u64;
        stats.bending_projections +=
            there_and_back * solver.bending().map_or(0, |set| set.len() as u64);
        stats.interior_spring_projections +=
            there_and_back * solver.interior_springs().map_or(0, |set| set.len() as u64);
        let contact_rounds = u64::from(solver.plan().contact_rounds());
        stats.volume_projections += times * contact_rounds * solver.volumes().pieces().len() as u64;
        let cells = solver.interior().map_or(0, |interior| interior.cells.len());
        stats.cell_projections += times * cells as u64;
        let schedule = resident.body.schedule;
        self.program_is_stale |= stale || schedule != before;
        let Self {
            context,
            arenas,
            uploads,
            ..
        } = self;
        let resident = find_mut(&mut self.residents, body)?;
        self.program_is_stale |= resident
            .body
            .update_attachments(context, arenas, uploads, solver)?;
        self.program_is_stale |= resident
            .body
            .update_contacts(context, arenas, uploads, solver)?;
        self.program_is_stale |= resident
            .body
            .update_colliders(context, arenas, uploads, solver)?;
        if let (Some(solid), Some(interior)) = (&mut resident.body.solid, solver.interior()) {
            let starts = &interior.pin_starts;
            solid.update_pin_starts(context, arenas, uploads, starts)?;
        }
        if guard.is_some() {
            (resident.body).update_guard(context, arenas, uploads, solver);
        }
        resident
            .body
            .update_record(context, arenas, uploads, constants, guard);
        Ok(())
    }

    /// Rebuilds the program if it is outdated.
    fn update_program(&mut self, substeps: u32) -> Result<(), GpuError> {
        if !self.program_is_stale {
            return Ok(());
        }
        let residents = &self.residents;
        let stepped: Vec<Stepped<'_>> = (self.stepped.iter())
            .filter_map(|&slot| {
                let resident = residents[slot as usize].as_ref()?;
                Some(Stepped {
                    slot,
                    body: &resident.body,
                    plan: &resident.plan,
                })
            })
            .collect();
        self.program = Program::compile(&stepped, substeps, self.pipelines.lanes);
        self.program_of.clone_from(&self.stepped);
        self.make_program()?;
        self.program_is_stale = false;
        Ok(())
    }

    /// Uploads the parameters of the program and creates its pipelines.
    fn make_program(&mut self) -> Result<(), GpuError> {
        // After an error the next step tries again.
        self.program_is_stale = true;
        for kernel in self.program.kernels() {
            self.pipelines.make(&self.context, kernel)?;
        }
        self.uniforms
            .send_program(&self.context, &mut self.uploads, &self.program)
    }

    /// Creates the pipelines for bounding boxes, which most scenes never need.
    fn make_bounds(&mut self) -> Result<(), GpuError> {
        for kernel in self.program.kernels_of_bounds() {
            self.pipelines.make(&self.context, kernel)?;
        }
        Ok(())
    }

    /// Creates the pipelines of the guard.
    fn make_guard(&mut self) -> Result<(), GpuError> {
        for dispatch in self.program.guard.iter().flatten() {
            self.pipelines.make(&self.context, dispatch.kernel)?;
        }
        Ok(())
    }

    /// Creates the pipelines of the sums of forces.
    fn make_sums(&mut self) -> Result<(), GpuError> {
        for dispatch in &self.program.sums {
            self.pipelines.make(&self.context, dispatch.kernel)?;
        }
        Ok(())
    }

    /// Records that the forces of the stepped solids are those of the frame.
    fn end_sums(&mut self) {
        let slots = std::mem::take(&mut self.program_of);
        for &slot in &slots {
            if let Some(resident) = self.resident_at(slot)
                && let Some(solid) = &mut resident.body.solid
            {
                solid.submitted();
            }
        }
        self.program_of = slots;
    }

    /// Returns true if the box of a stepped body is requested.
    fn wants_bounds(&self) -> bool {
        let residents = self.program_of.iter();
        let mut residents = residents.filter_map(|&slot| self.residents[slot as usize].as_ref());
        residents.any(|resident| resident.wants_report || resident.wants_motion)
    }

    /// Sets the frame number of the stepped bodies.
    fn note_frame(&mut self) {
        let frame = self.frame;
        let slots = std::mem::take(&mut self.program_of);
        for &slot in &slots {
            if let Some(resident) = self.resident_at(slot) {
                resident.frame = frame;
            }
        }
        self.program_of = slots;
    }
}

/// A body of a frame.
struct SteppedBody<'a> {
    body: GpuBody,
    solver: &'a mut Solver,
    inputs: FrameInputs,
    /// Time that the frame leaves to the next one, in substeps.
    time_left: f64,
}

impl SteppedBody<'_> {
    /// Returns substeps, rounds, whether it has contacts and whether it is a solid: bodies of a
    /// submission agree in them.
    fn key(&self) -> [u32; 5] {
        let substeps = self.inputs.substeps;
        let has_contacts = u32::from(self.inputs.has_contacts);
        [
            u32::from(self.solver.is_solid()),
            substeps.count,
            substeps.h.to_bits(),
            self.inputs.contact_rounds,
            has_contacts,
        ]
    }
}
