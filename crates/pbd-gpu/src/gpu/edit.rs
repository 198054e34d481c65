//! Uploads edits of the CPU copies of bodies: topology, constraints, pins, velocities.

use super::backend::{GpuBackend, GpuBody, find_mut, number};
use super::body::{Host, MOTIONS, POSITIONS};
use super::error::GpuError;
use super::layout::Report;
use super::read::report_part;
use super::shaders::LEAVES;
use super::stats::Schedule;
use crate::error::StepError;
use crate::follow::changes::Changes;
use crate::solver::Solver;
use crate::step::plan::StepPlan;
use incise_mesh::Surface;

impl GpuBackend {
    /// Uploads the edits of the CPU copy since the last call, and nothing else.
    ///
    /// The CPU copy must have been up to date before the edit, see [`GpuBackend::read`]. A solver
    /// other than the previous one, such as a clone, is uploaded whole and replaces it.
    ///
    /// The nodes of a solid follow positions and velocities of vertices that were set since, as in
    /// its next step on the CPU. Its inside is uploaded whole.
    ///
    /// # Errors
    /// [`GpuError::UnknownBody`]; [`GpuError`] if the body does not fit in GPU memory. The CPU copy
    /// stays valid; the next call uploads everything.
    pub fn update(
        &mut self,
        body: GpuBody,
        surface: &Surface,
        solver: &mut Solver,
    ) -> Result<(), GpuError> {
        check_slots(surface, solver)?;
        let resident = self.resident_mut(body)?;
        if resident.follower == 0 || !solver.is_followed_by(resident.follower) {
            resident.follower = number();
            solver.set_follower(resident.follower);
        }
        // Queued edits of other bodies must survive an error of this one.
        self.flush()?;
        if solver.is_solid() && solver.has_surface_changes() {
            solver.adopt_motion(surface);
            // Its inside is uploaded whole.
            solver.mark_all_changed();
        }
        solver.step_parts().1.update_pieces(surface);
        let mut changes = std::mem::take(&mut self.changes);
        solver.take_changes(&mut changes);
        let done = self.send_changes(body, surface, solver, &changes);
        self.changes = changes;
        if done.is_err() {
            self.uploads.clear();
            solver.mark_all_changed();
        }
        done
    }

    fn send_changes(
        &mut self,
        body: GpuBody,
        surface: &Surface,
        solver: &Solver,
        changes: &Changes,
    ) -> Result<(), GpuError> {
        self.context.check()?;
        self.frame += 1;
        let (frame, schedule) = (self.frame, self.schedule);
        let capacity = self.pipelines.capacity;
        let Self {
            context,
            arenas,
            uploads,
            residents,
            ..
        } = self;
        let resident = find_mut(residents, body)?;
        let host = Host { surface, solver };
        let leaves = if solver.volumes().pieces().is_empty() {
            0
        } else {
            LEAVES
        };
        let vertices = surface.positions().len() + leaves;
        let mut moved = false;
        if changes.everything {
            let has_patches = solver.constraints().patches.is_some();
            let schedule = if solver.is_solid() {
                Schedule::Patches
            } else {
                choose(schedule, vertices, capacity)
            };
            resident.body.set_schedule(schedule, has_patches);
            // The solver may be another one, with other generations of plans.
            resident.plan = StepPlan::default();
            let (buffer, offset, _) = report_part(arenas, body.slot());
            let report = Report::new(solver.budget().slack);
            uploads.send(context, buffer, offset, bytemuck::bytes_of(&report));
        } else if resident.body.schedule == Schedule::WholeBody && vertices > capacity as usize {
            let has_patches = solver.constraints().patches.is_some();
            resident.body.leave_workgroup(arenas, has_patches);
            moved = true;
        }
        moved |= resident
            .body
            .update(context, arenas, uploads, host, changes)?;
        if changes.pins || changes.everything {
            let pins = solver.pins();
            moved |= resident.body.update_pins(context, arenas, uploads, pins)?;
        }
        resident.frame = frame;
        resident.host = frame;
        self.program_is_stale |= moved;
        self.flush()
    }

    /// Uploads pins, masses and velocities, which do not need the surface.
    pub(super) fn send_small_changes(
        &mut self,
        body: GpuBody,
        solver: &mut Solver,
    ) -> Result<(), GpuError> {
        let follower = self.resident(body)?.follower;
        if !solver.is_followed_by(follower) {
            return Err(GpuError::ForeignSolver);
        }
        if solver.is_unchanged() {
            return Ok(());
        }
        if solver.has_surface_changes() {
            return Err(GpuError::StaleBody);
        }
        let Self {
            context,
            arenas,
            uploads,
            residents,
            changes,
            ..
        } = self;
        let resident = find_mut(residents, body)?;
        let gpu_body = &mut resident.body;
        solver.take_changes(changes);
        gpu_body.edit_masses(uploads, solver, &changes.masses);
        gpu_body.edit_velocities(uploads, solver, &changes.velocities);
        if !changes.velocities.is_empty() {
            // A pending readback does not include them.
            self.frame += 1;
            resident.frame = self.frame;
        }
        if changes.pins {
            let moved = gpu_body.update_pins(context, arenas, uploads, solver.pins());
            if moved.is_err() {
                // Only the pins, since positions on the CPU side may be outdated.
                solver.mark_pins_changed();
            }
            self.program_is_stale |= moved?;
        }
        Ok(())
    }

    /// Uploads the queued edits.
    pub(super) fn flush(&mut self) -> Result<(), GpuError> {
        let targets = [
            self.arenas.vertices.buffer(POSITIONS),
            self.arenas.vertices.buffer(MOTIONS),
            self.arenas.entries.buffer(0),
        ];
        self.uploads.flush(&self.context, targets)
    }
}

/// Returns the schedule of a body.
///
/// A body that fits in workgroup memory is stepped by one workgroup, with or without patches.
fn choose(forced: Option<Schedule>, vertices: usize, capacity: u32) -> Schedule {
    if forced == Some(Schedule::Patches) || vertices > capacity as usize {
        Schedule::Patches
    } else {
        Schedule::WholeBody
    }
}

pub(super) fn check_slots(surface: &Surface, solver: &Solver) -> Result<(), GpuError> {
    if surface.positions().len() == solver.masses().len() {
        return Ok(());
    }
    Err(GpuError::Step(StepError::SurfaceMismatch {
        surface: surface.positions().len(),
        solver: solver.masses().len(),
    }))
}
