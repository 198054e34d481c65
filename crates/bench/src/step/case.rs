//! A workload at the start of every measurement, and its row.

use crate::measure::{FrameTimes, Length, measure_frames};
use crate::workload::Workload;
use incise_mesh::Surface;
#[cfg(feature = "gpu")]
use incise_pbd_gpu::PatchParams;
use incise_pbd_gpu::{Solver, SolverParams, StepError};
use serde::Serialize;
use std::error::Error;

/// Length of a frame \[s\].
pub(super) const DT: f32 = 1.0 / 60.0;

/// The setup that all measurements share.
pub(super) struct Setup {
    pub(super) params: SolverParams,
    pub(super) bodies: u32,
    pub(super) length: Length,
}

/// A workload with its solver.
pub(super) struct Case<'a> {
    workload: &'a Workload,
    pub(super) setup: &'a Setup,
    surface: Surface,
    solver: Solver,
}

/// A row with its backend and GPU; no GPU for the CPU.
pub(super) struct CaseRow {
    pub(super) backend: &'static str,
    pub(super) device: Option<String>,
    pub(super) row: Row,
}

/// Frames of a model on one backend and schedule.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Row {
    source: String,
    /// Of one body, like vertices and constraints.
    triangles: usize,
    vertices: usize,
    constraints: usize,
    /// Driver of the GPU; none on the CPU.
    driver: Option<String>,
    /// GPU schedule; `colors` on the CPU.
    schedule: &'static str,
    /// Whether the backend chooses this schedule.
    chosen: bool,
    /// None for a refusal.
    #[serde(flatten)]
    measured: Option<Measured>,
    /// The error of a measurement.
    refusal: Option<String>,
}

/// Measurements of all bodies together.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Measured {
    /// Dispatches of a frame; none on the CPU.
    pub(super) dispatches: Option<u32>,
    /// Number of timed frames, in batches.
    frames: u32,
    ms_per_frame: f64,
    ms_latency: f64,
    frames_per_second: f64,
    projections_per_second: f64,
    /// Upload of a frame without edits.
    pub(super) bytes_uploaded: u64,
    /// Upload before the first frame.
    pub(super) bytes_uploaded_at_start: u64,
    /// Time of the CPU over this time.
    speed_up_over_cpu: Option<f64>,
}

/// Sets the speed-ups of one model's rows.
pub(super) fn compare(rows: &mut [CaseRow]) {
    let cpu = rows.iter().find(|of| of.backend == "cpu");
    let cpu = cpu.and_then(|of| Some(of.row.measured.as_ref()?.ms_per_frame));
    for of in rows.iter_mut().filter(|of| of.device.is_some()) {
        if let Some(measured) = &mut of.row.measured {
            measured.speed_up_over_cpu = cpu.map(|ms| ms / measured.ms_per_frame);
        }
    }
}

impl<'a> Case<'a> {
    pub(super) fn new(workload: &'a Workload, setup: &'a Setup) -> Result<Self, Box<dyn Error>> {
        let (surface, solver) = workload.body(Solver::new)?;
        Ok(Self {
            workload,
            setup,
            surface,
            solver,
        })
    }

    /// Returns the bodies at their start.
    pub(super) fn bodies(&self) -> Vec<(Surface, Solver)> {
        let body = |_| (self.surface.clone(), self.solver.clone());
        (0..self.setup.bodies).map(body).collect()
    }

    /// Returns the bodies at their start, divided into patches or undivided.
    #[cfg(feature = "gpu")]
    pub(super) fn divided_bodies(
        &self,
        patches: Option<&PatchParams>,
    ) -> Result<Vec<(Surface, Solver)>, Box<dyn Error>> {
        let body = self
            .workload
            .body(|surface, material| Solver::with_patches(surface, material, patches))?;
        Ok((0..self.setup.bodies).map(|_| body.clone()).collect())
    }

    /// Returns the number of constraints of one body.
    pub(super) fn constraints(&self) -> usize {
        self.solver.stretch().len() + self.solver.bending().map_or(0, |set| set.len())
    }

    /// Returns the measurements that follow from times alone.
    #[expect(
        clippy::cast_precision_loss,
        reason = "far fewer than 2^53 projections per frame"
    )]
    pub(super) fn measured(&self, times: &FrameTimes) -> Measured {
        let SolverParams {
            substeps,
            iterations,
            ..
        } = self.setup.params;
        let projections = u64::from(substeps)
            * u64::from(iterations)
            * u64::from(self.setup.bodies)
            * self.constraints() as u64;
        Measured {
            dispatches: None,
            frames: times.frames,
            ms_per_frame: times.per_frame * 1e3,
            ms_latency: times.latency * 1e3,
            frames_per_second: 1.0 / times.per_frame,
            projections_per_second: projections as f64 / times.per_frame,
            bytes_uploaded: 0,
            bytes_uploaded_at_start: 0,
            speed_up_over_cpu: None,
        }
    }

    /// Returns a row; the error of a measurement becomes its refusal.
    pub(super) fn row(
        &self,
        driver: Option<&str>,
        (schedule, chosen): (&'static str, bool),
        measured: Result<Measured, String>,
    ) -> Row {
        let (measured, refusal) = match measured {
            Ok(measured) => (Some(measured), None),
            Err(error) => (None, Some(error)),
        };
        Row {
            source: self.workload.source.clone(),
            triangles: self.surface.topology().triangle_count(),
            vertices: self.surface.topology().vertex_count(),
            constraints: self.constraints(),
            driver: driver.map(str::to_owned),
            schedule,
            chosen,
            measured,
            refusal,
        }
    }

    /// Measures the workload on the CPU.
    pub(super) fn on_cpu(&self) -> CaseRow {
        let mut bodies = self.bodies();
        let times = measure_frames(self.setup.length, |frames| {
            for _ in 0..frames {
                for (surface, solver) in &mut bodies {
                    solver.step(surface, DT, &self.setup.params)?;
                }
            }
            Ok::<(), StepError>(())
        });
        let measured = times.map(|times| self.measured(&times));
        let measured = measured.map_err(|error| error.to_string());
        CaseRow {
            backend: "cpu",
            device: None,
            row: self.row(None, ("colors", true), measured),
        }
    }
}
