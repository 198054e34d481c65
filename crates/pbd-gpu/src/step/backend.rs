//! Execution of the plans of an island's bodies on the CPU: one kernel per pass, in lockstep.
//!
//! Every body runs the passes of its own plan. Contacts may belong to several bodies: they are
//! projected once for the island, when all bodies have reached the contact passes.

use crate::constraints::batches::{Batch, BendingSet, StretchSet};
use crate::constraints::contacts::{ContactRecord, ContactSet, UNCOLORED};
use crate::kernels::particle_state::{ParticleState, ParticleStates};
use crate::kernels::volume::{Round, VolumeScratch};
use crate::kernels::{contact_features, contacts};
use crate::parallel::passes::{is_shared, sweep_contacts};
use crate::parallel::{Leader, with_team};
use crate::step::body::Body;
use crate::step::body_step::BodyStep;
use crate::step::island::{IslandBodies, Member};
use crate::step::params::StepStats;
use crate::step::pass::Pass;
use crate::step::plan::StepPlan;
use pulp::{Arch, NullaryFnOnce};
use std::cell::Cell;
use std::num::NonZeroUsize;
use std::ops::Range;

/// Memory of a frame on the CPU, reused between frames.
#[derive(Debug, Default)]
pub(crate) struct StepScratch {
    /// States of the particles, body after body, shape [vertex slots of the island].
    particles: Vec<ParticleState>,
    /// Vertices that a piece carries in the substep, shape [vertex slots of the island]; empty
    /// without contacts.
    carried: Vec<bool>,
    /// Displacements before the current iteration; empty without a residual.
    before: Vec<[f32; 4]>,
    volumes: VolumeScratch,
    /// Indices of the contacts of each color that may be active in the substep.
    facing: Vec<Vec<u32>>,
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
        self.particles.capacity()
            + self.carried.capacity()
            + self.before.capacity()
            + self.volumes.capacity()
            + self.facing.iter().map(Vec::capacity).sum::<usize>()
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
        let is_taken = step.plan.has_global_step();
        body.global = step.global.as_deref_mut().filter(|_| is_taken);
    }
    (&step.plan, body)
}

