//! What is known of a model's covers.

use crate::columns::measured;
use serde::Serialize;

/// What stands in the columns.
pub(super) const LEGEND: &str = "\
rim: points of the rims, tris: triangles of one cover; medians. ms: medians of the fastest of five, triangulation and refinement apart. \
Angles in degrees, the smallest of every triangle, of all covers together: the least, the least where no corner of the rim is below 40, \
the 5th percentile, that of the worst cover, the median. Edge: inner edges over their target, mean and longest; long: how many exceed 1.8.";

/// What was measured with and on.
#[derive(Debug, Clone, Default, Serialize)]
pub(super) struct Stamp {
    pub(super) grading: f64,
    pub(super) snap: f64,
    pub(super) seed: u64,
    pub(super) machine: String,
    pub(super) commit: String,
    pub(super) version: &'static str,
}

/// Covers of one model's sections at one level.
#[derive(Debug, Clone, Default, Serialize)]
pub(super) struct Row {
    pub(super) model: String,
    pub(super) source: String,
    /// `middle`: one plane through the middle; `seeded`: planes at random.
    pub(super) planes: &'static str,
    /// z.
    pub(super) level: f64,
    pub(super) covers: usize,
    pub(super) rim_points: f64,
    pub(super) triangles: f64,
    pub(super) triangulation_ms: f64,
    pub(super) refinement_ms: f64,
    pub(super) million_triangles_a_second: f64,
    pub(super) smallest_angle: f64,
    /// Where no corner of the rim is sharper than 40 degrees.
    pub(super) smallest_angle_free: f64,
    pub(super) rim_angle: f64,
    pub(super) angle_5: f64,
    pub(super) angle_5_worst: f64,
    pub(super) angle_median: f64,
    pub(super) edge_mean: f64,
    pub(super) edge_longest: f64,
    pub(super) long_edges: usize,
    /// Why sections could not be cut or covered.
    pub(super) failures: Vec<String>,
    #[serde(flatten)]
    pub(super) stamp: Stamp,
}

impl Row {
    pub(super) const NAMES: [&str; 18] = [
        "model", "planes", "z", "covers", "rim", "tris", "ms tri", "ms ref", "Mtri/s", "min",
        "min free", "5%", "5% worst", "median", "edge", "longest", "long", "source",
    ];

    pub(super) fn cells(&self) -> [String; 18] {
        [
            self.model.clone(),
            self.planes.to_owned(),
            measured(self.level, 2),
            self.covers.to_string(),
            measured(self.rim_points, 0),
            measured(self.triangles, 0),
            measured(self.triangulation_ms, 3),
            measured(self.refinement_ms, 3),
            measured(self.million_triangles_a_second, 2),
            measured(self.smallest_angle, 1),
            measured(self.smallest_angle_free, 1),
            measured(self.angle_5, 1),
            measured(self.angle_5_worst, 1),
            measured(self.angle_median, 1),
            measured(self.edge_mean, 3),
            measured(self.edge_longest, 2),
            self.long_edges.to_string(),
            self.source.clone(),
        ]
    }
}
