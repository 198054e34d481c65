//! Times the motion of a scene on the CPU or on a GPU.

use super::convergence::Trajectory;
use crate::gpu::Device;
use crate::measure::{Budget, Times, measure};
use crate::motion::{Body, DT};
use incise_pbd_gpu::{SolverParams, StepError};
use incise_reference::{Model, PatchStepper, ReferenceError, State};

/// Short runs are repeated three times or more, long ones not at all.
const BUDGET: Budget = Budget {
    warm_up: 0,
    runs: [3, u32::MAX],
    seconds: [0.04, 0.5],
};

/// The states and times of a run.
#[derive(Default)]
pub(super) struct Run {
    /// The states of the first repetition.
    pub(super) states: Trajectory,
    /// Times of frames until the backend is done.
    pub(super) frames: Times,
    /// Times to encode a frame on a GPU.
    pub(super) encode: Times,
    /// Times of frames by the timestamps of a GPU that has them.
    pub(super) device: Times,
    /// Projections of a frame.
    pub(super) projections: u64,
}

/// Repeats a motion, which records its times, and its states if there are none yet.
fn repeated<E>(mut once: impl FnMut(&mut Run) -> Result<(), E>) -> Result<Run, E> {
    let mut run = Run::default();
    measure(&BUDGET, |_| once(&mut run))?;
    Ok(run)
}

/// Steps a body on the CPU, repeatedly from its start.
pub(super) fn on_cpu(body: &Body, params: &SolverParams, frames: u32) -> Result<Run, StepError> {
    repeated(|run| {
        let is_first = run.states.is_empty();
        let Body { surface, solver } = &mut body.clone();
        for _ in 0..frames {
            let stats = run.frames.time(|| solver.step(surface, DT, params))?;
            run.projections = stats.stretch_projections + stats.bending_projections;
            if is_first {
                run.states.push(State::of(solver, surface));
            }
        }
        Ok(())
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
    let substeps = params.substeps(DT);
    let h = f64::from(DT) / f64::from(substeps);
    repeated(|run| {
        let is_first = run.states.is_empty();
        let mut state = start.clone();
        for _ in 0..frames {
            run.frames.time(|| {
                for _ in 0..substeps {
                    stepper.step(&mut state, h, params.iterations);
                }
                Ok::<(), ReferenceError>(())
            })?;
            if is_first {
                run.states.push(state.clone());
            }
        }
        Ok(())
    })
}

/// Steps a body on a GPU, repeatedly from its start; a frame ends when the GPU is done. Reading
/// back is not timed.
#[cfg(feature = "gpu")]
pub(super) fn on_gpu(
    device: &mut Device,
    body: &Body,
    params: &SolverParams,
    frames: u32,
) -> Result<Run, incise_pbd_gpu::GpuError> {
    let repeat = |gpu: &mut incise_pbd_gpu::GpuBackend, run: &mut Run| {
        let is_first = run.states.is_empty();
        let Body { surface, solver } = &mut body.clone();
        let place = gpu.add(surface, solver)?;
        // Timestamps are taken in the run whose states are read back.
        gpu.time_steps(is_first)?;
        for _ in 0..frames {
            let begin = std::time::Instant::now();
            let stats = gpu.step([(place, &mut *solver)], DT, params)?;
            run.projections = stats.stretch_projections + stats.bending_projections;
            run.encode.0.push(begin.elapsed().as_secs_f64());
            gpu.wait()?;
            run.frames.0.push(begin.elapsed().as_secs_f64());
            run.device.0.extend(gpu.step_seconds()?);
            if is_first {
                gpu.read(place, surface, solver)?;
                run.states.push(State::of(solver, surface));
            }
        }
        gpu.remove(place);
        Ok(())
    };
    device.measure(|gpu| repeated(|run| repeat(gpu, run)))
}

#[cfg(not(feature = "gpu"))]
pub(super) fn on_gpu(
    device: &mut Device,
    _: &Body,
    _: &SolverParams,
    _: u32,
) -> Result<Run, crate::gpu::NoGpu> {
    match *device {}
}
