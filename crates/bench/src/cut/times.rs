//! The steps of a cut and their times.

use crate::statistics::{median, percentile_99};
use incise_cut::CutReport;
use serde::Serialize;
use std::time::Duration;

/// Times of a cut, or what many come to \[ms\].
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub(super) struct Times {
    /// The search and the intersection.
    pub(super) detect: f64,
    /// The new boundary and the edit of the mesh.
    pub(super) split: f64,
    pub(super) cap: f64,
    pub(super) refine: f64,
    /// Finding the pieces.
    pub(super) separate: f64,
    /// Deriving the change and the way back.
    pub(super) commit: f64,
    /// The search tree that follows.
    pub(super) search_tree: f64,
    /// The solver's constraints and masses that follow.
    pub(super) constraints: f64,
    /// All together.
    pub(super) total: f64,
}

impl Times {
    pub(super) fn of(report: &CutReport, constraints: Duration) -> Self {
        let ms = |time: Duration| time.as_secs_f64() * 1e3;
        Self {
            detect: ms(report.detection),
            split: ms(report.split),
            cap: ms(report.cap),
            refine: ms(report.refinement),
            separate: ms(report.separation),
            commit: ms(report.commit),
            search_tree: ms(report.search_tree),
            constraints: ms(constraints),
            total: ms(report.total() + constraints),
        }
    }

    /// The medians of all times and their 99th percentiles, each step for itself.
    pub(super) fn summary(all: &[Self]) -> [Self; 2] {
        [median, percentile_99].map(|pick| {
            let of = |step: fn(&Self) -> f64| {
                let mut values: Vec<f64> = all.iter().map(step).collect();
                values.sort_by(f64::total_cmp);
                pick(&values)
            };
            Self {
                detect: of(|t| t.detect),
                split: of(|t| t.split),
                cap: of(|t| t.cap),
                refine: of(|t| t.refine),
                separate: of(|t| t.separate),
                commit: of(|t| t.commit),
                search_tree: of(|t| t.search_tree),
                constraints: of(|t| t.constraints),
                total: of(|t| t.total),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_step_has_a_median_of_its_own() {
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
