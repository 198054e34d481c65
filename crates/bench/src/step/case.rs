//! A workload at the start of every measurement, and its row.

use super::row::{Measured, Row};
use crate::clock::{self, Budget, FrameTimes};
use crate::workload::Workload;
use incise_mesh::Surface;
#[cfg(feature = "gpu")]
use incise_pbd_gpu::PatchParams;
use incise_pbd_gpu::{Solver, SolverParams, StepError};
use std::error::Error;

/// Length of a frame \[s\].
pub(super) const DT: f32 = 1.0 / 60.0;

/// The setup that all measurements share.
pub(super) struct Setup {
    pub(super) params: SolverParams,
    pub(super) bodies: u32,
    pub(super) budget: Budget,
    pub(super) machine: String,
    pub(super) commit: String,
}

/// A workload with its solver.
pub(super) struct Case<'a> {
    workload: &'a Workload,
    pub(super) setup: &'a Setup,
    surface: Surface,
    solver: Solver,
}

/// The backend of a row.
pub(super) struct Origin<'a> {
    pub(super) backend: &'static str,
    pub(super) device: &'a str,
    pub(super) driver: Option<&'a str>,
    pub(super) schedule: &'static str,
    /// Whether the backend chooses this schedule.
    pub(super) chosen: bool,
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
            speed_up_over_colors: None,
            speed_up_over_cpu: None,
        }
    }

    /// Returns a row; the error of a measurement becomes its refusal.
    pub(super) fn row(&self, origin: &Origin<'_>, measured: Result<Measured, String>) -> Row {
        let (measured, refusal) = match measured {
            Ok(measured) => (Some(measured), None),
            Err(error) => (None, Some(error)),
        };
        Row {
            model: self.workload.name.clone(),
            source: self.workload.source.clone(),
            triangles: self.surface.topology().triangle_count(),
            vertices: self.surface.topology().vertex_count(),
            constraints: self.constraints(),
            bodies: self.setup.bodies,
            backend: origin.backend.to_owned(),
            device: origin.device.to_owned(),
            driver: origin.driver.map(str::to_owned),
            schedule: origin.schedule.to_owned(),
            chosen: origin.chosen,
            iterations: self.setup.params.iterations,
            substeps: self.setup.params.substeps,
            measured,
            refusal,
            machine: self.setup.machine.clone(),
            commit: self.setup.commit.clone(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }

    /// Measures the workload on the CPU.
    pub(super) fn on_cpu(&self) -> Row {
        let mut bodies = self.bodies();
        let times = clock::frame_times(self.setup.budget, |frames| {
            for _ in 0..frames {
                for (surface, solver) in &mut bodies {
                    solver.step(surface, DT, &self.setup.params)?;
                }
            }
            Ok::<(), StepError>(())
        });
        let origin = Origin {
            backend: "cpu",
            device: &self.setup.machine,
            driver: None,
            schedule: "colors",
            chosen: true,
        };
        let measured = times.map(|times| self.measured(&times));
        self.row(&origin, measured.map_err(|error| error.to_string()))
    }
}
