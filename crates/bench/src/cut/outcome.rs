//! What became of many cuts.

use super::specimen::Cut;
use super::times::Times;
use crate::statistics::median;
use incise_cut::CutError;

/// What became of many cuts.
#[derive(Debug, Default)]
pub(super) struct Outcomes {
    pub(super) times: Vec<Times>,
    pub(super) hits: Vec<f64>,
    pub(super) cap_triangles: Vec<f64>,
    pub(super) missed: usize,
    pub(super) failures: Vec<String>,
}

impl Outcomes {
    pub(super) fn add(&mut self, cut: &Cut) {
        self.times.push(cut.times);
        self.hits.push(cut.hits as f64);
        self.cap_triangles.push(cut.cap_triangles as f64);
    }

    /// Notes a cut that could not be done.
    pub(super) fn fail(&mut self, error: CutError, plane: [f64; 4]) {
        let [x, y, z, d] = plane;
        self.failures
            .push(format!("{error} (plane {x},{y},{z},{d})"));
    }

    /// The medians of triangles hit and of triangles of the caps.
    pub(super) fn medians(&self) -> [f64; 2] {
        [&self.hits, &self.cap_triangles].map(|values| {
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            median(&sorted)
        })
    }
}
