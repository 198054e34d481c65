//! Execution of the plans of an island's bodies on the CPU: one kernel per pass, in lockstep.
//!
//! Every body runs the passes of its own plan. Contacts may belong to several bodies: they are
//! projected once for the island, when all bodies have reached the contact passes.

use crate::constraints::batches::{Batch, BatchId, BendingSet, ConstraintSet, StretchSet};
use crate::constraints::contacts::{ContactRecord, ContactSet};
use crate::kernels::bending::Bending;
use crate::kernels::block::dispatch;
use crate::kernels::particle_state::{ParticleState, ParticleStates};
use crate::kernels::stretch::Stretch;
use crate::kernels::volume::{self, VolumeScratch};
use crate::kernels::{
    attachments, colliders, contact_features, contacts, ground, integrate, pins, predict,
};
use crate::parallel::passes::{is_shared, sweep_color, sweep_patches};
use crate::parallel::{Leader, with_team};
use crate::step::body::Body;
use crate::step::constants::{Projection, StepConstants};
use crate::step::island::{IslandBodies, Member};
use crate::step::params::StepStats;
use crate::step::plan::{ConstraintKind, Pass, StepPlan};
use crate::step::sweep::{Kernel, Sweep};
use pulp::{Arch, NullaryFnOnce};
use std::num::NonZeroUsize;

/// Memory of a frame on the CPU, reused between frames.
#[derive(Debug, Default)]
pub(crate) struct StepScratch {
    /// States of the particles, body after body, shape [vertex slots of the island].
    particles: Vec<ParticleState>,
    /// Displacements before the current iteration; empty without a residual.
    before: Vec<[f32; 4]>,
    volumes: VolumeScratch,
}

impl Clone for StepScratch {
    /// Returns empty scratch memory.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl StepScratch {
    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        self.particles.capacity() + self.before.capacity() + self.volumes.capacity()
    }
}

/// A body, by index, with positions that are not finite after a substep.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NonFinite {
    pub(crate) body: usize,
    pub(crate) substep: u32,
}

/// Returns the plan and the arrays of a body.
fn parts<'a>(
    bodies: &'a mut dyn IslandBodies,
    i: usize,
    member: &Member,
) -> (&'a StepPlan, Body<'a>) {
    let (solver, surface) = bodies.get(i);
    let (particles, constraints, step) = solver.step_parts();
    let mut body = Body::new(particles, constraints, surface);
    if member.has_own_pins {
        body.pins = step.history.pins();
    }
    #[cfg(feature = "global")]
    {
        body.global = step.global.as_deref_mut();
    }
    (&step.plan, body)
}

/// Steps the bodies of an island by a number of substeps, in lockstep.
///
/// The results have the same bits on every machine and any number of threads. The global step
/// depends on the instruction set.
pub(crate) fn execute(
    bodies: &mut dyn IslandBodies,
    members: &mut [Member],
    contacts: &mut ContactSet,
    substeps: u32,
    scratch: &mut StepScratch,
) -> Result<(), NonFinite> {
    let StepScratch {
        particles,
        before,
        volumes: volume_scratch,
    } = scratch;
    particles.clear();
    let mut threads = NonZeroUsize::new(1);
    for (i, member) in members.iter_mut().enumerate() {
        let (_, body) = parts(bodies, i, member);
        member.first = particles.len();
        member.stats = StepStats {
            substeps,
            ..StepStats::default()
        };
        let at_start = |&x: &[f32; 4]| ParticleState { x, d: [0.0; 4] };
        particles.extend(body.positions.iter().map(at_start));
        if has_shared_pass(&body) {
            threads = member.constants.threads;
        }
    }
    let arch = Arch::new();
    let done = with_team(threads, |leader| {
        arch.dispatch(Frame {
            bodies: &mut *bodies,
            members,
            contacts,
            substeps,
            particles: ParticleStates::new(particles),
            before,
            volume_scratch,
            leader,
            arch,
        })
    });
    for (i, member) in members.iter().enumerate() {
        let (_, body) = parts(bodies, i, member);
        for (x, state) in body.positions.iter_mut().zip(&particles[member.first..]) {
            *x = state.x;
        }
    }
    done
}

/// Returns whether several threads can run a pass of the body.
fn has_shared_pass(body: &Body<'_>) -> bool {
    let edges = [Some(&*body.stretch), body.interior_springs.as_deref()];
    let edges = edges.into_iter().flatten().flat_map(StretchSet::batches);
    let bending = body.bending.as_deref().map_or(&[][..], BendingSet::batches);
    let counts = edges.map(Batch::len).chain(bending.iter().map(Batch::len));
    body.patches.are_shared() || counts.chain([body.volumes.spokes.len()]).any(is_shared)
}

