//! Who executes a plan. The CPU runs one function a kernel.

use crate::error::StepError;
use crate::kernels::{bending, ground, integrate, pins, predict, stretch};
use crate::params::StepStats;
use crate::plan::{Body, Pass, StepConstants, StepPlan};

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
        let arch = pulp::Arch::new();
        let mut stats = StepStats {
            substeps: constants.substeps,
            ..StepStats::default()
        };
        for substep in 0..constants.substeps {
            let mut lowest = f32::INFINITY;
            for &pass in plan.passes() {
                if pass == Pass::Ground && lowest > constants.ground {
                    stats.ground_passes_skipped += 1;
                    continue;
                }
                stats.passes += 1;
                run(
                    pass,
                    arch,
                    substep,
                    constants,
                    body,
                    &mut lowest,
                    &mut stats,
                )?;
            }
        }
        Ok(stats)
    }
}

fn run(
    pass: Pass,
    arch: pulp::Arch,
    substep: u32,
    constants: &StepConstants,
    body: &mut Body<'_>,
    lowest: &mut f32,
    stats: &mut StepStats,
) -> Result<(), StepError> {
    let (x, d) = (&mut *body.positions, &mut *body.displacements);
    match pass {
        Pass::Predict => {
            *lowest = arch.dispatch(|| predict::predict(x, d, body.velocities, constants));
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
            arch.dispatch(|| stretch::stretch(x, d, batch, constants.stretch));
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
                arch.dispatch(|| bending::bending(x, d, batch, constants.bending));
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
            let finite = arch.dispatch(|| integrate::integrate(x, d, body.velocities, constants));
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
