//! The row of `skip`: a claim, its bound and the measured value.

use crate::numbers::short;
use crate::text_table::Column;
use serde::{Deserialize, Serialize};

/// A claim and its verdict. Numbers are none where JSON has `null`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Row {
    /// The measured feature.
    pub(crate) skip: String,
    /// The measured quantity.
    pub(crate) claim: String,
    /// The measured body and both times.
    pub(crate) at: String,
    /// Largest value that passes.
    pub(crate) bound: Option<f64>,
    pub(crate) measured: Option<f64>,
    pub(crate) passed: bool,
    pub(crate) device: String,
    pub(crate) commit: String,
    pub(crate) version: String,
}

/// Explains the columns.
pub(super) const LEGEND: &str = "\
A claim holds when the measured value is at most the bound. Two frames are timed in turns; the \
median of their ratios counts, not the ratio of the medians shown.";

/// Columns of the printed table and of the report.
pub(crate) const COLUMNS: &[Column<Row>] = &[
    ("feature", |row| row.skip.clone()),
    ("verdict", |row| verdict(row.passed)),
    ("bound", |row| short(row.bound)),
    ("measured", |row| short(row.measured)),
];

/// Formats whether a bound holds.
pub(crate) fn verdict(passed: bool) -> String {
    if passed { "pass" } else { "FAIL" }.to_owned()
}

impl Row {
    /// Returns the text beside the columns.
    pub(crate) fn text(&self) -> String {
        format!("{}\nat: {}", self.claim, self.at)
    }
}