/// The execution of one frame.
///
/// Passes over vertices are inlined into [`NullaryFnOnce::call`], so that they are compiled for the
/// instruction set that is detected at run time. Those over constraints are called.
struct Frame<'a, 'b> {
    bodies: &'a mut dyn IslandBodies,
    members: &'a mut [Member],
    contacts: &'a mut ContactSet,
    substeps: u32,
    /// States of the island.
    particles: ParticleStates<'a>,
    before: &'a mut Vec<[f32; 4]>,
    volume_scratch: &'a mut VolumeScratch,
    leader: &'a mut Leader<'b>,
    arch: Arch,
}

/// Passes over the contacts of the island, between which the bodies run their own passes.
const CONTACT_PASSES: [&[Option<Pass>]; 3] = [
    &[None, Some(Pass::ContactFeatures), None],
    &[
        None,
        Some(Pass::ContactsBeforeVolumes),
        Some(Pass::Contacts),
        None,
    ],
    &[None, Some(Pass::ContactRecovery), None],
];

impl NullaryFnOnce for Frame<'_, '_> {
    type Output = Result<(), NonFinite>;

    #[inline(always)]
    fn call(mut self) -> Self::Output {
        // The bodies have iterations and residual in common.
        let Some(first) = self.members.first().copied() else {
            return Ok(());
        };
        let iterations = parts(self.bodies, 0, &first).0.iterations();
        let has_contacts = !self.contacts.is_empty();
        // The prologue, the iterations, the epilogue.
        let last = iterations + 1;
        for substep in 0..self.substeps {
            self.contacts.reset_friction();
            let mut part = 0;
            while part <= last {
                let kind = match part {
                    0 => 0,
                    part if part < last => 1,
                    _ => 2,
                };
                let stages = if has_contacts {
                    CONTACT_PASSES[kind]
                } else {
                    &[None, None]
                };
                for ends in stages.windows(2) {
                    self.run_stage(part, [ends[0], ends[1]], substep)?;
                    if let Some(pass) = ends[1] {
                        self.run_contacts(pass, iterations > 1, substep);
                    }
                }
                part += 1;
                if let Some(residual) = first.constants.residual
                    && part < last
                {
                    let moved = max_change(self.particles, self.before);
                    if part > 1 && moved < residual {
                        for member in &mut *self.members {
                            member.stats.iterations_skipped += last - part;
                        }
                        part = last;
                    }
                }
            }
        }
        Ok(())
    }
}

impl Frame<'_, '_> {
    /// Runs the passes of a part of every body's plan that lie strictly between two passes.
    #[inline(always)]
    fn run_stage(
        &mut self,
        part: u32,
        [after, before]: [Option<Pass>; 2],
        substep: u32,
    ) -> Result<(), NonFinite> {
        for (i, member) in self.members.iter_mut().enumerate() {
            let (plan, body) = parts(self.bodies, i, member);
            let passes = plan.part(part);
            let from = passes.partition_point(|pass| after.is_some_and(|after| *pass <= after));
            let to = passes.partition_point(|pass| before.is_none_or(|before| *pass < before));
            let mut step = BodyStep {
                particles: self.particles.slice(member.first, body.positions.len()),
                body,
                constants: &member.constants,
                volume_scratch: &mut *self.volume_scratch,
                leader: &mut *self.leader,
                arch: self.arch,
                substeps_left: self.substeps - substep,
                stats: &mut member.stats,
                lowest: &mut member.lowest,
            };
            let is_same_layer = |a: &Pass, b: &Pass| {
                a.patch_layer().is_some() && a.patch_layer() == b.patch_layer()
            };
            for passes in passes[from..to].chunk_by(is_same_layer) {
                let pass = passes[0];
                if pass.is_ground() && *step.lowest > step.constants.ground {
                    step.stats.ground_passes_skipped += 1;
                    continue;
                }
                step.stats.passes += u32::try_from(passes.len()).unwrap_or(u32::MAX);
                match pass.patch_layer() {
                    Some(layer) => step.project_patches(layer),
                    None if step.run(pass) => {}
                    None => return Err(NonFinite { body: i, substep }),
                }
            }
        }
        Ok(())
    }

