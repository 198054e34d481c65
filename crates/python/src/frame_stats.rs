//! [`FrameStats`]: counters and times of a frame for Python.

use incise::scene::FrameStats as LibraryStats;
use pyo3::prelude::*;

/// Counters and times [s] of one frame.
#[pyclass(frozen, module = "incise", get_all)]
#[derive(Debug)]
pub(crate) struct FrameStats {
    /// Blades that moved.
    sweeps: u32,
    /// Sweeps that intersected no body.
    missed_sweeps: u32,
    /// Cuts done.
    cuts: u32,
    /// Cuts that failed.
    failed_cuts: u32,
    /// Triangles near sweeps.
    candidate_triangles: usize,
    /// Triangles that sweeps intersected.
    hit_triangles: usize,
    /// Contacts between bodies, pieces and blade faces.
    contacts: usize,
    /// Bodies that were asleep.
    sleeping_bodies: u32,
    /// Time of finding triangles that sweeps cross [s].
    detection: f64,
    /// Time of mesh edits [s].
    topology: f64,
    /// Time of meshing caps [s].
    refinement: f64,
    /// Time of updating constraints after cuts [s].
    constraint_update: f64,
    /// Time of finding contacts [s].
    contact_detection: f64,
    /// Time of the solver [s].
    solver: f64,
    /// Time of everything that a cut needs [s].
    cutting: f64,
    /// Time of the frame [s].
    total: f64,
}

impl FrameStats {
    pub(crate) fn new(stats: &LibraryStats) -> Self {
        Self {
            sweeps: stats.sweeps,
            missed_sweeps: stats.missed_sweeps,
            cuts: stats.cuts,
            failed_cuts: stats.failed_cuts,
            candidate_triangles: stats.candidate_triangles,
            hit_triangles: stats.hit_triangles,
            contacts: stats.contacts,
            sleeping_bodies: stats.sleeping_bodies,
            detection: stats.detection.as_secs_f64(),
            topology: stats.topology.as_secs_f64(),
            refinement: stats.refinement.as_secs_f64(),
            constraint_update: stats.constraint_update.as_secs_f64(),
            contact_detection: stats.contact_detection.as_secs_f64(),
            solver: stats.solver.as_secs_f64(),
            cutting: stats.cutting().as_secs_f64(),
            total: stats.total().as_secs_f64(),
        }
    }
}

#[pymethods]
impl FrameStats {
    fn __repr__(&self) -> String {
        format!(
            "<incise.FrameStats: {} cuts, {:.3} ms>",
            self.cuts,
            self.total * 1e3
        )
    }
}
