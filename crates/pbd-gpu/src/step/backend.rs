//! Execution of a plan: the `Backend` trait and the CPU backend, which calls one kernel per pass.

use crate::constraints::batches::{Batch, BatchId, BendingSet, ConstraintSet, StretchSet};
use crate::error::StepError;
use crate::kernels::bending::Bending;
use crate::kernels::block::dispatch;
use crate::kernels::integrate::first_non_finite;
use crate::kernels::particle_state::{ParticleState, ParticleStates};
use crate::kernels::stretch::Stretch;
use crate::kernels::volume::{self, VolumeScratch};
use crate::kernels::{attachments, colliders, contacts, ground, integrate, pins, predict};
use crate::parallel::passes::{is_shared, sweep_color, sweep_patches};
use crate::parallel::{Leader, with_team};
use crate::step::body::Body;
use crate::step::constants::Projection;
use crate::step::constants::StepConstants;
use crate::step::params::StepStats;
use crate::step::plan::{ConstraintKind, Pass, StepPlan};
use crate::step::sweep::{Kernel, Sweep};
use pulp::{Arch, NullaryFnOnce};
use std::num::NonZeroUsize;

/// Executes the passes of a plan in order, once per substep.
pub trait Backend {
    /// Steps a body by one frame.
    ///
    /// # Errors
    /// [`StepError::NonFinitePosition`]; the body is unusable then.
    fn execute(
        &mut self,
        plan: &StepPlan,
        constants: &StepConstants,
        body: &mut Body<'_>,
    ) -> Result<StepStats, StepError>;
}

/// The CPU backend. Its results have the same bits on every machine and any number of threads.
#[derive(Debug, Default)]
pub struct CpuBackend {
    /// States of the particles during a frame, shape [vertex slots].
    particles: Vec<ParticleState>,
    /// Displacements before the current iteration, shape [vertex slots]; empty without a residual.
    before: Vec<[f32; 4]>,
    volume_scratch: VolumeScratch,
}

impl Clone for CpuBackend {
    /// Returns a backend with empty scratch memory.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl CpuBackend {
    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        self.particles.capacity() + self.before.capacity() + self.volume_scratch.capacity()
    }
}

impl Backend for CpuBackend {
    fn execute(
        &mut self,
        plan: &StepPlan,
        constants: &StepConstants,
        body: &mut Body<'_>,
    ) -> Result<StepStats, StepError> {
        self.particles.clear();
        self.particles.extend(
            body.positions
                .iter()
                .map(|&x| ParticleState { x, d: [0.0; 4] }),
        );
        let arch = Arch::new();
        let threads = if has_shared_pass(body) {
            constants.threads
        } else {
            NonZeroUsize::new(1)
        };
        let done = with_team(threads, |leader| {
            arch.dispatch(Frame {
                plan,
                constants,
                body,
                particles: ParticleStates::new(&mut self.particles),
                before: &mut self.before,
                volume_scratch: &mut self.volume_scratch,
                leader,
                arch,
                stats: StepStats::default(),
                lowest: f32::INFINITY,
            })
        });
        for (x, state) in body.positions.iter_mut().zip(&self.particles) {
            *x = state.x;
        }
        done.map_err(|substep| StepError::NonFinitePosition {
            vertex: first_non_finite(body.positions),
            substep,
        })
    }
}

/// Returns whether several threads can run a pass of the body.
fn has_shared_pass(body: &Body<'_>) -> bool {
    let edges = [Some(&*body.stretch), body.interior_springs.as_deref()];
    let edges = edges.into_iter().flatten().flat_map(StretchSet::batches);
    let bending = body.bending.as_deref().map_or(&[][..], BendingSet::batches);
    let counts = edges.map(Batch::len).chain(bending.iter().map(Batch::len));
    body.patches.are_shared() || counts.chain([body.volumes.spokes.len()]).any(is_shared)
}

/// The substep after which a position is not finite.
type NonFiniteSubstep = u32;

/// The execution of one frame.
///
/// Passes over vertices are inlined into [`NullaryFnOnce::call`], so that they are compiled for the
/// instruction set that is detected at run time. Those over constraints are called.
struct Frame<'a, 'b, 'c> {
    plan: &'a StepPlan,
    constants: &'a StepConstants,
    body: &'a mut Body<'b>,
    particles: ParticleStates<'a>,
    before: &'a mut Vec<[f32; 4]>,
    volume_scratch: &'a mut VolumeScratch,
    leader: &'a mut Leader<'c>,
    arch: Arch,
    stats: StepStats,
    /// Minimum predicted height of the substep \[m\].
    lowest: f32,
}