    /// Runs a pass over the contacts of the island.
    fn run_contacts(&mut self, pass: Pass, accumulates: bool, substep: u32) {
        let has_volumes = self.members.iter().any(|member| member.has_volumes);
        let Some(first) = self.members.first_mut() else {
            return;
        };
        let (particles, h) = (self.particles, first.constants.h);
        first.stats.passes += 1;
        match pass {
            Pass::ContactFeatures => {
                for color in &mut self.contacts.colors {
                    contact_features::contact_features(particles, color);
                }
            }
            Pass::ContactRecovery => {
                let mut change = 0.0;
                let (serial, colors) = split_serial(&self.contacts.colors);
                for color in colors {
                    change += contacts::recover_contacts(particles, color, h);
                }
                for contact in serial.chunks(1) {
                    change += contacts::recover_contacts(particles, contact, h);
                }
                for member in &mut *self.members {
                    member.stats.max_displacement += change;
                }
            }
            Pass::ContactsBeforeVolumes if !has_volumes => first.stats.passes -= 1,
            _ => {
                first.stats.contact_projections += self.contacts.len() as u64;
                let time = (substep + 1) as f32 * h;
                for color in &mut self.contacts.colors {
                    contacts::contacts(particles, color, accumulates, time);
                }
            }
        }
    }
}

/// Returns the contacts without a color, then those of each color.
fn split_serial(colors: &[Vec<ContactRecord>]) -> (&[ContactRecord], &[Vec<ContactRecord>]) {
    match colors.split_last() {
        Some((serial, colors)) => (serial, colors),
        None => (&[], &[]),
    }
}

/// A part of a substep of one body.
struct BodyStep<'a, 'b, 'c> {
    /// States of the body.
    particles: ParticleStates<'a>,
    body: Body<'b>,
    constants: &'a StepConstants,
    volume_scratch: &'a mut VolumeScratch,
    leader: &'a mut Leader<'c>,
    arch: Arch,
    substeps_left: u32,
    stats: &'a mut StepStats,
    /// Minimum predicted height of the substep \[m\].
    lowest: &'a mut f32,
}

/// Returns the largest change of a displacement along an axis since `before`, and updates `before`.
#[inline(always)]
fn max_change(now: ParticleStates<'_>, before: &mut Vec<[f32; 4]>) -> f32 {
    before.resize(now.iter().len(), [0.0; 4]);
    let mut max = [0.0_f32; 4];
    for (i, before) in before.iter_mut().enumerate() {
        let d = now.get(i).d;
        for k in 0..4 {
            let change = (d[k] - before[k]).abs();
            // Ignores NaN, which is an error at the end of the substep.
            max[k] = if change > max[k] { change } else { max[k] };
        }
        *before = d;
    }
    max.into_iter().fold(0.0, f32::max)
}

