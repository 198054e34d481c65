//! Who executes a plan. The CPU runs one function a kernel.

use crate::constraints::Batch;
use crate::error::StepError;
use crate::kernels::bending::{Bending, bending_serial};
use crate::kernels::displacements::{Cell, Displacements, Exclusive};
use crate::kernels::stretch::{Stretch, stretch_serial};
use crate::kernels::volume::{self, Rings};
use crate::kernels::{colliders, contacts, ground, integrate, pins, predict, tethers};
use crate::params::StepStats;
use crate::plan::{Body, Pass, StepConstants, StepPlan};
use crate::sweep::{is_spread, sweep};
use pulp::{Arch, NullaryFnOnce};

/// Executes the passes of a plan, in order, once a substep.
pub trait Backend {
    /// Steps a body by one frame.
    ///
    /// # Errors
    /// [`StepError::NonFinitePosition`]; the body is not usable then.
    fn execute(
        &mut self,
        plan: &StepPlan,
        constants: &StepConstants,
        body: &mut Body<'_>,
    ) -> Result<StepStats, StepError>;
}

/// The backend that needs nothing. Same bits on every machine and any number of threads.
#[derive(Debug, Default)]
pub struct CpuBackend {
    /// Displacements of the substep, shape [vertex slots].
    displacements: Vec<Cell>,
    /// Displacements before the iteration at hand, shape [vertex slots]; empty while no residual is stated.
    before: Vec<[f32; 4]>,
    rings: Rings,
}

impl Clone for CpuBackend {
    /// Scratch memory is not worth copying.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl CpuBackend {
    /// Room that the backend has taken, in vertices.
    pub(crate) fn capacity(&self) -> usize {
        self.displacements.capacity() + self.before.capacity() + self.rings.capacity()
    }
}

impl Backend for CpuBackend {
    fn execute(
        &mut self,
        plan: &StepPlan,
        constants: &StepConstants,
        body: &mut Body<'_>,
    ) -> Result<StepStats, StepError> {
        let slots = body.positions.len();
        self.displacements.resize_with(slots, Cell::default);
        let arch = Arch::new();
        let edges = [Some(&*body.stretch), body.struts.as_deref()];
        let stretch = edges
            .into_iter()
            .flatten()
            .flat_map(|set| set.all().map(Batch::len));
        let bending = body.bending.iter().flat_map(|set| set.all());
        let volumes = [body.volumes.spokes.len()];
        let batches = stretch.chain(bending.map(Batch::len)).chain(volumes);
        let spread = batches.into_iter().any(is_spread);
        let frame = Frame {
            plan,
            constants,
            body,
            displacements: &mut self.displacements,
            before: &mut self.before,
            rings: &mut self.rings,
            arch,
            stats: StepStats::default(),
            lowest: f32::INFINITY,
        };
        if spread {
            // One way into the thread pool a frame instead of one a pass.
            rayon::scope(|_| arch.dispatch(frame))
        } else {
            arch.dispatch(frame)
        }
    }
}

/// One frame in the making. Everything down to the kernels is inlined into [`NullaryFnOnce::call`], so
/// that it is compiled for the instruction set that is found at run time.
struct Frame<'a, 'b> {
    plan: &'a StepPlan,
    constants: &'a StepConstants,
    body: &'a mut Body<'b>,
    displacements: &'a mut [Cell],
    before: &'a mut Vec<[f32; 4]>,
    rings: &'a mut Rings,
    arch: Arch,
    stats: StepStats,
    /// The lowest predicted height of the substep \[m\].
    lowest: f32,
}

impl NullaryFnOnce for Frame<'_, '_> {
    type Output = Result<StepStats, StepError>;

