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
use crate::kernels::{attachments, colliders, integrate, pins, points, predict};
use crate::parallel::Leader;
use crate::parallel::passes::{sweep_cells, sweep_cells_serially, sweep_color, sweep_patches};
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
    /// Displacements by constraints \[m\], shape [vertex slots]; empty without a lift.
    pub(super) corrections: &'a [Cell<[f32; 4]>],
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

/// A pass over the constraints of a batch.
struct BatchSweep<'a, 'b, 'c> {
    leader: &'a mut Leader<'b>,
    arch: Arch,
    particles: ParticleStates<'c>,
    batch: BatchId,
    is_back: bool,
}

impl BatchSweep<'_, '_, '_> {
    /// Projects the batch and returns its number of constraints.
    ///
    /// The overflow is projected serially, on the way back from last to first.
    fn project<K: Kernel<N>, const N: usize>(
        self,
        set: Option<&mut ConstraintSet<N>>,
        projection: Projection,
    ) -> u64 {
        let Some(set) = set else { return 0 };
        let part = set
            .batch_mut(self.batch.number())
            .part(projection.accumulates_lambda);
        let (particles, arch) = (self.particles, self.arch);
        let count = part.vertices.len() as u64;
        match self.batch {
            BatchId::Color(_) => {
                sweep_color::<K, N>(self.leader, arch, particles, part, projection);
            }
            BatchId::Overflow => {
                let sweep = Sweep::<K, N>::serial(particles, part, projection);
                dispatch(
                    arch,
                    if self.is_back {
                        sweep.reversed()
                    } else {
                        sweep
                    },
                );
            }
        }
        count
    }
}

impl BodyStep<'_, '_, '_> {
    /// Projects the constraints of all patches of a layer, in reverse order on the way back.
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
            self.stats.bending_projections += patch.bending.len() as u64;
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
            Pass::Predict if body.solid.is_some() => {
                predict::predict(particles, v, &[], constants);
                predict::repeat_forces(particles, self.corrections, constants.cells.square);
            }
            Pass::Predict => predict::predict(particles, v, self.corrections, constants),
            Pass::Cells(batch) => {
                let Some(solid) = &mut body.solid else {
                    return true;
                };
                let cells = solid.cells.batch_mut(batch.number());
                stats.cell_projections += cells.len() as u64;
                if batch == BatchId::Overflow {
                    sweep_cells_serially(particles, self.corrections, cells, &constants.cells);
                } else {
                    let constants = &constants.cells;
                    sweep_cells(leader, *arch, particles, self.corrections, cells, constants);
                }
            }
            Pass::SolidPins | Pass::SolidSupports => {
                let Some(solid) = &mut body.solid else {
                    return true;
                };
                let points = solid.points(particles);
                let substeps = [self.substeps_left, constants.substeps];
                points::pins(points, body.pins, solid.pin_starts, substeps);
                if pass == Pass::SolidSupports {
                    let by = ColliderPass {
                        friction: constants.friction,
                        h: constants.collider_step,
                        time: self.time,
                    };
                    *self.meets_collider |=
                        solid.push_out(particles, v, body.colliders, by, constants);
                }
            }
            Pass::Pins => pins::pins(particles, body.pins, self.substeps_left),
            Pass::LongRangeAttachments => {
                attachments::attachments(particles, self.corrections, body.attachments, constants.h)
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
                let sweep = BatchSweep {
                    leader,
                    arch: *arch,
                    particles,
                    batch,
                    is_back: pass.is_back(),
                };
                match kind {
                    ConstraintKind::Stretch => {
                        let set = Some(&mut *body.stretch);
                        let count = sweep.project::<Stretch, 2>(set, constants.stretch);
                        stats.stretch_projections += count;
                    }
                    ConstraintKind::Bending => {
                        let set = body.bending.as_deref_mut();
                        let count = sweep.project::<Bending, 4>(set, constants.bending);
                        stats.bending_projections += count;
                    }
                    ConstraintKind::InteriorSpring => {
                        let set = body.interior_springs.as_deref_mut();
                        let count = sweep.project::<Stretch, 2>(set, constants.interior_springs);
                        stats.interior_spring_projections += count;
                    }
                }
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
            Pass::Colliders if body.solid.is_some() => {
                let by = ColliderPass {
                    friction: constants.friction,
                    h: constants.collider_step,
                    time: self.time,
                };
                if let Some(solid) = &mut body.solid {
                    *self.meets_collider |=
                        solid.push_out(particles, v, body.colliders, by, constants);
                }
            }
            Pass::CollidersBeforeVolumes | Pass::Colliders => {
                let by = ColliderPass {
                    friction: constants.friction,
                    h: constants.collider_step,
                    time: self.time,
                };
                *self.meets_collider |=
                    colliders::colliders(particles, v, self.corrections, body.colliders, by);
            }
            Pass::Integrate => {
                let corrections = match body.solid {
                    Some(_) => &[],
                    None => self.corrections,
                };
                match integrate::integrate(particles, v, corrections, constants.h) {
                    Some(change) => {
                        stats.max_displacement += change;
                        stats.max_substep_displacement = stats.max_substep_displacement.max(change);
                    }
                    None => return false,
                }
            }
        }
        true
    }
}