impl NullaryFnOnce for Frame<'_, '_, '_> {
    type Output = Result<StepStats, NonFiniteSubstep>;

    #[inline(always)]
    fn call(mut self) -> Self::Output {
        self.stats.substeps = self.constants.substeps;
        for substep in 0..self.constants.substeps {
            let plan = self.plan;
            // The prologue, the iterations, the epilogue.
            let last = plan.iterations() + 1;
            let mut part = 0;
            while part <= last {
                let is_same_layer = |a: &Pass, b: &Pass| {
                    a.patch_layer().is_some() && a.patch_layer() == b.patch_layer()
                };
                for passes in plan.part(part).chunk_by(is_same_layer) {
                    let pass = passes[0];
                    if pass.is_ground() && self.lowest > self.constants.ground {
                        self.stats.ground_passes_skipped += 1;
                        continue;
                    }
                    self.stats.passes += u32::try_from(passes.len()).unwrap_or(u32::MAX);
                    match pass.patch_layer() {
                        Some(layer) => self.project_patches(layer),
                        None => self.run(pass, substep)?,
                    }
                }
                part += 1;
                if let Some(residual) = self.constants.residual
                    && part < last
                {
                    let moved = max_change(self.particles, self.before);
                    if part > 1 && moved < residual {
                        self.stats.iterations_skipped += last - part;
                        part = last;
                    }
                }
            }
        }
        Ok(self.stats)
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

impl Frame<'_, '_, '_> {
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

    #[inline(always)]
    fn run(&mut self, pass: Pass, substep: u32) -> Result<(), NonFiniteSubstep> {
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
            Pass::Predict => self.lowest = predict::predict(particles, v, constants),
            Pass::Pins => pins::pins(particles, body.pins, constants.substeps - substep),
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
                body.contacts.reset_friction();
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
            Pass::ContactsBeforeVolumes | Pass::Contacts => {
                stats.contact_projections += body.contacts.len() as u64;
                for color in &mut body.contacts.colors {
                    let accumulates = self.plan.iterations() > 1;
                    let time = (substep + 1) as f32 * constants.h;
                    contacts::contacts(particles, color, (constants.friction, accumulates), time);
                }
            }
            Pass::Volumes => {
                stats.volume_projections += body.volumes.pieces().len() as u64;
                let piece = (body.topology, &mut *body.volumes);
                volume::volumes(
                    (leader, *arch),
                    particles,
                    piece,
                    (constants.volume, constants.ground),
                    self.volume_scratch,
                );
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
                None => return Err(substep),
            },
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraints::contacts::ContactSet;
    use crate::constraints::volumes::VolumeSet;
    use crate::material::Stiffness;
    use crate::patches::content::PatchContents;
    use crate::step::constants::{Projection, VolumeProjection};
    use crate::step::plan::PlanKey;
    use incise_mesh::{Topology, VertexId};

    #[test]
    fn a_spring_moves_as_in_backward_euler() {
        let (compliance, mass, h) = (1e-3_f32, 2.0_f32, 0.01_f32);
        let mut positions = [[0.0; 4], [1.25, 0.0, 0.0, 1.0 / mass]];
        let mut velocities = [[0.0; 4]; 2];
        let mut cpu = CpuBackend::default();
        let mut stretch = StretchSet::new(2);
        stretch.insert([VertexId(0), VertexId(1)], 1.0);
        for iterations in [1, 5] {
            let projection = Stiffness::Compliance(compliance).projection(iterations, h);
            let mut plan = StepPlan::default();
            let key = PlanKey {
                iterations,
                multipliers: projection.accumulates_lambda,
                ..PlanKey::default()
            };
            plan.update(key, &stretch, None, None);
            let constants = StepConstants {
                h,
                substeps: 1,
                gravity_step: [0.0; 3],
                velocity_factor: 1.0,
                stretch: projection,
                bending: Projection::NONE,
                interior_springs: Projection::NONE,
                volume: VolumeProjection::NONE,
                ground: f32::NEG_INFINITY,
                friction: 0.0,
                residual: None,
                threads: None,
            };
            let stiff = 1.0 + f64::from(h * h) / f64::from(compliance * mass);
            let mut expected = f64::from(positions[1][0]) - 1.0;
            let mut before = expected - f64::from(velocities[1][0]) * f64::from(h);
            for step in 0..200 {
                let mut body = Body {
                    positions: &mut positions,
                    velocities: &mut velocities,
                    stretch: &mut stretch,
                    bending: None,
                    interior_springs: None,
                    contacts: &mut ContactSet::default(),
                    colliders: &[],
                    volumes: &mut VolumeSet::default(),
                    topology: &Topology::default(),
                    pins: &[],
                    patches: &mut PatchContents::default(),
                    attachments: &[],
                };
                cpu.execute(&plan, &constants, &mut body).unwrap();
                (before, expected) = (expected, (2.0 * expected - before) / stiff);
                let found = f64::from(positions[1][0]) - 1.0;
                assert!(
                    (found - expected).abs() < 2e-6,
                    "{found}, not {expected}, in step {step} with {iterations} iterations"
                );
            }
        }
    }
}
