//! The paper's Table 1.

use incise_models::Model;
use incise_paper::TABLE_1;
use serde::Serialize;

/// One row of the paper's table, or the ratios of another to it.
#[derive(Debug, Serialize)]
pub(super) struct PaperRow {
    pub(super) pbd_fps: f64,
    pub(super) pbd_cs_fps: f64,
    pub(super) fps_difference_percent: f64,
    pub(super) cut_ms: f64,
}

impl PaperRow {
    /// Returns the paper's numbers for a model.
    pub(super) fn of(model: Model) -> Self {
        let row = TABLE_1.iter().find(|row| row.model == model.name());
        let row = row.expect("the table has every model");
        Self {
            pbd_fps: row.pbd_fps,
            pbd_cs_fps: row.pbd_cs_fps,
            fps_difference_percent: row.fps_difference_percent,
            cut_ms: row.cut_ms,
        }
    }

    /// Returns how many times better other numbers are.
    pub(super) fn gain(&self, other: &Self) -> Self {
        Self {
            pbd_fps: other.pbd_fps / self.pbd_fps,
            pbd_cs_fps: other.pbd_cs_fps / self.pbd_cs_fps,
            fps_difference_percent: self.fps_difference_percent / other.fps_difference_percent,
            cut_ms: self.cut_ms / other.cut_ms,
        }
    }
}