    #[inline(always)]
    fn call(mut self) -> Self::Output {
        self.stats.substeps = self.constants.substeps;
        for substep in 0..self.constants.substeps {
            let plan = self.plan;
            // The prologue, the iterations, the epilogue.
            let last = plan.iterations() + 1;
            let mut part = 0;
            while part <= last {
                for &pass in plan.part(part) {
                    if pass == Pass::Ground && self.lowest > self.constants.ground {
                        self.stats.ground_passes_skipped += 1;
                    } else {
                        self.stats.passes += 1;
                        self.run(pass, substep)?;
                    }
                }
                part += 1;
                if let Some(residual) = self.constants.residual
                    && part < last
                {
                    let moved = farthest_since(self.displacements, self.before);
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

/// The most that a displacement has changed by along any axis since `before` was taken, which is taken anew \[m\].
#[inline(always)]
fn farthest_since(now: &mut [Cell], before: &mut Vec<[f32; 4]>) -> f32 {
    before.resize(now.len(), [0.0; 4]);
    let mut now = Exclusive(now);
    let mut farthest = [0.0_f32; 4];
    for (i, before) in before.iter_mut().enumerate() {
        let d = now.get(i);
        for k in 0..4 {
            let change = (d[k] - before[k]).abs();
            // Passed over where it is no number: the substep ends with that error in any case.
            farthest[k] = if change > farthest[k] {
                change
            } else {
                farthest[k]
            };
        }
        *before = d;
    }
    farthest.into_iter().fold(0.0, f32::max)
}

impl Frame<'_, '_> {
    #[inline(always)]
    fn run(&mut self, pass: Pass, substep: u32) -> Result<(), StepError> {
        let Self {
            constants,
            body,
            arch,
            stats,
            ..
        } = self;
        let (x, v) = (&mut *body.positions, &mut *body.velocities);
        let d = &mut Exclusive(self.displacements);
        match pass {
            Pass::Predict => self.lowest = predict::predict(x, d, v, constants),
            Pass::Pins => pins::pins(x, d, body.pins, constants.substeps - substep),
            Pass::Tethers => tethers::tethers(x, d, body.tethers, constants.h),
            Pass::ResetMultipliers => {
                if constants.stretch.keeps {
                    body.stretch.all_mut().for_each(Batch::reset_multipliers);
                }
                if constants.bending.keeps {
                    let sets = body.bending.iter_mut();
                    sets.flat_map(|set| set.all_mut())
                        .for_each(Batch::reset_multipliers);
                }
                if constants.struts.keeps {
                    let sets = body.struts.iter_mut();
                    sets.flat_map(|set| set.all_mut())
                        .for_each(Batch::reset_multipliers);
                }
                body.contacts.reset();
                if constants.volume.keeps {
                    body.volumes.reset_multipliers();
                }
            }
            Pass::Stretch { color } => {
                let part = body.stretch.batches[color].part(constants.stretch.keeps);
                stats.stretch_projections += part.vertices.len() as u64;
                sweep::<Stretch, 2>(*arch, x, d.0, part, constants.stretch);
            }
            Pass::StretchOverflow => {
                let part = body.stretch.overflow.part(constants.stretch.keeps);
                stats.stretch_projections += part.vertices.len() as u64;
                stretch_serial(x, d, part, constants.stretch);
            }
            Pass::Bending { color } => {
                if let Some(set) = &mut body.bending {
                    let part = set.batches[color].part(constants.bending.keeps);
                    stats.bending_projections += part.vertices.len() as u64;
                    sweep::<Bending, 4>(*arch, x, d.0, part, constants.bending);
                }
            }
            Pass::BendingOverflow => {
                if let Some(set) = &mut body.bending {
                    let part = set.overflow.part(constants.bending.keeps);
                    stats.bending_projections += part.vertices.len() as u64;
                    bending_serial(x, d, part, constants.bending);
                }
            }
            Pass::Struts { color } => {
                if let Some(set) = &mut body.struts {
                    let part = set.batches[color].part(constants.struts.keeps);
                    stats.strut_projections += part.vertices.len() as u64;
                    sweep::<Stretch, 2>(*arch, x, d.0, part, constants.struts);
                }
            }
            Pass::StrutsOverflow => {
                if let Some(set) = &mut body.struts {
                    let part = set.overflow.part(constants.struts.keeps);
                    stats.strut_projections += part.vertices.len() as u64;
                    stretch_serial(x, d, part, constants.struts);
                }
            }
            Pass::ContactsBeforeVolumes | Pass::Contacts => {
                stats.contact_projections += body.contacts.len() as u64;
                for color in &mut body.contacts.colors {
                    let keeps = self.plan.iterations() > 1;
                    let time = (substep + 1) as f32 * constants.h;
                    contacts::contacts(x, d, color, (constants.friction, keeps), time);
                }
            }
            Pass::Volumes => {
                stats.volume_projections += body.volumes.pieces().len() as u64;
                let piece = (body.topology, &mut *body.volumes);
                volume::volumes(*arch, x, d.0, piece, constants.volume, self.rings);
            }
            Pass::Colliders => {
                colliders::colliders(x, d, v, body.colliders, constants.friction);
            }
            Pass::Ground => {
                stats.ground_passes += 1;
                ground::ground(x, d, v, constants.ground, constants.friction);
            }
            Pass::Integrate => match integrate::integrate(x, d, v, constants) {
                Some(farthest) => {
                    stats.farthest += farthest;
                    stats.farthest_substep = stats.farthest_substep.max(farthest);
                }
                None => {
                    let vertex = integrate::first_non_finite(x);
                    return Err(StepError::NonFinitePosition { vertex, substep });
                }
            },
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraints::StretchSet;
    use crate::contacts::ContactSet;
    use crate::material::{Projection, Stiffness, VolumeProjection};
    use crate::plan::PlanKey;
    use crate::volumes::VolumeSet;
    use incise_mesh::{Topology, VertexId};

    #[test]
    fn a_spring_is_backward_euler_to_the_step() {
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
                multipliers: projection.keeps,
                ..PlanKey::default()
            };
            plan.update(key, &stretch, None, None);
            let constants = StepConstants {
                h,
                substeps: 1,
                gravity_step: [0.0; 3],
                kept_velocity: 1.0,
                stretch: projection,
                bending: Projection::NONE,
                struts: Projection::NONE,
                volume: VolumeProjection::NONE,
                ground: f32::NEG_INFINITY,
                friction: 0.0,
                residual: None,
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
                    struts: None,
                    contacts: &mut ContactSet::default(),
                    colliders: &[],
                    volumes: &mut VolumeSet::default(),
                    topology: &Topology::default(),
                    pins: &[],
                    tethers: &[],
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
