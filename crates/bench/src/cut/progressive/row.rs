//! Rows of progressive cuts.

use crate::cut::row::Stamp;
use crate::cut::times::Times;
use crate::json::nan_if_null;
use crate::numbers::fixed;
use crate::text_table::Column;
use serde::{Deserialize, Serialize};

/// Explains the columns.
pub(crate) const LEGEND: &str = "\
Steps of one mean edge length that cut; walls: triangles of both walls per step, median; times of \
stages in ms, medians. rest: all but the named stages, mostly the sweep and the new tip; refit: \
BVH of a body in motion; solver: update of constraints and masses. growth: mean step of the last \
tenth relative to the first. standing: a call with the blade inside and unmoved, in us. drag: one \
end of the blade in the body; press: both ends outside.";

/// Steps of a blade through one body, stroke after stroke.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Row {
    pub(crate) model: String,
    pub(crate) source: String,
    /// The kinds of strokes: `drag`, `press` or both in turns.
    pub(crate) strokes: String,
    /// Whether the planes of the strokes are `parallel` or `crossing`.
    pub(crate) planes: String,
    /// Whether the body is `still` or `turning`.
    pub(crate) motion: String,
    pub(crate) triangles: usize,
    pub(crate) triangles_at_end: usize,
    /// Number of bodies, one after the other.
    pub(crate) bodies: usize,
    pub(crate) stroke_count: usize,
    /// Steps that cut.
    pub(crate) steps: usize,
    /// Steps without a cut, outside of the body or too short.
    pub(crate) missed: usize,
    /// Triangles of all walls.
    pub(crate) wall_triangles: usize,
    /// Triangles of both walls of a step, median.
    pub(crate) wall_triangles_median: f64,
    pub(crate) ms_median: Times,
    pub(crate) ms_p90: Times,
    pub(crate) ms_p99: Times,
    pub(crate) ms_max: Times,
    /// Mean time of the steps of the first tenth \[ms\].
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) first_ms: f64,
    /// Mean time of the steps of the last tenth \[ms\].
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) last_ms: f64,
    /// Ratio of the last tenth to the first.
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) growth: f64,
    /// Mean wall triangles of the steps of the first tenth.
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) first_wall_triangles: f64,
    /// Mean wall triangles of the steps of the last tenth.
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) last_wall_triangles: f64,
    /// Time of a call with the blade inside and unmoved, median \[us\].
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) us_standing: f64,
    pub(crate) failures: Vec<Failure>,
    #[serde(flatten)]
    pub(crate) stamp: Stamp,
}

/// Refused steps of one kind.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Failure {
    /// The error's name.
    pub(crate) kind: String,
    pub(crate) count: usize,
    /// Place and message of the first.
    pub(crate) first: String,
}

impl Failure {
    /// Counts a failure.
    pub(super) fn add(all: &mut Vec<Self>, kind: &str, first: impl FnOnce() -> String) {
        if let Some(known) = all.iter_mut().find(|failure| failure.kind == kind) {
            known.count += 1;
        } else {
            all.push(Self {
                kind: kind.to_owned(),
                count: 1,
                first: first(),
            });
        }
    }
}

impl Row {
    /// Returns the number of refused steps.
    pub(crate) fn failure_count(&self) -> usize {
        self.failures.iter().map(|failure| failure.count).sum()
    }
}

/// Columns of the printed table and of the report.
pub(crate) const COLUMNS: &[Column<Row>] = &[
    ("model", |row| row.model.clone()),
    ("strokes", |row| row.strokes.clone()),
    ("planes", |row| row.planes.clone()),
    ("motion", |row| row.motion.clone()),
    ("n", |row| row.triangles.to_string()),
    ("steps", |row| row.steps.to_string()),
    ("walls", |row| fixed(row.wall_triangles_median, 0)),
    ("failed", |row| row.failure_count().to_string()),
    ("refit", |row| fixed(row.ms_median.refit, 3)),
    ("detect", |row| fixed(row.ms_median.detect, 3)),
    ("split", |row| fixed(row.ms_median.split, 3)),
    ("cap", |row| fixed(row.ms_median.cap, 3)),
    ("separate", |row| fixed(row.ms_median.separate, 3)),
    ("commit", |row| fixed(row.ms_median.commit, 3)),
    ("bvh", |row| fixed(row.ms_median.bvh_update, 3)),
    ("solver", |row| fixed(row.ms_median.constraints, 3)),
    ("rest", |row| fixed(row.ms_median.rest(), 3)),
    ("median", |row| fixed(row.ms_median.total, 3)),
    ("p90", |row| fixed(row.ms_p90.total, 3)),
    ("p99", |row| fixed(row.ms_p99.total, 3)),
    ("max", |row| fixed(row.ms_max.total, 3)),
    ("growth", |row| fixed(row.growth, 2)),
    ("standing", |row| fixed(row.us_standing, 2)),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failures_are_counted_by_kind_and_a_row_without_steps_is_read_back() {
        let mut failures = Vec::new();
        for (kind, place) in [
            ("TipBlocked", "a"),
            ("OpenSection", "b"),
            ("TipBlocked", "c"),
        ] {
            Failure::add(&mut failures, kind, || place.to_owned());
        }
        let row = Row {
            failures,
            growth: f64::NAN,
            ..Row::default()
        };
        assert_eq!(row.failure_count(), 3);
        assert_eq!(
            (row.failures[0].count, row.failures[0].first.as_str()),
            (2, "a")
        );
        let text = serde_json::to_string(&row).unwrap();
        let read: Row = serde_json::from_str(&text).unwrap();
        assert!(read.growth.is_nan());
        assert_eq!(read.failures, row.failures);
    }
}
