//! A model, ready to be measured on any backend.

use super::bytes::{Records, Work};
use super::clock::{Budget, Times};
use super::row::{Measured, Row};
use super::subject::Subject;
use incise_mesh::Surface;
use incise_pbd_gpu::{ConstraintError, Solver, SolverParams};

/// Time of a frame \[s\].
pub(super) const DT: f32 = 1.0 / 60.0;

/// What all measurements of a run have in common.
pub(super) struct Setup {
    pub(super) params: SolverParams,
    pub(super) bodies: u32,
    pub(super) budget: Budget,
    pub(super) machine: String,
    pub(super) commit: String,
}

/// A model and how it is measured.
pub(super) struct Case<'a> {
    subject: &'a Subject,
    pub(super) setup: &'a Setup,
    surface: Surface,
    solver: Solver,
}

/// Where a row was measured.
pub(super) struct Place<'a> {
    pub(super) backend: &'static str,
    pub(super) device: &'a str,
    pub(super) driver: Option<&'a str>,
    pub(super) schedule: &'static str,
    pub(super) chosen: bool,
}

impl<'a> Case<'a> {
    pub(super) fn new(subject: &'a Subject, setup: &'a Setup) -> Result<Self, ConstraintError> {
        let (surface, solver) = subject.body()?;
        Ok(Self {
            subject,
            setup,
            surface,
            solver,
        })
    }

    /// Bodies in the state in which every measurement starts.
    pub(super) fn bodies(&self) -> Vec<(Surface, Solver)> {
        let body = || (self.surface.clone(), self.solver.clone());
        (0..self.setup.bodies).map(|_| body()).collect()
    }

    /// The same divided into patches.
    #[cfg(feature = "gpu")]
    pub(super) fn patched_bodies(&self) -> Result<Vec<(Surface, Solver)>, ConstraintError> {
        let body = self.subject.patched()?;
        Ok((0..self.setup.bodies).map(|_| body.clone()).collect())
    }

    /// Constraints of one body.
    pub(super) fn constraints(&self) -> usize {
        self.stretch() + self.bending()
    }

    fn stretch(&self) -> usize {
        self.solver.stretch().len()
    }

    fn bending(&self) -> usize {
        self.solver.bending().map_or(0, |set| set.len())
    }

    /// What a frame of all bodies is.
    fn work(&self) -> Work {
        let all = |count: usize| count as u64 * u64::from(self.setup.bodies);
        Work {
            vertices: all(self.surface.topology().vertex_count()),
            stretch: all(self.stretch()),
            bending: all(self.bending()),
            iterations: self.setup.params.iterations.into(),
            substeps: self.setup.params.substeps.into(),
        }
    }

    /// What follows from times alone.
    #[expect(
        clippy::cast_precision_loss,
        reason = "far fewer than 2^53 bytes and projections a frame"
    )]
    pub(super) fn measured(
        &self,
        times: &Times,
        records: Records,
        bandwidth: Option<f64>,
    ) -> Measured {
        let work = self.work();
        let bytes = work.bytes(records);
        Measured {
            dispatches: None,
            frames: times.frames,
            ms_per_frame: times.per_frame * 1e3,
            ms_latency: times.latency * 1e3,
            frames_per_second: 1.0 / times.per_frame,
            projections_per_second: work.projections() as f64 / times.per_frame,
            bytes_uploaded: 0,
            bytes_uploaded_at_start: 0,
            bytes_modelled: bytes,
            bandwidth_bytes_per_second: bandwidth,
            share_of_bandwidth: bandwidth.map(|rate| bytes as f64 / times.per_frame / rate),
            speed_up_over_colors: None,
            speed_up_over_cpu: None,
        }
    }

    /// A row of this model.
    pub(super) fn row(&self, place: &Place<'_>, measured: Result<Measured, String>) -> Row {
        let (measured, refusal) = match measured {
            Ok(measured) => (Some(measured), None),
            Err(reason) => (None, Some(reason)),
        };
        Row {
            model: self.subject.name(),
            source: self.subject.source().to_owned(),
            triangles: self.surface.topology().triangle_count(),
            vertices: self.surface.topology().vertex_count(),
            constraints: self.constraints(),
            bodies: self.setup.bodies,
            backend: place.backend,
            device: place.device.to_owned(),
            driver: place.driver.map(str::to_owned),
            schedule: place.schedule,
            chosen: place.chosen,
            iterations: self.setup.params.iterations,
            substeps: self.setup.params.substeps,
            measured,
            refusal,
            machine: self.setup.machine.clone(),
            commit: self.setup.commit.clone(),
            version: env!("CARGO_PKG_VERSION"),
        }
    }
}
