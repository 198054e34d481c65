//! Verdicts as rows of a table and objects of the JSON.

use super::case::{Case, Worst};
use super::failure::Failure;
use serde::Serialize;

/// The verdict on a case.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Row {
    pub(super) id: &'static str,
    pub(super) torture: &'static str,
    pub(super) law: &'static str,
    pub(super) bound: f64,
    /// The worst number found; none when a run ended before it had one.
    pub(super) worst: Option<f64>,
    /// Where the worst number was found, or why there is none.
    pub(super) at: String,
    pub(super) runs: u32,
    pub(super) passed: bool,
    pub(super) seconds: f64,
    pub(super) backend: &'static str,
    pub(super) device: String,
    pub(super) commit: String,
    pub(super) version: &'static str,
}

/// What all rows of a backend have in common.
#[derive(Debug, Clone)]
pub(super) struct Stamp {
    pub(super) backend: &'static str,
    pub(super) device: String,
    pub(super) commit: String,
}

/// The name of what stands beside rows.
pub(super) const TEXTS: &str = "torture, law, and where the worst was found";

/// Explains the columns.
pub(super) const LEGEND: &str = "\
runs: how many were judged. worst: the largest number of the law's kind in all of them; a case passes when it is at \
most the bound. none: a run ended in an error where the law allows none, or in a position that is no number, which is \
worse than any number. The rule for all motions is asked of runs in which nothing outside does unknown work: ten times the \
speed that all of the energy would give the lightest vertex, a stated way from the origin, a mean strain of 5% after 5 s, 1.01 of the energy.";

impl Row {
    pub(super) const NAMES: [&str; 6] = ["case", "backend", "verdict", "runs", "bound", "worst"];

    /// The verdict on what was found.
    pub(super) fn of(
        case: &Case,
        found: Result<Worst, Failure>,
        seconds: f64,
        stamp: &Stamp,
    ) -> Self {
        let worst = found.unwrap_or_else(|failure| Worst {
            value: f64::INFINITY,
            at: failure.to_string(),
            ..Worst::default()
        });
        Self {
            id: case.id,
            torture: case.torture,
            law: case.law,
            bound: case.bound,
            worst: worst.value.is_finite().then_some(worst.value),
            at: worst.at,
            runs: worst.runs,
            passed: worst.runs > 0 && worst.value <= case.bound,
            seconds,
            backend: stamp.backend,
            device: stamp.device.clone(),
            commit: stamp.commit.clone(),
            version: env!("CARGO_PKG_VERSION"),
        }
    }

    /// The row for people.
    pub(super) fn cells(&self) -> [String; 6] {
        [
            self.id.to_owned(),
            self.backend.to_owned(),
            if self.passed { "pass" } else { "FAIL" }.to_owned(),
            self.runs.to_string(),
            number(self.bound),
            self.worst.map_or_else(|| "none".to_owned(), number),
        ]
    }

    /// What stands beside and below it.
    pub(super) fn texts(&self) -> Vec<String> {
        vec![
            self.torture.to_owned(),
            format!("law: {}", self.law),
            format!("at: {}", self.at),
        ]
    }
}

/// Few digits of a number of any size.
fn number(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        size if (1e-3..1e4).contains(&size) => {
            let text = format!("{x:.4}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        _ => format!("{x:.2e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CASE: Case = Case {
        id: "T0",
        torture: "none",
        law: "at most 1",
        bound: 1.0,
        run: |_| Ok(Worst::default()),
    };

    fn row(found: Result<Worst, Failure>) -> Row {
        let stamp = Stamp {
            backend: "cpu",
            device: "D".to_owned(),
            commit: "c".to_owned(),
        };
        Row::of(&CASE, found, 0.5, &stamp)
    }

    fn worst(value: f64) -> Worst {
        Worst {
            value,
            at: "here".to_owned(),
            runs: 2,
            rule: None,
        }
    }

    #[test]
    fn a_case_passes_up_to_its_bound_and_not_without_a_run() {
        assert!(row(Ok(worst(1.0))).passed, "at the bound");
        assert!(!row(Ok(worst(1.001))).passed, "above the bound");
        assert!(!row(Ok(worst(f64::INFINITY))).passed, "no number");
        assert!(!row(Ok(Worst::default())).passed, "nothing was run");
        let failed = row(Err(Failure::Law("broken".to_owned())));
        assert_eq!((failed.passed, failed.at.as_str()), (false, "broken"));
        assert_eq!(failed.cells()[5], "none");
    }

    #[test]
    fn json_has_the_number_the_bound_and_the_verdict() {
        let json = serde_json::to_value(row(Ok(worst(0.25)))).unwrap();
        assert_eq!(json["worst"], 0.25);
        assert_eq!(json["bound"], 1.0);
        assert_eq!(json["passed"], true);
        assert_eq!(json["backend"], "cpu");
        let json = serde_json::to_value(row(Ok(worst(f64::INFINITY)))).unwrap();
        assert!(json["worst"].is_null(), "infinity is no number in JSON");
    }

    #[test]
    fn numbers_are_short() {
        let all = [0.0, 1.01, 1.0, 12.34567, 1e-7, 3e8].map(number);
        assert_eq!(all, ["0", "1.01", "1", "12.3457", "1.00e-7", "3.00e8"]);
    }
}
