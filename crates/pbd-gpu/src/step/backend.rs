//! Execution of the plans of an island's bodies on the CPU: one kernel per pass, in lockstep.
//!
//! Every body runs the passes of its own plan. Contacts may belong to several bodies: they are
//! projected once for the island, when all bodies have reached the contact passes.

use crate::constraints::colliders::{ColliderRecord, PLANE};
use crate::constraints::contacts::{ContactRecord, ContactSet, UNCOLORED};
use crate::kernels::colliders::Planes;
use crate::kernels::particle_state::{ParticleState, ParticleStates};
use crate::kernels::volume::{Round, VolumeScratch};
use crate::kernels::{contact_features, contacts};
use crate::parallel::passes::{body_chunks, is_shared, share_bodies, sweep_contacts};
use crate::parallel::{Leader, with_team};
use crate::step::island::{IslandBody, Member};
use crate::step::island_points::IslandPoints;
use crate::step::params::StepStats;
use crate::step::pass::Pass;
use crate::step::stage::{Stage, SteppedBody, time_after};
use pulp::{Arch, NullaryFnOnce};
use std::cell::Cell;
use std::num::NonZeroUsize;
use std::ops::Range;

/// Memory of a frame on the CPU, reused between frames.
#[derive(Debug, Default)]
pub(crate) struct StepScratch {
    /// States of the particles, body after body, shape [vertex slots of the island].
    particles: Vec<ParticleState>,
    /// Displacements by constraints \[m\], shape [vertex slots of the island]; empty without
    /// a lift.
    corrections: Vec<[f32; 4]>,
    /// Vertices that a piece carries in the substep, shape [vertex slots of the island]; empty
    /// without contacts.
    carried: Vec<bool>,
    /// Displacements before the current iteration; empty without a residual.
    before: Vec<[f32; 4]>,
    /// One per chunk of the small bodies.
    volumes: Vec<VolumeScratch>,
    /// Empty between frames.
    bodies: Vec<SteppedBody<'static>>,
    /// Indices of the contacts of each color that may be active in the substep.
    facing: Vec<Vec<u32>>,
    /// Planes of the bodies with contacts.
    planes: Vec<ColliderRecord>,
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
        let volumes = self.volumes.iter().map(VolumeScratch::capacity);
        let facing = self.facing.iter().map(Vec::capacity);
        self.particles.capacity()
            + self.corrections.capacity()
            + self.carried.capacity()
            + self.before.capacity()
            + self.bodies.capacity()
            + self.planes.capacity()
            + volumes.chain(facing).sum::<usize>()
    }
}

/// A body, by index, with positions that are not finite after a substep.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NonFinite {
    pub(crate) body: usize,
    pub(crate) substep: u32,
}

