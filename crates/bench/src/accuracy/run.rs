//! Times the motion of a scene on the CPU.

use super::convergence::Trajectory;
use super::scene::{Body, DT};
use crate::measure::{Budget, Times, measure};
use incise_pbd_gpu::{SolverParams, StepError};
use incise_reference::{Model, PatchStepper, ReferenceError, State};

/// Short runs are repeated three times or more, long ones not at all.
const BUDGET: Budget = Budget {
    warm_up: 0,
    runs: [3, u32::MAX],
    seconds: [0.04, 0.5],
};

/// The states and times of a run.
pub(super) struct Run {
    pub(super) states: Trajectory,
    /// Median time of a frame \[s\].
    pub(super) seconds: f64,
    /// GPU runs: encoding time, and time by timestamps \[s\].
    pub(super) encode: Option<f64>,
    pub(super) device: Option<f64>,
    /// Projections of a frame.
    pub(super) projections: u64,
}

/// Times of frames; empty where a backend does not measure them.
#[derive(Default)]
pub(super) struct GpuTimes {
    pub(super) encode: Times,
    pub(super) device: Times,
}

/// Repeats a motion. `once` records the times of every frame, pushes its state if asked to, and
/// returns the projections of a frame.
pub(super) fn timed<E>(
    mut once: impl FnMut(&mut Times, &mut GpuTimes, Option<&mut Vec<State>>) -> Result<u64, E>,
) -> Result<Run, E> {
    let (mut gpu, mut states, mut projections) = (GpuTimes::default(), Vec::new(), 0);
    let mut is_first = true;
    let frames = measure(&BUDGET, |frames| {
        let kept = std::mem::take(&mut is_first).then_some(&mut states);
        projections = once(frames, &mut gpu, kept)?;
        Ok(())
    })?;
    let known = |times: &Times| (!times.0.is_empty()).then(|| times.median());
    Ok(Run {
        states,
        seconds: frames.median(),
        encode: known(&gpu.encode),
        device: known(&gpu.device),
        projections,
    })
}

/// Steps a body on the CPU, repeatedly from its start.
pub(super) fn on_cpu(body: &Body, params: &SolverParams, frames: u32) -> Result<Run, StepError> {
    timed(|times, _, mut states| {
        let Body {
            mut surface,
            mut solver,
        } = body.clone();
        let mut projections = 0;
        for _ in 0..frames {
            let stats = times.time(|| solver.step(&mut surface, DT, params))?;
            projections = stats.stretch_projections + stats.bending_projections;
            if let Some(states) = states.as_deref_mut() {
                states.push(State::of(&solver, &surface));
            }
        }
        Ok(projections)
    })
}

/// Steps a body by rigid patches, repeatedly from its start.
pub(super) fn by_patches(
    body: &Body,
    params: &SolverParams,
    frames: u32,
) -> Result<Run, ReferenceError> {
    let model = Model::of(&body.solver, &body.surface, params)?;
    let start = State::of(&body.solver, &body.surface);
    let stepper = PatchStepper::new(&model, &start.x)?;
    let h = f64::from(DT) / f64::from(params.substeps);
    timed(|times, _, mut states| {
        let mut state = start.clone();
        for _ in 0..frames {
            times.time(|| {
                for _ in 0..params.substeps {
                    stepper.step(&mut state, h, params.iterations);
                }
                Ok::<(), ReferenceError>(())
            })?;
            if let Some(states) = states.as_deref_mut() {
                states.push(state.clone());
            }
        }
        Ok(0)
    })
}
