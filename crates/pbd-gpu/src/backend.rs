//! Who executes a plan. The CPU runs one function a kernel.

use crate::error::StepError;
use crate::kernels::{bending, ground, integrate, pins, predict, stretch};
use crate::params::StepStats;
use crate::plan::{Body, Pass, StepConstants, StepPlan};
use pulp::NullaryFnOnce;

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
#[derive(Debug, Clone, Copy, Default)]
pub struct CpuBackend;

impl Backend for CpuBackend {
    fn execute(
        &mut self,
        plan: &StepPlan,
        constants: &StepConstants,
        body: &mut Body<'_>,
    ) -> Result<StepStats, StepError> {
        pulp::Arch::new().dispatch(Frame {
            plan,
            constants,
            body,
            stats: StepStats::default(),
            lowest: f32::INFINITY,
        })
    }
}

/// One frame in the making. Everything down to the kernels is inlined into [`NullaryFnOnce::call`], so
/// that it is compiled for the instruction set that is found at run time.
struct Frame<'a, 'b> {
    plan: &'a StepPlan,
    constants: &'a StepConstants,
    body: &'a mut Body<'b>,
    stats: StepStats,
    /// The lowest predicted height of the substep [m].
    lowest: f32,
}

impl NullaryFnOnce for Frame<'_, '_> {
    type Output = Result<StepStats, StepError>;

    #[inline(always)]
    fn call(mut self) -> Self::Output {
        self.stats.substeps = self.constants.substeps;
        for substep in 0..self.constants.substeps {
            for &pass in self.plan.passes() {
                if pass == Pass::Ground && self.lowest > self.constants.ground {
                    self.stats.ground_passes_skipped += 1;
                } else {
                    self.stats.passes += 1;
                    self.run(pass, substep)?;
                }
            }
        }
        Ok(self.stats)
    }
}

impl Frame<'_, '_> {
    #[inline(always)]
    fn run(&mut self, pass: Pass, substep: u32) -> Result<(), StepError> {
        let Self {
            constants,
            body,
            stats,
            ..
        } = self;
        let (x, d) = (&mut *body.positions, &mut *body.displacements);
        match pass {
            Pass::Predict => {
                self.lowest = predict::predict(x, d, body.velocities, constants);
            }
            Pass::Pins => pins::pins(x, d, body.pins, constants.substeps - substep),
            Pass::ResetMultipliers => {
                if constants.stretch.keeps {
                    for batch in body.stretch.all_mut() {
                        batch.reset_multipliers();
                    }
                }
                if let Some(set) = &mut body.bending
                    && constants.bending.keeps
                {
                    for batch in set.all_mut() {
                        batch.reset_multipliers();
                    }
                }
            }
            Pass::Stretch { color } => {
                let batch = &mut body.stretch.batches[color];
                stats.stretch_projections += batch.len() as u64;
                stretch::stretch(x, d, batch, constants.stretch);
            }
            Pass::StretchOverflow => {
                let batch = &mut body.stretch.overflow;
                stats.stretch_projections += batch.len() as u64;
                stretch::stretch_serial(x, d, batch, constants.stretch);
            }
            Pass::Bending { color } => {
                if let Some(set) = &mut body.bending {
                    let batch = &mut set.batches[color];
                    stats.bending_projections += batch.len() as u64;
                    bending::bending(x, d, batch, constants.bending);
                }
            }
            Pass::BendingOverflow => {
                if let Some(set) = &mut body.bending {
                    stats.bending_projections += set.overflow.len() as u64;
                    bending::bending_serial(x, d, &mut set.overflow, constants.bending);
                }
            }
            Pass::Ground => {
                stats.ground_passes += 1;
                ground::ground(x, d, constants.ground, constants.friction);
            }
            Pass::Integrate => {
                let finite = integrate::integrate(x, d, body.velocities, constants);
                if !finite {
                    return Err(StepError::NonFinitePosition {
                        vertex: integrate::first_non_finite(x),
                        substep,
                    });
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraints::StretchSet;
    use crate::material::{Projection, Stiffness};
    use crate::plan::PlanKey;
    use incise_mesh::VertexId;

    #[test]
    fn a_spring_is_backward_euler_to_the_step() {
        let (compliance, mass, h) = (1e-3_f32, 2.0_f32, 0.01_f32);
        let mut positions = [[0.0; 4], [1.25, 0.0, 0.0, 1.0 / mass]];
        let (mut displacements, mut velocities) = ([[0.0; 4]; 2], [[0.0; 4]; 2]);
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
            plan.update(key, &stretch, None);
            let constants = StepConstants {
                h,
                substeps: 1,
                gravity_step: [0.0; 3],
                kept_velocity: 1.0,
                stretch: projection,
                bending: Projection {
                    factor: 0.0,
                    alpha: 0.0,
                    keeps: false,
                },
                ground: f32::NEG_INFINITY,
                friction: 0.0,
            };
            let stiff = 1.0 + f64::from(h * h) / f64::from(compliance * mass);
            let mut expected = f64::from(positions[1][0]) - 1.0;
            let mut before = expected - f64::from(velocities[1][0]) * f64::from(h);
            for step in 0..200 {
                let mut body = Body {
                    positions: &mut positions,
                    displacements: &mut displacements,
                    velocities: &mut velocities,
                    stretch: &mut stretch,
                    bending: None,
                    pins: &[],
                };
                CpuBackend.execute(&plan, &constants, &mut body).unwrap();
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
