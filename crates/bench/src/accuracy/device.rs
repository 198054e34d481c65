//! Motions on a GPU.

use super::run::{Run, Times, timed};
use super::scene::{Body, DT};
use incise_bench::State;
use incise_pbd_gpu::{AdapterRequest, GpuBackend, GpuError, SolverParams};
use std::time::Instant;

/// An open GPU.
pub(super) struct Device {
    request: AdapterRequest,
    gpu: GpuBackend,
}

impl Device {
    /// Opens the GPU of that name, else the best there is, software if there is nothing else.
    ///
    /// # Errors
    /// Why there is none.
    pub(super) fn open(adapter: Option<&str>) -> Result<Self, String> {
        let request = AdapterRequest::any(adapter.map(str::to_owned));
        let gpu = GpuBackend::new(&request).map_err(|error| error.to_string())?;
        Ok(Self { request, gpu })
    }

    pub(super) fn name(&self) -> &str {
        &self.gpu.adapter().name
    }

    /// Steps a body, again and again from its start. A frame ends when the device is done; what is read back is not
    /// timed.
    ///
    /// # Errors
    /// What the device says.
    pub(super) fn run(
        &mut self,
        body: &Body,
        params: &SolverParams,
        frames: u32,
    ) -> Result<Run, String> {
        let run = timed(|times, states| self.repeat(body, params, frames, times, states));
        run.map_err(|error: GpuError| {
            // The next run starts on a device without a past.
            if let Ok(gpu) = GpuBackend::new(&self.request) {
                self.gpu = gpu;
            }
            error.to_string()
        })
    }

    fn repeat(
        &mut self,
        body: &Body,
        params: &SolverParams,
        frames: u32,
        times: &mut Times,
        mut states: Option<&mut Vec<State>>,
    ) -> Result<u64, GpuError> {
        let Body {
            mut surface,
            mut solver,
        } = body.clone();
        let place = self.gpu.add(&surface, &mut solver)?;
        // The device's own clock is looked at in the run that is looked at anyway.
        self.gpu.time_steps(states.is_some())?;
        let mut projections = 0;
        for _ in 0..frames {
            let begin = Instant::now();
            let stats = self.gpu.step([(place, &mut solver)], DT, params)?;
            projections = stats.stretch_projections + stats.bending_projections;
            times.encode.push(begin.elapsed().as_secs_f64());
            self.gpu.wait()?;
            times.frames.push(begin.elapsed().as_secs_f64());
            times.device.extend(self.gpu.step_seconds()?);
            if let Some(states) = states.as_deref_mut() {
                self.gpu.read(place, &mut surface, &mut solver)?;
                states.push(State::of(&solver, &surface));
            }
        }
        self.gpu.remove(place);
        Ok(projections)
    }
}
