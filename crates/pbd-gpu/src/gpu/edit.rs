//! How bodies on a device follow edits of the host.

use super::backend::{GpuBackend, GpuBody, find_mut, number};
use super::body::{Host, POSITIONS, VELOCITIES};
use super::error::GpuError;
use super::layout::Report;
use super::read::report_part;
use super::shaders::LEAVES;
use super::stats::Schedule;
use crate::changes::Changes;
use crate::error::StepError;
use crate::plan::StepPlan;
use crate::solver::Solver;
use incise_mesh::Surface;

impl GpuBackend {
    /// Sends what was edited on the host since the last call: a cut's vertices and constraints, pins,
    /// velocities. What was not touched is not sent. The host must have been up to date when it was
    /// edited, see [`GpuBackend::read`]. Another solver than the one before, a copy say, is taken over
    /// whole; the body follows that one from then on.
    ///
    /// # Errors
    /// [`GpuError::UnknownBody`]; [`GpuError`] when the device has no room for it. The host's copy is
    /// right then; the next call sends everything.
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
            solver.follow(resident.follower);
        }
        // What other bodies have noted is not to go down with this one's.
        self.flush()?;
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
        let vertices = surface.positions.len() + leaves;
        let mut moved = false;
        if changes.everything {
            let has_patches = solver.patches.is_some();
            resident.body.schedule = choose(schedule, has_patches, vertices, capacity);
            // The solver may be another one, whose plans have generations of their own.
            resident.plan = StepPlan::default();
            let (buffer, offset, _) = report_part(arenas, body.slot());
            let report = Report::new();
            uploads.send(context, buffer, offset, bytemuck::bytes_of(&report));
        } else if resident.body.schedule == Schedule::WholeBody && vertices > capacity as usize {
            // Its runs lie as passes by color expect them; the program is made anew for the longer ones.
            resident.body.schedule = Schedule::Colors;
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

    /// Sends what can be sent without the surface: pins, masses and velocities.
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
        if solver.changes_concern_surface() {
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
        let on_device = &mut resident.body;
        solver.take_changes(changes);
        on_device.edit_masses(uploads, solver, &changes.masses);
        on_device.edit_velocities(uploads, solver, &changes.velocities);
        if !changes.velocities.is_empty() {
            // A state that is on its way does not have them.
            self.frame += 1;
            resident.frame = self.frame;
        }
        if changes.pins {
            let moved = on_device.update_pins(context, arenas, uploads, solver.pins());
            if moved.is_err() {
                // Not all of the body: the host's positions may be older than the device's.
                solver.changes.pins();
            }
            self.program_is_stale |= moved?;
        }
        Ok(())
    }

    /// Writes the noted edits.
    pub(super) fn flush(&mut self) -> Result<(), GpuError> {
        let targets = [
            self.arenas.vertices.buffer(POSITIONS),
            self.arenas.vertices.buffer(VELOCITIES),
            self.arenas.entries.buffer(0),
        ];
        self.uploads.flush(&self.context, targets)
    }
}

/// The schedule of a body that takes the room of so many vertices: a workgroup steps what it can hold, unless it has patches, whose layers it
/// does not know.
fn choose(forced: Option<Schedule>, has_patches: bool, vertices: usize, capacity: u32) -> Schedule {
    let fits = !has_patches && vertices <= capacity as usize;
    match forced {
        Some(Schedule::Colors) => Schedule::Colors,
        _ if has_patches => Schedule::Patches,
        _ if fits => Schedule::WholeBody,
        _ => Schedule::Colors,
    }
}

pub(super) fn check_slots(surface: &Surface, solver: &Solver) -> Result<(), GpuError> {
    if surface.positions.len() == solver.mass.len() {
        return Ok(());
    }
    Err(GpuError::Step(StepError::SurfaceMismatch {
        surface: surface.positions.len(),
        solver: solver.mass.len(),
    }))
}