/// Steps the bodies of an island by a range of the substeps of a frame, in lockstep.
///
/// The results have the same bits on every machine and any number of threads. The global step
/// depends on the instruction set.
pub(crate) fn execute(
    bodies: &mut dyn IslandBodies,
    members: &mut [Member],
    contacts: &mut ContactSet,
    substeps: Range<u32>,
    scratch: &mut StepScratch,
) -> Result<(), NonFinite> {
    let StepScratch {
        particles,
        carried,
        before,
        volumes: volume_scratch,
        facing,
    } = scratch;
    particles.clear();
    let mut colors = contacts.colors.iter().take(UNCOLORED);
    let has_shared_contacts = colors.any(|contacts| is_shared(contacts.len()));
    let mut threads = NonZeroUsize::new(1);
    for (i, member) in members.iter_mut().enumerate() {
        let (_, body) = parts(bodies, i, member);
        member.first = particles.len();
        member.stats = StepStats {
            substeps: substeps.end - substeps.start,
            ..StepStats::default()
        };
        let at_start = |&x: &[f32; 4]| ParticleState { x, d: [0.0; 4] };
        particles.extend(body.positions.iter().map(at_start));
        if has_shared_contacts || has_shared_pass(&body) {
            threads = member.constants.threads;
        }
    }
    carried.clear();
    if !contacts.is_empty() {
        carried.resize(particles.len(), false);
        facing.resize_with(contacts.colors.len(), Vec::new);
    }
    let arch = Arch::new();
    let done = with_team(threads, |leader| {
        arch.dispatch(Frame {
            bodies: &mut *bodies,
            members,
            contacts,
            substeps,
            particles: ParticleStates::new(particles),
            carried: Cell::from_mut(&mut **carried).as_slice_of_cells(),
            before,
            volume_scratch,
            facing,
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
    substeps: Range<u32>,
    /// States of the island.
    particles: ParticleStates<'a>,
    carried: &'a [Cell<bool>],
    before: &'a mut Vec<[f32; 4]>,
    volume_scratch: &'a mut VolumeScratch,
    /// Shape \[colors\].
    facing: &'a mut [Vec<u32>],
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
        // The bodies have iterations, rounds and residual in common.
        let Some(first) = self.members.first().copied() else {
            return Ok(());
        };
        let iterations = parts(self.bodies, 0, &first).0.iterations();
        let contact_rounds = first.constants.contact_rounds;
        let has_contacts = !self.contacts.is_empty();
        // The prologue, the iterations, the epilogue.
        let last = iterations + 1;
        for substep in self.substeps.clone() {
            self.carried.iter().for_each(|carried| carried.set(false));
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
                let rounds = if kind == 1 { contact_rounds } else { 1 };
                for number in 0..rounds {
                    let count = rounds;
                    let round = Round { number, count };
                    for ends in stages.windows(2) {
                        // Contacts follow the projections of lengths in the first round only.
                        if number == 0 || ends[0].is_some() {
                            self.run_stage((part, round), [ends[0], ends[1]], substep)?;
                        }
                        if let Some(pass) = ends[1] {
                            self.run_contacts(pass, substep);
                        }
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
        (part, round): (u32, Round),
        [after, before]: [Option<Pass>; 2],
        substep: u32,
    ) -> Result<(), NonFinite> {
        for (i, member) in self.members.iter_mut().enumerate() {
            let (plan, body) = parts(self.bodies, i, member);
            let passes = plan.part(part);
            let from = passes.partition_point(|pass| after.is_some_and(|after| *pass <= after));
            let to = passes.partition_point(|pass| before.is_none_or(|before| *pass < before));
            let vertices = member.first..member.first + body.positions.len();
            let mut step = BodyStep {
                particles: self.particles.slice(member.first, body.positions.len()),
                carried: self.carried.get(vertices).unwrap_or_default(),
                body,
                constants: &member.constants,
                volume_scratch: &mut *self.volume_scratch,
                leader: &mut *self.leader,
                arch: self.arch,
                substeps_left: self.substeps.end - substep,
                round,
                time: time_after(substep, member),
                stats: &mut member.stats,
                lowest: &mut member.lowest,
            };
            let is_same_layer = |a: &Pass, b: &Pass| {
                let of = |pass: &Pass| pass.patch_layer().map(|layer| (layer, pass.is_back()));
                of(a).is_some() && of(a) == of(b)
            };
            for passes in passes[from..to].chunk_by(is_same_layer) {
                let pass = passes[0];
                if pass.is_ground() && *step.lowest > step.constants.ground {
                    step.stats.ground_passes_skipped += 1;
                    continue;
                }
                step.stats.passes += u32::try_from(passes.len()).unwrap_or(u32::MAX);
                match pass.patch_layer() {
                    Some(layer) => step.project_patches(layer, pass.is_back()),
                    None if step.run(pass) => {}
                    None => return Err(NonFinite { body: i, substep }),
                }
            }
        }
        Ok(())
    }

    /// Runs a pass over the contacts of the island.
    fn run_contacts(&mut self, pass: Pass, substep: u32) {
        let has_volumes = self.members.iter().any(|member| member.has_volumes);
        let Some(first) = self.members.first_mut() else {
            return;
        };
        let particles = self.particles;
        let (ground, h) = (first.constants.ground, first.constants.h);
        first.stats.passes += 1;
        match pass {
            Pass::ContactFeatures => {
                for (color, facing) in self.contacts.colors.iter_mut().zip(&mut *self.facing) {
                    contact_features::contact_features(particles, color, facing);
                }
            }
            Pass::ContactRecovery => {
                let mut change = 0.0;
                let fall = first.constants.gravity_step.map(|g| g * h);
                let (serial, colors) = split_serial(&self.contacts.colors);
                for color in colors {
                    change += contacts::recover_contacts(particles, color, (ground, h), fall);
                }
                for contact in serial.chunks(1) {
                    change += contacts::recover_contacts(particles, contact, (ground, h), fall);
                }
                for member in &mut *self.members {
                    member.stats.max_displacement += change;
                }
            }
            Pass::ContactsBeforeVolumes if !has_volumes => first.stats.passes -= 1,
            _ => {
                first.stats.contact_projections += self.contacts.len() as u64;
                let at = (ground, time_after(substep, first));
                let carried = self.carried;
                let colors = self.contacts.colors.iter_mut().zip(&*self.facing);
                for (color, (contacts, facing)) in colors.enumerate() {
                    if color == UNCOLORED {
                        contacts::contacts(particles, carried, (contacts, 0), facing, at);
                    } else {
                        let contacts = (&mut **contacts, &**facing);
                        sweep_contacts(self.leader, particles, carried, contacts, at);
                    }
                }
            }
        }
    }
}

/// Returns the time of the frame at the end of a substep \[s\].
fn time_after(substep: u32, member: &Member) -> f32 {
    // A second-order substep is longer than its first-order part.
    (substep + 1) as f32 * member.orders.first.h
}

/// Returns the contacts without a color, then those of each color.
fn split_serial(colors: &[Vec<ContactRecord>]) -> (&[ContactRecord], &[Vec<ContactRecord>]) {
    match colors.split_last() {
        Some((serial, colors)) => (serial, colors),
        None => (&[], &[]),
    }
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