/// Projects a batch and returns its number of constraints; the overflow is projected serially.
fn project_batch<K: Kernel<N>, const N: usize>(
    (leader, arch): (&mut Leader<'_>, Arch),
    particles: ParticleStates<'_>,
    set: Option<&mut ConstraintSet<N>>,
    batch: BatchId,
    projection: Projection,
) -> u64 {
    let Some(set) = set else { return 0 };
    let part = set
        .batch_mut(batch.number())
        .part(projection.accumulates_lambda);
    let count = part.vertices.len() as u64;
    match batch {
        BatchId::Color(_) => sweep_color::<K, N>(leader, arch, particles, part, projection),
        BatchId::Overflow => {
            dispatch(arch, Sweep::<K, N>::serial(particles, part, projection));
        }
    }
    count
}

/// Runs a pass of the global step.
#[cfg(feature = "global")]
fn global_pass(
    particles: ParticleStates<'_>,
    body: &mut Body<'_>,
    constants: &StepConstants,
    pass: Pass,
) {
    let sets = crate::global::EnergySets {
        stretch: body.stretch,
        bending: body.bending.as_deref(),
        interior_springs: body.interior_springs.as_deref(),
    };
    if let Some(global) = &mut body.global {
        if pass == Pass::BeginGlobal {
            global.begin(particles, sets, constants);
        } else {
            global.iterate(particles, sets, constants);
        }
    }
}

impl BodyStep<'_, '_, '_> {
    /// Projects the constraints of all patches of a layer.
    fn project_patches(&mut self, layer: usize) {
        let patches = self.body.patches.of_layer_mut(layer);
        let by = (self.constants.stretch, self.constants.bending);
        sweep_patches(self.leader, self.arch, self.particles, patches, by);
        for patch in patches {
            self.stats.stretch_projections += patch.stretch.len() as u64;
            self.stats.bending_projections += patch.bending.len() as u64;
        }
    }

    /// Runs a pass; returns false if a position is not finite.
    #[inline(always)]
    fn run(&mut self, pass: Pass) -> bool {
        let Self {
            constants,
            body,
            arch,
            leader,
            stats,
            ..
        } = self;
        let (particles, v) = (self.particles, &mut *body.velocities);
        match pass {
            Pass::Predict => *self.lowest = predict::predict(particles, v, constants),
            Pass::Pins => pins::pins(particles, body.pins, self.substeps_left),
            Pass::LongRangeAttachments => {
                attachments::attachments(particles, body.attachments, constants.h)
            }
            Pass::ResetMultipliers => {
                if constants.stretch.accumulates_lambda {
                    body.stretch.all_mut().for_each(Batch::reset_multipliers);
                }
                if constants.bending.accumulates_lambda {
                    let sets = body.bending.iter_mut();
                    sets.flat_map(|set| set.all_mut())
                        .for_each(Batch::reset_multipliers);
                }
                if constants.interior_springs.accumulates_lambda {
                    let sets = body.interior_springs.iter_mut();
                    sets.flat_map(|set| set.all_mut())
                        .for_each(Batch::reset_multipliers);
                }
                let [stretch, bending] = [constants.stretch, constants.bending];
                (body.patches)
                    .reset_multipliers(stretch.accumulates_lambda, bending.accumulates_lambda);
                if constants.volume.accumulates_lambda {
                    body.volumes.reset_multipliers();
                }
            }
            Pass::Project { kind, batch } => {
                let team = (&mut **leader, *arch);
                match kind {
                    ConstraintKind::Stretch => {
                        let (set, by) = (Some(&mut *body.stretch), constants.stretch);
                        stats.stretch_projections +=
                            project_batch::<Stretch, 2>(team, particles, set, batch, by);
                    }
                    ConstraintKind::Bending => {
                        let (set, by) = (body.bending.as_deref_mut(), constants.bending);
                        stats.bending_projections +=
                            project_batch::<Bending, 4>(team, particles, set, batch, by);
                    }
                    ConstraintKind::InteriorSpring => {
                        let set = body.interior_springs.as_deref_mut();
                        let by = constants.interior_springs;
                        stats.interior_spring_projections +=
                            project_batch::<Stretch, 2>(team, particles, set, batch, by);
                    }
                }
            }
            Pass::BeginGlobal | Pass::GlobalIteration => {
                #[cfg(feature = "global")]
                global_pass(particles, body, constants, pass);
                stats.global_iterations += u32::from(pass == Pass::GlobalIteration);
            }
            // `Frame` projects the contacts of the island.
            Pass::ContactFeatures
            | Pass::ContactsBeforeVolumes
            | Pass::Contacts
            | Pass::ContactRecovery => {}
            Pass::Volumes => {
                #[cfg(feature = "global")]
                if let Some(global) = &mut body.global {
                    global.hold_obstructed(particles);
                }
                stats.volume_projections += body.volumes.pieces().len() as u64;
                let piece = (body.topology, &mut *body.volumes);
                let change = volume::volumes(
                    (leader, *arch),
                    particles,
                    piece,
                    (constants.volume, constants.ground),
                    self.volume_scratch,
                );
                #[cfg(feature = "global")]
                if let Some(global) = &mut body.global {
                    global.mark_unobstructed(particles);
                }
                stats.max_displacement += change;
                stats.max_substep_displacement = stats.max_substep_displacement.max(change);
            }
            Pass::Colliders => {
                colliders::colliders(particles, v, body.colliders, constants.friction);
            }
            Pass::GroundBeforeVolumes => {
                stats.ground_passes += 1;
                let vertices = body.volumes.spokes.iter().map(|spoke| spoke.vertex);
                let ground = (constants.ground, constants.friction);
                ground::ground_of(vertices, particles, v, ground);
            }
            Pass::Ground => {
                stats.ground_passes += 1;
                ground::ground(particles, v, constants.ground, constants.friction);
            }
            Pass::Integrate => match integrate::integrate(particles, v, constants) {
                Some(change) => {
                    stats.max_displacement += change;
                    stats.max_substep_displacement = stats.max_substep_displacement.max(change);
                }
                None => return false,
            },
        }
        true
    }
}
