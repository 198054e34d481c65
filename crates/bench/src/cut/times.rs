//! Times of the stages of a cut.

use crate::statistics::{percentile, sorted};
use incise_cut::CutReport;
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Times of a cut, or a statistic of many \[ms\].
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Times {
    /// Refit of the BVH of a body that has moved.
    pub(crate) refit: f64,
    /// Search and intersection.
    pub(crate) detect: f64,
    /// Edit of the mesh along the sweep.
    pub(crate) split: f64,
    pub(crate) cap: f64,
    pub(crate) refine: f64,
    /// Separation into pieces.
    pub(crate) separate: f64,
    /// Delta and undo.
    pub(crate) commit: f64,
    /// Update of the BVH.
    #[serde(alias = "search_tree")]
    pub(crate) bvh_update: f64,
    /// Update of the solver's constraints and masses.
    pub(crate) constraints: f64,
    /// Sum of all stages.
    pub(crate) total: f64,
}

impl Times {
    /// Returns the times of a report and of the update of constraints.
    pub(crate) fn new(report: &CutReport, constraints: Duration) -> Self {
        let ms = |time: Duration| time.as_secs_f64() * 1e3;
        Self {
            refit: 0.0,
            detect: ms(report.detection),
            split: ms(report.split),
            cap: ms(report.cap),
            refine: ms(report.refinement),
            separate: ms(report.separation),
            commit: ms(report.commit),
            bvh_update: ms(report.bvh_update),
            constraints: ms(constraints),
            total: ms(report.total() + constraints),
        }
    }

    /// Returns the median and the 99th percentile of every stage.
    pub(crate) fn summary(all: &[Self]) -> [Self; 2] {
        [50, 99].map(|percent| Self::percentile(all, percent))
    }

    /// Returns a percentile of every stage.
    pub(crate) fn percentile(all: &[Self], percent: usize) -> Self {
        let of =
            |stage: fn(&Self) -> f64| percentile(&sorted(all.iter().map(stage).collect()), percent);
        Self {
            refit: of(|t| t.refit),
            detect: of(|t| t.detect),
            split: of(|t| t.split),
            cap: of(|t| t.cap),
            refine: of(|t| t.refine),
            separate: of(|t| t.separate),
            commit: of(|t| t.commit),
            bvh_update: of(|t| t.bvh_update),
            constraints: of(|t| t.constraints),
            total: of(|t| t.total),
        }
    }

    /// Returns the part of the total that no stage has.
    pub(crate) fn rest(&self) -> f64 {
        let mesh = self.detect + self.split + self.cap + self.refine + self.separate;
        self.total - self.refit - mesh - self.commit - self.bvh_update - self.constraints
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stage_has_its_own_median() {
        let all = [[1.0, 30.0], [2.0, 20.0], [3.0, 10.0]].map(|[detect, cap]| Times {
            detect,
            cap,
            total: detect + cap,
            ..Times::default()
        });
        let [median, most] = Times::summary(&all);
        assert_eq!((median.detect, median.cap, median.total), (2.0, 20.0, 22.0));
        assert_eq!((most.detect, most.cap, most.total), (3.0, 30.0, 31.0));
    }
}