/// Steps the bodies of an island by a range of the substeps of a frame, in lockstep.
///
/// The results have the same bits on every machine and any number of threads.
pub(crate) fn execute(
    bodies: &mut [IslandBody<'_>],
    members: &mut [Member],
    contacts: &mut ContactSet,
    substeps: Range<u32>,
    scratch: &mut StepScratch,
) -> Result<(), NonFinite> {
    let StepScratch {
        particles,
        corrections,
        carried,
        before,
        volumes,
        bodies: list,
        facing,
        planes,
    } = scratch;
    particles.clear();
    corrections.clear();
    planes.clear();
    let mut colors = contacts.colors.iter().take(UNCOLORED);
    let mut has_shared_pass = colors.any(|contacts| is_shared(contacts.len()));
    let mut stepped: Vec<SteppedBody<'_>> = std::mem::take(list);
    let (mut small, mut first_vertex) = (0, 0);
    // Bodies without a lift have corrections of their own, which stay 0.
    let has_lift = members.iter().any(|member| member.constants.lift > 0.0);
    let members = members.iter_mut().enumerate();
    for ((solver, surface), (index, member)) in bodies.iter_mut().zip(members) {
        let stats = StepStats {
            substeps: substeps.end - substeps.start,
            ..StepStats::default()
        };
        (member.first, member.stats) = (particles.len(), stats);
        member.first_vertex = first_vertex;
        first_vertex += surface.positions().len();
        member.meets_collider = false;
        let body = SteppedBody::new(index, member, solver, surface);
        let at_start = |&x: &[f32; 4]| ParticleState { x, d: [0.0; 4] };
        particles.extend(body.arrays.positions.iter().map(at_start));
        if body.member.constants.lift == 0.0 {
            body.arrays.corrections.fill([0.0; 4]);
        }
        if has_lift {
            corrections.extend_from_slice(body.arrays.corrections);
        }
        if body.is_large {
            has_shared_pass = true;
        } else {
            small += body.arrays.positions.len();
        }
        stepped.push(body);
    }
    let shares_bodies = stepped.len() > 1 && is_shared(small);
    let threads = match stepped.first() {
        Some(body) if has_shared_pass || shares_bodies => body.member.constants.threads,
        _ => NonZeroUsize::new(1),
    };
    carried.clear();
    if !contacts.is_empty() {
        carried.resize(first_vertex, false);
        facing.resize_with(contacts.colors.len(), Vec::new);
        let of_bodies = stepped.iter().flat_map(|body| body.arrays.colliders);
        for plane in of_bodies.filter(|collider| collider.kind == PLANE) {
            if !planes.contains(plane) {
                planes.push(*plane);
            }
        }
    }
    let arch = Arch::new();
    let done = with_team(threads, |leader| {
        let chunks = if shares_bodies {
            body_chunks(leader)
        } else {
            1
        };
        if volumes.len() < chunks {
            volumes.resize_with(chunks, VolumeScratch::default);
        }
        arch.dispatch(Frame {
            bodies: &mut stepped,
            contacts,
            substeps,
            particles: ParticleStates::new(particles),
            corrections: Cell::from_mut(&mut **corrections).as_slice_of_cells(),
            carried: Cell::from_mut(&mut **carried).as_slice_of_cells(),
            before,
            volumes: &mut volumes[..chunks],
            facing,
            planes,
            leader,
            arch,
        })
    });
    for body in &mut stepped {
        body.member.met_collider |= body.member.meets_collider;
        let positions = body.arrays.positions.iter_mut();
        for (x, state) in positions.zip(&particles[body.member.first..]) {
            *x = state.x;
        }
        if let Some(last) = corrections.get(body.member.first..) {
            let count = body.arrays.corrections.len().min(last.len());
            body.arrays.corrections[..count].copy_from_slice(&last[..count]);
        }
    }
    stepped.clear();
    // Reuses the allocation for later borrows.
    *list = stepped.into_iter().map_while(|_| None).collect();
    done
}

/// The execution of one frame.
///
/// [`max_change`] is inlined into [`NullaryFnOnce::call`], so that it is compiled for the
/// instruction set that is detected at run time.
struct Frame<'a, 'b, 'c> {
    bodies: &'a mut [SteppedBody<'c>],
    contacts: &'a mut ContactSet,
    substeps: Range<u32>,
    /// States of the island.
    particles: ParticleStates<'a>,
    /// Displacements by constraints of the island; empty without a lift.
    corrections: &'a [Cell<[f32; 4]>],
    carried: &'a [Cell<bool>],
    before: &'a mut Vec<[f32; 4]>,
    /// One per chunk of the bodies.
    volumes: &'a mut [VolumeScratch],
    /// Shape \[colors\].
    facing: &'a mut [Vec<u32>],
    planes: &'a [ColliderRecord],
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

impl NullaryFnOnce for Frame<'_, '_, '_> {
    type Output = Result<(), NonFinite>;

    #[inline(always)]
    fn call(mut self) -> Self::Output {
        // The bodies have iterations, rounds and residual in common.
        let Some(first) = self.bodies.first() else {
            return Ok(());
        };
        let iterations = first.plan.iterations();
        let constants = first.member.constants;
        let contact_rounds = constants.contact_rounds;
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
                            self.run_stage(part, round, ends[0], ends[1], substep)?;
                        }
                        if let Some(pass) = ends[1] {
                            self.run_contacts(pass, substep);
                        }
                    }
                }
                part += 1;
                if let Some(residual) = constants.residual
                    && part < last
                {
                    let moved = max_change(self.particles, self.before);
                    if part > 1 && moved < residual {
                        for body in &mut *self.bodies {
                            body.member.stats.iterations_skipped += last - part;
                        }
                        part = last;
                    }
                }
            }
        }
        Ok(())
    }
}

