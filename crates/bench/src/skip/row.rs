//! Claims as rows of a table and objects of the JSON.

use serde::Serialize;

/// A claim and what was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Finding {
    /// What is left out.
    pub(super) skip: &'static str,
    /// The number that is measured.
    pub(super) claim: &'static str,
    /// On what it was found.
    pub(super) at: String,
    /// The most that it may be.
    pub(super) bound: f64,
    pub(super) measured: f64,
}

/// A finding and where it was made.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Row {
    #[serde(flatten)]
    pub(super) finding: Finding,
    pub(super) passed: bool,
    pub(super) device: String,
    pub(super) commit: String,
    pub(super) version: &'static str,
}

/// The name of what stands beside rows.
pub(super) const TEXTS: &str = "claim, and what it was found on";

/// Explains the columns.
pub(super) const LEGEND: &str = "\
A claim holds when what was measured is at most the bound. Times are taken in turns with what they are compared to, \
and the median of the ratios counts, not the ratio of the medians shown beside it; numbers without a unit are ratios or counts.";

impl Row {
    pub(super) const NAMES: [&str; 4] = ["skip", "verdict", "bound", "measured"];

    pub(super) fn of(finding: Finding, device: &str, commit: &str) -> Self {
        Self {
            passed: finding.measured <= finding.bound,
            finding,
            device: device.to_owned(),
            commit: commit.to_owned(),
            version: env!("CARGO_PKG_VERSION"),
        }
    }

    /// The row for people.
    pub(super) fn cells(&self) -> [String; 4] {
        let finding = &self.finding;
        [
            finding.skip.to_owned(),
            if self.passed { "pass" } else { "FAIL" }.to_owned(),
            number(finding.bound),
            number(finding.measured),
        ]
    }

    /// What stands beside and below it.
    pub(super) fn texts(&self) -> Vec<String> {
        let finding = &self.finding;
        vec![finding.claim.to_owned(), format!("at: {}", finding.at)]
    }
}

/// Few digits.
fn number(x: f64) -> String {
    let text = format!("{x:.5}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(measured: f64) -> Row {
        let finding = Finding {
            skip: "nothing",
            claim: "ratio",
            at: "here".to_owned(),
            bound: 0.01,
            measured,
        };
        Row::of(finding, "D", "c")
    }

    #[test]
    fn a_claim_holds_up_to_its_bound() {
        assert!(row(0.01).passed, "at the bound");
        assert!(!row(0.011).passed, "above it");
        assert!(!row(f64::NAN).passed, "no number is no proof");
    }

    #[test]
    fn rows_say_the_same_to_people_and_programs() {
        let row = row(0.0123);
        assert_eq!(row.cells()[1..], ["FAIL", "0.01", "0.0123"]);
        assert_eq!(row.texts(), ["ratio", "at: here"]);
        let json = serde_json::to_value(row).unwrap();
        assert_eq!(json["measured"], 0.0123);
        assert_eq!(json["passed"], false);
        assert_eq!(json["device"], "D");
    }
}
