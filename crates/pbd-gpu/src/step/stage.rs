//! [`Stage`]: the passes of each body of an island between two passes over its contacts.
//!
//! Bodies are independent within a stage. Threads share the passes of a large body. Small bodies
//! are shared as a whole: each one is stepped by one thread.

use crate::constraints::batches::{Batch, BendingSet, StretchSet};
use crate::kernels::particle_state::ParticleStates;
use crate::kernels::volume::{Round, VolumeScratch};
use crate::parallel::Leader;
use crate::parallel::passes::{are_cells_shared, is_shared};
use crate::solver::Solver;
use crate::step::body::Body;
use crate::step::body_step::BodyStep;
use crate::step::island::Member;
use crate::step::pass::Pass;
use crate::step::plan::StepPlan;
use incise_mesh::Surface;
use pulp::{Arch, NullaryFnOnce};
use std::cell::Cell;

/// A body of an island during some substeps.
#[derive(Debug)]
pub(crate) struct SteppedBody<'a> {
    /// Its index in the island.
    pub(crate) index: usize,
    pub(crate) plan: &'a StepPlan,
    pub(crate) arrays: Body<'a>,
    pub(crate) member: &'a mut Member,
    /// Whether several threads can run one of its passes.
    pub(crate) is_large: bool,
}

impl<'a> SteppedBody<'a> {
    /// Borrows the plan and the arrays of a member of an island.
    pub(crate) fn new(
        index: usize,
        member: &'a mut Member,
        solver: &'a mut Solver,
        surface: &'a mut Surface,
    ) -> Self {
        let (particles, constraints, step) = solver.step_parts();
        let mut arrays = Body::new(particles, constraints, surface);
        if member.has_own_pins {
            arrays.pins = step.history.pins();
        }
        if !member.reaches_colliders {
            arrays.colliders = &[];
        }
        Self {
            index,
            plan: &step.plan,
            is_large: has_shared_pass(&arrays),
            arrays,
            member,
        }
    }
}

/// Returns whether several threads can run a pass of a body.
fn has_shared_pass(body: &Body<'_>) -> bool {
    let edges = [Some(&*body.stretch), body.interior_springs.as_deref()];
    let edges = edges.into_iter().flatten().flat_map(StretchSet::batches);
    let bending = body.bending.as_deref().map_or(&[][..], BendingSet::batches);
    let counts = edges.map(Batch::len).chain(bending.iter().map(Batch::len));
    let cells = body
        .solid
        .as_ref()
        .map_or(&[][..], |solid| solid.cells.batches());
    body.patches.are_shared()
        || counts.chain([body.volumes.spokes.len()]).any(is_shared)
        || cells.iter().any(|batch| are_cells_shared(batch.len()))
}

/// The passes of a plan in an open interval between two passes, in one substep.
#[derive(Clone, Copy)]
pub(crate) struct Stage<'a> {
    /// The part: the prologue, an iteration or the epilogue.
    pub(crate) part: u32,
    pub(crate) round: Round,
    pub(crate) after: Option<Pass>,
    pub(crate) before: Option<Pass>,
    pub(crate) substep: u32,
    pub(crate) substeps_left: u32,
    /// States of the island.
    pub(crate) particles: ParticleStates<'a>,
    /// Displacements by constraints \[m\], shape [vertex slots of the island]; empty without
    /// a lift.
    pub(crate) corrections: &'a [Cell<[f32; 4]>],
    /// Vertices that a piece carries, shape [vertex slots of the island]; empty without contacts.
    pub(crate) carried: &'a [Cell<bool>],
    pub(crate) arch: Arch,
}

impl Stage<'_> {
    /// Runs the stage for a body; returns false if a position is not finite.
    pub(crate) fn run(
        self,
        body: &mut SteppedBody<'_>,
        leader: &mut Leader<'_>,
        volume_scratch: &mut VolumeScratch,
    ) -> bool {
        self.arch.dispatch(Run {
            stage: self,
            body,
            leader,
            volume_scratch,
        })
    }
}

/// A stage of one body.
///
/// Passes over vertices are inlined into [`NullaryFnOnce::call`], so that they are compiled for the
/// instruction set that is detected at run time. Those over constraints are called.
struct Run<'a, 'b, 'c, 'd> {
    stage: Stage<'a>,
    body: &'b mut SteppedBody<'c>,
    leader: &'b mut Leader<'d>,
    volume_scratch: &'b mut VolumeScratch,
}

impl NullaryFnOnce for Run<'_, '_, '_, '_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let stage = self.stage;
        let SteppedBody {
            plan,
            arrays: body,
            member,
            ..
        } = self.body;
        let passes = plan.part(stage.part);
        let is_later = |pass: &Pass| stage.after.is_none_or(|after| *pass > after);
        let is_earlier = |pass: &Pass| stage.before.is_none_or(|before| *pass < before);
        let from = passes.partition_point(|pass| !is_later(pass));
        let to = passes.partition_point(is_earlier);
        let count = body.positions.len();
        let vertices = member.first..member.first + count;
        let carried = member.first_vertex..member.first_vertex + count;
        let mut step = BodyStep {
            particles: stage.particles.slice(member.first, count),
            corrections: stage.corrections.get(vertices.clone()).unwrap_or_default(),
            carried: stage.carried.get(carried).unwrap_or_default(),
            body,
            constants: &member.constants,
            volume_scratch: self.volume_scratch,
            leader: self.leader,
            arch: stage.arch,
            substeps_left: stage.substeps_left,
            round: stage.round,
            time: time_after(stage.substep, member),
            stats: &mut member.stats,
            meets_collider: &mut member.meets_collider,
        };
        let is_same_layer = |a: &Pass, b: &Pass| {
            let of = |pass: &Pass| pass.patch_layer().map(|layer| (layer, pass.is_back()));
            of(a).is_some() && of(a) == of(b)
        };
        for passes in passes[from..to].chunk_by(is_same_layer) {
            let pass = passes[0];
            step.stats.passes += u32::try_from(passes.len()).unwrap_or(u32::MAX);
            match pass.patch_layer() {
                Some(layer) => step.project_patches(layer, pass.is_back()),
                None if step.run(pass) => {}
                None => return false,
            }
        }
        true
    }
}

/// Returns the time of the frame at the end of a substep \[s\].
pub(crate) fn time_after(substep: u32, member: &Member) -> f32 {
    (substep + 1) as f32 * member.constants.collider_step
}
