//! The paper's Table 1.

use incise_models::Model;

/// One row of the paper's table.
pub(crate) struct PaperRow {
    pub(crate) pbd_fps: f64,
    pub(crate) pbd_cs_fps: f64,
    pub(crate) difference_percent: f64,
    pub(crate) cut_ms: f64,
}

/// Returns the paper's numbers for a model.
pub(crate) const fn row(model: Model) -> PaperRow {
    let (pbd_fps, pbd_cs_fps, difference_percent, cut_ms) = match model {
        Model::Sphere20 => (231.8, 205.9, 11.17, 11.33),
        Model::Sphere80 => (231.3, 177.2, 23.39, 12.66),
        Model::Sphere768 => (158.6, 108.4, 31.65, 21.66),
        Model::Bunny => (135.6, 79.9, 41.08, 29.33),
        Model::Octopus => (103.2, 51.7, 49.9, 38.0),
        Model::Banana => (72.9, 32.1, 55.97, 80.0),
        Model::Armadillo => (9.9, 5.2, 47.47, 239.33),
    };
    PaperRow {
        pbd_fps,
        pbd_cs_fps,
        difference_percent,
        cut_ms,
    }
}
