//! Times the motion of a scene on the CPU.

use super::convergence::Trajectory;
use super::scene::{Body, DT};
use crate::statistics::median;
use incise_pbd_gpu::{SolverParams, StepError};
use incise_reference::{Model, PatchStepper, ReferenceError, State};
use std::time::{Duration, Instant};

/// Smallest number of repetitions of a short run.
const MIN_REPEATS: usize = 3;
/// Shortest time of all repetitions.
const MIN_TIME: Duration = Duration::from_millis(40);
/// Time after which a run is not repeated.
const MAX_TIME: Duration = Duration::from_millis(500);

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

/// Times of frames \[s\]; empty where a backend does not measure them.
#[derive(Default)]
pub(super) struct Times {
    pub(super) frames: Vec<f64>,
    pub(super) encode: Vec<f64>,
    pub(super) device: Vec<f64>,
}

/// Repeats a motion. `once` pushes the times of every frame, pushes its state if asked to, and
/// returns the projections of a frame.
pub(super) fn timed<E>(
    mut once: impl FnMut(&mut Times, Option<&mut Vec<State>>) -> Result<u64, E>,
) -> Result<Run, E> {
    let begin = Instant::now();
    let (mut times, mut states) = (Times::default(), Vec::new());
    let projections = once(&mut times, Some(&mut states))?;
    for repeat in 1.. {
        let spent = begin.elapsed();
        if spent > MAX_TIME || repeat >= MIN_REPEATS && spent > MIN_TIME {
            break;
        }
        once(&mut times, None)?;
    }
    let known = |times: Vec<f64>| (!times.is_empty()).then(|| median(times));
    Ok(Run {
        states,
        seconds: median(times.frames),
        encode: known(times.encode),
        device: known(times.device),
        projections,
    })
}

/// Steps a body on the CPU, repeatedly from its start.
pub(super) fn on_cpu(body: &Body, params: &SolverParams, frames: u32) -> Result<Run, StepError> {
    timed(|times, mut states| {
        let Body {
            mut surface,
            mut solver,
        } = body.clone();
        let mut projections = 0;
        for _ in 0..frames {
            let begin = Instant::now();
            let stats = solver.step(&mut surface, DT, params)?;
            times.frames.push(begin.elapsed().as_secs_f64());
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
    timed(|times, mut states| {
        let mut state = start.clone();
        for _ in 0..frames {
            let begin = Instant::now();
            for _ in 0..params.substeps {
                stepper.step(&mut state, h, params.iterations);
            }
            times.frames.push(begin.elapsed().as_secs_f64());
            if let Some(states) = states.as_deref_mut() {
                states.push(state.clone());
            }
        }
        Ok(0)
    })
}