impl Frame<'_, '_, '_> {
    /// Runs the passes of every body's plan in an open interval between two passes.
    fn run_stage(
        &mut self,
        part: u32,
        round: Round,
        after: Option<Pass>,
        before: Option<Pass>,
        substep: u32,
    ) -> Result<(), NonFinite> {
        let stage = Stage {
            part,
            round,
            after,
            before,
            substep,
            substeps_left: self.substeps.end - substep,
            particles: self.particles,
            corrections: self.corrections,
            carried: self.carried,
            arch: self.arch,
        };
        let shares_bodies = self.volumes.len() > 1;
        let mut failed = None;
        for body in &mut *self.bodies {
            let is_shared = shares_bodies && !body.is_large;
            if !is_shared && !stage.run(body, self.leader, &mut self.volumes[0]) {
                failed = Some(body.index);
                break;
            }
        }
        if shares_bodies {
            let small = share_bodies(self.leader, stage, self.bodies, self.volumes);
            failed = failed.into_iter().chain(small).min();
        }
        failed.map_or(Ok(()), |body| Err(NonFinite { body, substep }))
    }

    /// Runs a pass over the contacts of the island.
    fn run_contacts(&mut self, pass: Pass, substep: u32) {
        let Self {
            bodies,
            contacts,
            facing,
            leader,
            ..
        } = self;
        let Some(first) = bodies.first_mut() else {
            return;
        };
        let has_volumes = first.member.has_volumes;
        let planes = Planes {
            records: self.planes,
            time: time_after(substep, first.member),
        };
        let h = first.member.constants.h;
        let fall = first.member.constants.gravity_step.map(|g| g * h);
        let has_volumes = has_volumes || bodies.iter().any(|body| body.member.has_volumes);
        if pass == Pass::ContactsBeforeVolumes && !has_volumes {
            return;
        }
        let has_solid = bodies.iter().any(|body| body.arrays.solid.is_some());
        let particles = self.particles;
        let points = IslandPoints { particles, bodies };
        let colors = &mut contacts.colors;
        let mut change = 0.0;
        match pass {
            Pass::ContactFeatures => {
                for (color, facing) in colors.iter_mut().zip(&mut **facing) {
                    if has_solid {
                        contact_features::contact_features(points, color, facing);
                    } else {
                        contact_features::contact_features(particles, color, facing);
                    }
                }
            }
            Pass::ContactRecovery => {
                let (serial, colors) = split_serial(colors);
                let lists = colors.iter().map(Vec::as_slice).chain(serial.chunks(1));
                for list in lists {
                    change += if has_solid {
                        contacts::recover_contacts(points, &[], list, planes, h, fall)
                    } else {
                        let corrections = self.corrections;
                        contacts::recover_contacts(particles, corrections, list, planes, h, fall)
                    };
                }
            }
            _ => {
                for (color, (list, facing)) in colors.iter_mut().zip(&**facing).enumerate() {
                    let (carried, corrections) = (self.carried, self.corrections);
                    if has_solid {
                        // Contacts of a color share no vertex, but nodes.
                        contacts::contacts(points, carried, &[], list, 0, facing, planes);
                    } else if color == UNCOLORED {
                        contacts::contacts(
                            particles,
                            carried,
                            corrections,
                            list,
                            0,
                            facing,
                            planes,
                        );
                    } else {
                        sweep_contacts(
                            leader,
                            particles,
                            carried,
                            corrections,
                            list,
                            facing,
                            planes,
                        );
                    }
                }
            }
        }
        let count = contacts.len() as u64;
        for (i, body) in bodies.iter_mut().enumerate() {
            let stats = &mut body.member.stats;
            stats.max_displacement += change;
            if i == 0 {
                stats.passes += 1;
                let is_projected = matches!(pass, Pass::Contacts | Pass::ContactsBeforeVolumes);
                stats.contact_projections += if is_projected { count } else { 0 };
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
