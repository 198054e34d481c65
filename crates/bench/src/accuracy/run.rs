//! One motion by a solver, timed.

use super::ladder::Trajectory;
use super::scene::{Body, DT};
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
    pub(super) projections: u64,
}

/// Steps a body on the processor, again and again from its start.
pub(super) fn on_processor(
    body: &Body,
    params: &SolverParams,
    frames: u32,
) -> Result<Run, StepError> {
    let begin = Instant::now();
    let mut times = Vec::new();
    let mut states = Vec::new();
    let mut projections = 0;
    for repeat in 0.. {
        let spent = begin.elapsed();
        if repeat > 0 && (spent > MUCH || repeat >= REPEATS && spent > LEAST) {
            break;
        }
        let Body {
            mut surface,
            mut solver,
        } = body.clone();
        for _ in 0..frames {
            let begin = Instant::now();
            let stats = solver.step(&mut surface, DT, params)?;
            times.push(begin.elapsed().as_secs_f64());
            projections = stats.stretch_projections + stats.bending_projections;
            if repeat == 0 {
                states.push(State::of(&solver, &surface));
            }
        }
    }
    times.sort_unstable_by(f64::total_cmp);
    Ok(Run {
        states,
        seconds: crate::statistics::median(&times),
        projections,
    })
}
