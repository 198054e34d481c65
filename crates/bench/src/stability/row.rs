//! The row of `stability`: the verdict on one invariant of a case.

use super::case::{Case, Worst};
use super::error::StressError;
use crate::numbers::short;
use crate::skip::row::verdict;
use crate::text_table::Column;
use serde::{Deserialize, Serialize};

/// The verdict on one invariant of a case.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Row {
    pub(crate) id: String,
    /// Older files call it `torture`.
    #[serde(alias = "torture")]
    pub(crate) stress: String,
    /// Older files call it `law`.
    #[serde(alias = "law")]
    pub(crate) invariant: String,
    pub(crate) bound: Option<f64>,
    /// The largest value; none when a run failed.
    pub(crate) worst: Option<f64>,
    /// The run of the largest value, or the error.
    pub(crate) at: String,
    pub(crate) runs: u32,
    pub(crate) passed: bool,
    /// The runs beyond the bound and their values, for `--list`.
    #[serde(skip)]
    pub(crate) beyond: Vec<(f64, String)>,
    pub(crate) seconds: f64,
    pub(crate) backend: String,
    pub(crate) device: String,
    pub(crate) commit: String,
    pub(crate) version: String,
}

/// Explains the columns.
pub(super) const LEGEND: &str = "\
runs: number of runs. worst: the largest value of all runs; a case passes when it is at most the \
bound. -: a run ended in an error or in a position that is not finite. The limits of every motion \
hold where no unknown work is done: ten times the speed that all of the energy would give the \
lightest vertex, a stated distance from the origin, a mean strain of 5% after 5 s, 1.01 of the \
energy.";

impl Row {
    /// Judges the result of a case; `backend` and `device` are set later.
    pub(super) fn new(case: &Case, result: Result<Worst, StressError>, seconds: f64) -> Self {
        let mut worst = result.unwrap_or_else(|error| Worst {
            value: f64::INFINITY,
            at: error.to_string(),
            ..Worst::default()
        });
        worst.all.retain(|&(value, _)| value > case.bound);
        worst.all.sort_by(|one, other| other.0.total_cmp(&one.0));
        Self {
            id: case.id.to_owned(),
            stress: case.stress.to_owned(),
            invariant: case.invariant.to_owned(),
            bound: Some(case.bound),
            worst: worst.value.is_finite().then_some(worst.value),
            at: worst.at,
            runs: worst.runs,
            passed: worst.runs > 0 && worst.value <= case.bound,
            beyond: worst.all,
            seconds,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            ..Self::default()
        }
    }

    /// Returns the text beside the columns.
    pub(crate) fn text(&self) -> String {
        let Self { stress, at, .. } = self;
        format!("{stress}\ninvariant: {}\nat: {at}", self.invariant)
    }
}

/// Columns of the printed table and of the report.
pub(crate) const COLUMNS: &[Column<Row>] = &[
    ("case", |row| row.id.clone()),
    ("backend", |row| row.backend.clone()),
    ("verdict", |row| verdict(row.passed)),
    ("runs", |row| row.runs.to_string()),
    ("bound", |row| short(row.bound)),
    ("worst", |row| short(row.worst)),
];

#[cfg(test)]
mod tests {
    use super::*;

    const CASE: Case = Case {
        id: "T0",
        stress: "none",
        invariant: "at most 1",
        bound: 1.0,
        run: |_| Ok(Worst::default()),
    };

    #[test]
    fn a_case_passes_up_to_its_bound_and_not_without_a_run() {
        let row = |value| {
            let mut worst = Worst::default();
            worst.judge(Ok(value), || "here".to_owned());
            Row::new(&CASE, Ok(worst), 0.5)
        };
        assert!(row(1.0).passed && !row(1.001).passed, "around the bound");
        assert!(!row(f64::INFINITY).passed && row(f64::INFINITY).worst.is_none());
        assert!(!Row::new(&CASE, Ok(Worst::default()), 0.0).passed, "no run");
        let failed = Row::new(&CASE, Err(StressError::Invariant("broken".to_owned())), 0.0);
        assert_eq!((failed.passed, failed.at.as_str()), (false, "broken"));
    }
}
