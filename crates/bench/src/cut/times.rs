//! Times of the stages of a cut.

use crate::statistics::{percentile, sorted};
use incise_cut::CutReport;
use serde::{Serialize, Serializer};
use std::time::Duration;

/// Stages of a cut; the last is their sum.
const STAGES: [&str; 10] = [
    "refit",
    "detect",
    "split",
    "cap",
    "refine",
    "separate",
    "commit",
    "bvh_update",
    "constraints",
    "total",
];

/// Times of the stages of a cut, or a statistic of many \[ms\].
#[derive(Debug, Clone, Copy)]
pub(super) struct Times([f64; 10]);

impl Times {
    /// Returns the times of a report and of the update of constraints.
    pub(super) fn new(report: &CutReport, constraints: Duration) -> Self {
        let stages = [
            Duration::ZERO,
            report.detection,
            report.split,
            report.cap,
            report.refinement,
            report.separation,
            report.commit,
            report.bvh_update,
            constraints,
            report.total() + constraints,
        ];
        Self(stages.map(|time| time.as_secs_f64() * 1e3))
    }

    /// Returns the same with the time of a refit and another sum.
    pub(super) fn with_refit(mut self, refit: Duration, total: Duration) -> Self {
        self.0[0] = refit.as_secs_f64() * 1e3;
        self.0[9] = total.as_secs_f64() * 1e3;
        self
    }

    /// Returns a percentile of every stage.
    pub(super) fn percentile(all: &[Self], percent: usize) -> Self {
        let of = |stage: usize| all.iter().map(|times| times.0[stage]).collect();
        Self(std::array::from_fn(|stage| {
            percentile(&sorted(of(stage)), percent)
        }))
    }

    /// Returns the sum of all stages.
    pub(super) fn total(&self) -> f64 {
        self.0[9]
    }
}

impl Serialize for Times {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_map(STAGES.into_iter().zip(self.0))
    }
}
