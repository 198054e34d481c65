//! The times that the paper published.

/// A row of the paper's Table 1.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PublishedRow {
    /// Name of the model.
    pub model: &'static str,
    /// Frames per second of the solver alone.
    pub pbd_fps: f64,
    /// Frames per second with a blade that cuts.
    pub pbd_cs_fps: f64,
    /// Loss of frames per second by the blade \[percent\].
    pub fps_difference_percent: f64,
    /// Time of a cut \[ms\].
    pub cut_ms: f64,
}

/// The paper's Table 1.
pub const TABLE_1: [PublishedRow; 7] = [
    row("Sphere20", [231.8, 205.9, 11.17, 11.33]),
    row("Sphere80", [231.3, 177.2, 23.39, 12.66]),
    row("Sphere768", [158.6, 108.4, 31.65, 21.66]),
    row("Bunny", [135.6, 79.9, 41.08, 29.33]),
    row("Octopus", [103.2, 51.7, 49.9, 38.0]),
    row("Banana", [72.9, 32.1, 55.97, 80.0]),
    row("Armadillo", [9.9, 5.2, 47.47, 239.33]),
];

const fn row(model: &'static str, numbers: [f64; 4]) -> PublishedRow {
    let [pbd_fps, pbd_cs_fps, fps_difference_percent, cut_ms] = numbers;
    PublishedRow {
        model,
        pbd_fps,
        pbd_cs_fps,
        fps_difference_percent,
        cut_ms,
    }
}
