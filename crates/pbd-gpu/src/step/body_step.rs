//! [`BodyStep`]: the passes of one body on the CPU, one kernel per pass.
//!
//! [`Stage`](super::stage::Stage) runs them for every body of an island.

use crate::constraints::batches::{Batch, BatchId, ConstraintSet};
use crate::kernels::bending::Bending;
use crate::kernels::block::dispatch;
use crate::kernels::colliders::ColliderPass;
use crate::kernels::particle_state::ParticleStates;
use crate::kernels::stretch::Stretch;
use crate::kernels::volume::{self, Round, VolumeScratch};
use crate::kernels::{attachments, colliders, integrate, pins, predict};
use crate::parallel::Leader;
use crate::parallel::passes::{sweep_color, sweep_patches};
use crate::step::body::Body;
use crate::step::constants::{Projection, StepConstants};
use crate::step::params::StepStats;
use crate::step::pass::{ConstraintKind, Pass};
use crate::step::sweep::{Kernel, Sweep};
use pulp::Arch;
use std::cell::Cell;

/// A part of a substep of one body.
pub(super) struct BodyStep<'a, 'b, 'c> {
    /// States of the body.
    pub(super) particles: ParticleStates<'a>,
    /// Vertices that a piece carries, shape [vertex slots]; empty without contacts.
    pub(super) carried: &'a [Cell<bool>],
    pub(super) body: &'a mut Body<'b>,
    pub(super) constants: &'a StepConstants,
    pub(super) volume_scratch: &'a mut VolumeScratch,
    pub(super) leader: &'a mut Leader<'c>,
    pub(super) arch: Arch,
    pub(super) substeps_left: u32,
    pub(super) round: Round,
    /// Time of the frame at the end of the substep \[s\].
    pub(super) time: f32,
    pub(super) stats: &'a mut StepStats,
    /// Set to true if a vertex was in a collider.
    pub(super) meets_collider: &'a mut bool,
}

/// Projects a batch and returns its number of constraints; the overflow is projected serially.
fn project_batch<K: Kernel<N>, const N: usize>(
    leader: &mut Leader<'_>,
    arch: Arch,
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

/// Runs a pass of the global step and adds it to the statistics.
#[cfg(feature = "global")]
fn global_pass(
    particles: ParticleStates<'_>,
    body: &mut Body<'_>,
    constants: &StepConstants,
    stats: &mut StepStats,
    pass: Pass,
) {
    let sets = crate::global::EnergySets {
        stretch: body.stretch,
        bending: body.bending.as_deref(),
        interior_springs: body.interior_springs.as_deref(),
    };
    let Some(global) = &mut body.global else {
        return;
    };
    match pass {
        Pass::BeginGlobal => global.begin(particles, sets, constants),
        _ => {
            let sets = (sets, &*body.volumes);
            stats.global_iterations += global.iterate(particles, sets, constants);
        }
    }
}

impl BodyStep<'_, '_, '_> {
    /// Projects the constraints of all patches of a layer, or their lengths in reverse order.
    pub(super) fn project_patches(&mut self, layer: usize, is_back: bool) {
        let patches = self.body.patches.of_layer_mut(layer);
        let (leader, constants) = (&mut *self.leader, self.constants);
        sweep_patches(
            leader,
            self.arch,
            self.particles,
            patches,
            constants,
            is_back,
        );
        for patch in patches {
            self.stats.stretch_projections += patch.stretch.len() as u64;
            if !is_back {
                self.stats.bending_projections += patch.bending.len() as u64;
            }
        }
    }

    /// Runs a pass; returns false if a position is not finite.
    #[inline(always)]
    pub(super) fn run(&mut self, pass: Pass) -> bool {
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
            Pass::Predict => predict::predict(particles, v, constants),
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
            Pass::Project { kind, batch } | Pass::ProjectBack { kind, batch } => {
                let (leader, arch) = (&mut **leader, *arch);
                match kind {
                    ConstraintKind::Stretch => {
                        let (set, by) = (Some(&mut *body.stretch), constants.stretch);
                        stats.stretch_projections +=
                            project_batch::<Stretch, 2>(leader, arch, particles, set, batch, by);
                    }
                    ConstraintKind::Bending => {
                        let (set, by) = (body.bending.as_deref_mut(), constants.bending);
                        stats.bending_projections +=
                            project_batch::<Bending, 4>(leader, arch, particles, set, batch, by);
                    }
                    ConstraintKind::InteriorSpring => {
                        let set = body.interior_springs.as_deref_mut();
                        let by = constants.interior_springs;
                        stats.interior_spring_projections +=
                            project_batch::<Stretch, 2>(leader, arch, particles, set, batch, by);
                    }
                }
            }
            Pass::BeginGlobal | Pass::GlobalIteration => {
                #[cfg(feature = "global")]
                global_pass(particles, body, constants, stats, pass);
            }
            // `Frame` projects the contacts of the island.
            Pass::ContactFeatures
            | Pass::ContactsBeforeVolumes
            | Pass::Contacts
            | Pass::ContactRecovery => {}
            Pass::Volumes => {
                stats.volume_projections += body.volumes.pieces().len() as u64;
                let obstacles = volume::VolumeObstacles {
                    gravity: constants.gravity_step,
                    colliders: body.colliders,
                    carried: self.carried,
                    time: self.time,
                };
                let change = volume::volumes(
                    (leader, *arch),
                    (particles, v),
                    body.volumes,
                    (constants.volume, self.round, obstacles),
                    self.volume_scratch,
                );
                stats.max_displacement += change;
                stats.max_substep_displacement = stats.max_substep_displacement.max(change);
            }
            Pass::CollidersBeforeVolumes | Pass::Colliders => {
                let by = ColliderPass {
                    friction: constants.friction,
                    h: constants.h,
                    time: self.time,
                };
                *self.meets_collider |= colliders::colliders(particles, v, body.colliders, by);
            }
            Pass::Integrate => match integrate::integrate(particles, v, constants.h) {
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
