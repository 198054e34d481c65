//! One motion by a solver, timed.

use super::ladder::Trajectory;
use super::scene::{Body, DT};
use crate::statistics::median;
use incise_bench::State;
use incise_pbd_gpu::{SolverParams, StepError};
use std::time::{Duration, Instant};

/// Runs are repeated for at least this long,
const LEAST: Duration = Duration::from_millis(40);
/// and at least so often where they are not much longer.
const REPEATS: usize = 3;
const MUCH: Duration = Duration::from_millis(500);

/// What a run was.
pub(super) struct Run {
    pub(super) states: Trajectory,
    /// The median time of a frame \[s\].
    pub(super) seconds: f64,
    /// Of a device: until it was told what to do, and what it took by its own clock \[s\].
    pub(super) encode: Option<f64>,
    pub(super) device: Option<f64>,
    /// Of a frame.
    pub(super) projections: u64,
}

/// Times of frames \[s\]. Those that a backend does not know it has none of.
#[derive(Default)]
pub(super) struct Times {
    pub(super) frames: Vec<f64>,
    pub(super) encode: Vec<f64>,
    pub(super) device: Vec<f64>,
}

/// Repeats a motion. `once` pushes the times of every frame, and the state at its end where it is given a place for that,
/// and returns the projections of a frame.
pub(super) fn timed<E>(
    mut once: impl FnMut(&mut Times, Option<&mut Vec<State>>) -> Result<u64, E>,
) -> Result<Run, E> {
    let begin = Instant::now();
    let (mut times, mut states) = (Times::default(), Vec::new());
    let projections = once(&mut times, Some(&mut states))?;
    for repeat in 1.. {
        let spent = begin.elapsed();
        if spent > MUCH || repeat >= REPEATS && spent > LEAST {
            break;
        }
        once(&mut times, None)?;
    }
    let middle = |mut times: Vec<f64>| {
        times.sort_unstable_by(f64::total_cmp);
        median(&times)
    };
    let known = |times: Vec<f64>| (!times.is_empty()).then(|| middle(times));
    Ok(Run {
        states,
        seconds: middle(times.frames),
        encode: known(times.encode),
        device: known(times.device),
        projections,
    })
}

/// Steps a body on the processor, again and again from its start.
pub(super) fn on_processor(
    body: &Body,
    params: &SolverParams,
    frames: u32,
) -> Result<Run, StepError> {
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
