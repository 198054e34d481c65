//! The row of `table`, written as JSON and read by the report.

use super::paper::{self, PaperRow};
use crate::json::nan_if_null;
use crate::numbers::{fixed, ratio};
use crate::text_table::Column;
use incise_models::Model;
use serde::{Deserialize, Serialize};

/// A row of the table.
///
/// Fields missing in older files take their defaults.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Row {
    pub(crate) model: String,
    pub(crate) source: String,
    pub(crate) vertices: usize,
    pub(crate) particles: usize,
    pub(crate) triangles: usize,
    /// Triangles after the last cut of PBD + CS.
    pub(crate) triangles_after: usize,
    /// Requested backend.
    pub(crate) backend: String,
    /// Machine or GPU that stepped the body.
    pub(crate) device: String,
    /// GPU schedule at the start; none on the CPU.
    pub(crate) schedule: Option<String>,
    /// Mean upload of a frame with a cut; none on the CPU.
    pub(crate) bytes_uploaded_a_cut: Option<f64>,
    /// Mean readback of a frame with a cut; none on the CPU.
    pub(crate) bytes_read_a_cut: Option<f64>,
    /// Whether sweeps outside of the body's box are skipped.
    pub(crate) skips_far_sweeps: bool,
    pub(crate) pbd_fps: f64,
    pub(crate) pbd_cs_fps: f64,
    /// Frame rate of every simulated second; none for a second without a timed frame.
    pub(crate) pbd_fps_by_second: Vec<Option<f64>>,
    pub(crate) pbd_cs_fps_by_second: Vec<Option<f64>>,
    pub(crate) fps_difference_percent: f64,
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) cut_ms_mean: f64,
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) cut_ms_p99: f64,
    pub(crate) cuts: usize,
    pub(crate) cuts_refused: Vec<String>,
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) stretch_error_percent: f64,
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) volume_error_percent: f64,
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) cap_min_angle_deg: f64,
    /// Heap allocations of all frames without a cut, except the first of a run.
    pub(crate) allocations: usize,
    pub(crate) machine: String,
    pub(crate) commit: String,
    pub(crate) version: String,
    pub(crate) dt: f64,
    pub(crate) iterations: u32,
    pub(crate) seconds: f64,
    /// `exact` or `paper`; older files say `rebuild` for the paper's method, or nothing.
    pub(crate) method: String,
    pub(crate) level: f64,
    /// Growth of the caps' edge length \[m/m\].
    pub(crate) grading: f64,
    pub(crate) seed: u64,
    /// Whether pieces have volume constraints.
    pub(crate) volume: bool,
    /// Whether bodies have interior springs.
    #[serde(alias = "struts")]
    pub(crate) interior_springs: bool,
    /// Whether pieces have contacts.
    pub(crate) contacts: bool,
}

impl Row {
    /// Returns a number of the paper for the row's model.
    pub(crate) fn paper(&self, of: fn(&PaperRow) -> f64) -> Option<f64> {
        let model = Model::ALL
            .into_iter()
            .find(|model| model.name() == self.model);
        model.map(|model| of(&paper::row(model)))
    }

    /// Returns how many times better than the paper a number of the row is: the paper's over it.
    fn gain(&self, of: fn(&PaperRow) -> f64, ours: f64) -> String {
        ratio(self.paper(of).map(|theirs| theirs / ours))
    }
}

/// Columns of the printed table and of the report.
pub(crate) const COLUMNS: &[Column<Row>] = &[
    ("model", |row| row.model.clone()),
    ("source", |row| row.source.clone()),
    ("vertices", |row| row.vertices.to_string()),
    ("particles", |row| row.particles.to_string()),
    ("triangles", |row| row.triangles.to_string()),
    ("PBD FPS", |row| fixed(row.pbd_fps, 1)),
    ("paper", |row| fixed(row.paper(|p| p.pbd_fps), 1)),
    ("x", |row| {
        row.gain(|p| p.pbd_fps.recip(), row.pbd_fps.recip())
    }),
    ("PBD+CS FPS", |row| fixed(row.pbd_cs_fps, 1)),
    ("paper", |row| fixed(row.paper(|p| p.pbd_cs_fps), 1)),
    ("x", |row| {
        row.gain(|p| p.pbd_cs_fps.recip(), row.pbd_cs_fps.recip())
    }),
    ("diff %", |row| fixed(row.fps_difference_percent, 1)),
    ("paper", |row| fixed(row.paper(|p| p.difference_percent), 2)),
    ("x", |row| {
        row.gain(|p| p.difference_percent, row.fps_difference_percent)
    }),
    ("cut ms", |row| fixed(row.cut_ms_mean, 3)),
    ("paper", |row| fixed(row.paper(|p| p.cut_ms), 2)),
    ("x", |row| row.gain(|p| p.cut_ms, row.cut_ms_mean)),
    ("p99 ms", |row| fixed(row.cut_ms_p99, 3)),
    ("cuts", |row| row.cuts.to_string()),
    ("failed", |row| row.cuts_refused.len().to_string()),
    ("triangles after", |row| row.triangles_after.to_string()),
    ("stretch %", |row| fixed(row.stretch_error_percent, 3)),
    ("volume %", |row| fixed(row.volume_error_percent, 2)),
    ("cap angle", |row| fixed(row.cap_min_angle_deg, 1)),
];
