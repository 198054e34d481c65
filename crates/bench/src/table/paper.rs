//! The paper's Table 1.

use incise_models::Model;
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
    pub(super) const fn of(model: Model) -> Self {
        let (pbd_fps, pbd_cs_fps, fps_difference_percent, cut_ms) = match model {
            Model::Sphere20 => (231.8, 205.9, 11.17, 11.33),
            Model::Sphere80 => (231.3, 177.2, 23.39, 12.66),
            Model::Sphere768 => (158.6, 108.4, 31.65, 21.66),
            Model::Bunny => (135.6, 79.9, 41.08, 29.33),
            Model::Octopus => (103.2, 51.7, 49.9, 38.0),
            Model::Banana => (72.9, 32.1, 55.97, 80.0),
            Model::Armadillo => (9.9, 5.2, 47.47, 239.33),
        };
        Self {
            pbd_fps,
            pbd_cs_fps,
            fps_difference_percent,
            cut_ms,
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
