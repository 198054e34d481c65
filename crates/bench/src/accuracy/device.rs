//! Times the motion of a scene on a GPU.

use super::run::{GpuTimes, Run, timed};
use super::scene::{Body, DT};
use crate::measure::Times;
use incise_pbd_gpu::{AdapterRequest, GpuBackend, GpuError, SolverParams};
use incise_reference::State;
use std::time::Instant;

/// An open GPU.
pub(super) struct Device {
    request: AdapterRequest,
    gpu: GpuBackend,
}

impl Device {
    /// Opens the GPU of that name, or the best one; software if there is no other.
    ///
    /// # Errors
    /// [`GpuError`].
    pub(super) fn open(adapter: Option<&str>) -> Result<Self, GpuError> {
        let request = AdapterRequest::any(adapter.map(str::to_owned));
        let gpu = GpuBackend::new(&request)?;
        Ok(Self { request, gpu })
    }

    pub(super) fn name(&self) -> &str {
        &self.gpu.adapter().name
    }

    /// Steps a body, repeatedly from its start; a frame ends when the GPU is done. Reading back is
    /// not timed.
    ///
    /// # Errors
    /// [`GpuError`].
    pub(super) fn run(
        &mut self,
        body: &Body,
        params: &SolverParams,
        frames: u32,
    ) -> Result<Run, GpuError> {
        let run = timed(|times, gpu, states| self.repeat(body, params, frames, times, gpu, states));
        // After an error the next run starts on a new device.
        if run.is_err()
            && let Ok(gpu) = GpuBackend::new(&self.request)
        {
            self.gpu = gpu;
        }
        run
    }

    fn repeat(
        &mut self,
        body: &Body,
        params: &SolverParams,
        frames: u32,
        times: &mut Times,
        gpu_times: &mut GpuTimes,
        mut states: Option<&mut Vec<State>>,
    ) -> Result<u64, GpuError> {
        let Body {
            mut surface,
            mut solver,
        } = body.clone();
        let place = self.gpu.add(&surface, &mut solver)?;
        // Timestamps are taken in the run whose states are read back.
        self.gpu.time_steps(states.is_some())?;
        let mut projections = 0;
        for _ in 0..frames {
            let begin = Instant::now();
            let stats = self.gpu.step([(place, &mut solver)], DT, params)?;
            projections = stats.stretch_projections + stats.bending_projections;
            gpu_times.encode.0.push(begin.elapsed().as_secs_f64());
            self.gpu.wait()?;
            times.0.push(begin.elapsed().as_secs_f64());
            gpu_times.device.0.extend(self.gpu.step_seconds()?);
            if let Some(states) = states.as_deref_mut() {
                self.gpu.read(place, &mut surface, &mut solver)?;
                states.push(State::of(&solver, &surface));
            }
        }
        self.gpu.remove(place);
        Ok(projections)
    }
}
