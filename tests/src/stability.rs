//! Stress cases: what is done to bodies, the invariants that must hold, and the worst values found.
//!
//! `incise-bench stability` prints and writes their verdicts. `tests/invariants/stability.rs`
//! asserts them.

mod contacts;
mod cuts;
mod drop;
mod group;
mod heaps;
mod loads;
mod motions;
mod primitives;
mod runner;
mod solids;
mod still;
mod volumes;

use incise_test_support::energy::{LimitShare, MAX_ENERGY};
pub use runner::{Runner, Subject, side_by_side};
use std::error::Error;

/// An error that ends a run; where the invariant allows none, the case fails.
pub type StressError = Box<dyn Error + Send + Sync>;

/// The result of a part of a run.
type Found<T> = Result<T, StressError>;

/// A stress test with invariants. An invariant holds when no value exceeds its bound.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Name in results: T1 to T20, or a word. Several cases may share one.
    pub id: &'static str,
    /// The treatment of the bodies.
    pub stress: &'static str,
    /// The measured quantities, and the largest value of each that passes.
    pub invariants: &'static [(&'static str, f64)],
    /// Makes all runs.
    pub run: fn(&Runner) -> Vec<Run>,
}

/// One run of a case.
#[derive(Debug)]
pub struct Run {
    /// The parameters of the run.
    pub at: String,
    /// The measurement, or the error that ended the run.
    pub found: Result<Outcome, StressError>,
}

impl Run {
    fn new(at: String, found: Found<impl Into<Outcome>>) -> Self {
        let found = found.map(Into::into);
        Self { at, found }
    }
}

/// The quantities measured in a run.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// A value for each invariant of the case; `None` where one does not apply.
    pub values: Vec<Option<f64>>,
    /// The largest share of the limits of every motion, where they were checked.
    pub limits: Option<LimitShare>,
}

impl<const N: usize> From<[f64; N]> for Outcome {
    fn from(values: [f64; N]) -> Self {
        values.map(Some).to_vec().into()
    }
}

impl From<Vec<Option<f64>>> for Outcome {
    fn from(values: Vec<Option<f64>>) -> Self {
        let limits = None;
        Self { values, limits }
    }
}

impl Outcome {
    /// Returns the same run with another value.
    fn by(self, value: f64) -> Self {
        let values = vec![Some(value)];
        Self { values, ..self }
    }

    /// Returns the same run with another value; the present one, an energy, becomes a limit.
    fn within_energy(self, value: f64) -> Self {
        let part = self.values[0].unwrap_or(f64::NAN) / MAX_ENERGY;
        let of = "energy";
        let share = LimitShare { part, of };
        let limits = Some(self.limits.map_or(share, |known| known.worse(share)));
        Self { limits, ..self }.by(value)
    }
}

/// The verdict on one invariant of a case.
#[derive(Debug, Clone)]
pub struct Verdict {
    /// The case.
    pub case: Case,
    /// The measured quantity.
    pub invariant: &'static str,
    /// The largest value that passes.
    pub bound: f64,
    /// The largest value; infinite when a run failed, negative infinity without runs.
    pub worst: f64,
    /// The run of the largest value, with its error if it failed.
    pub at: String,
    /// Number of runs with a value.
    pub runs: usize,
    /// Every run and its value, the worst first.
    pub all: Vec<(f64, String)>,
}

/// The invariant that every motion has on which no unknown work is done.
const LIMITS: &str =
    "limits of every motion: the largest share of speed, distance, strain or energy";

impl Verdict {
    fn new(
        case: &Case,
        invariant: &'static str,
        bound: f64,
        values: impl Iterator<Item = (f64, String)>,
    ) -> Self {
        let (mut worst, mut at, mut runs) = (f64::NEG_INFINITY, String::new(), 0);
        let mut all = Vec::new();
        for (value, here) in values {
            runs += 1;
            let value = if value.is_nan() { f64::INFINITY } else { value };
            if value > worst {
                (worst, at) = (value, here.clone());
            }
            all.push((value, here));
        }
        all.sort_by(|one, other| other.0.total_cmp(&one.0));
        Self {
            case: *case,
            invariant,
            bound,
            worst,
            at,
            runs,
            all,
        }
    }

    /// Returns whether the invariant holds.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.runs > 0 && self.worst <= self.bound
    }
}

impl Case {
    /// Makes all runs and judges each invariant, then the limits of every motion.
    #[must_use]
    pub fn verdicts(&self, runner: &Runner) -> Vec<Verdict> {
        let runs = (self.run)(runner);
        let of = |(k, &(invariant, bound)): (usize, &(&'static str, f64))| {
            let values = runs.iter().filter_map(|Run { at, found }| match found {
                Ok(outcome) => outcome.values[k].map(|value| (value, at.clone())),
                Err(error) => Some((f64::INFINITY, format!("{at}: {error}"))),
            });
            Verdict::new(self, invariant, bound, values)
        };
        let mut verdicts: Vec<Verdict> = self.invariants.iter().enumerate().map(of).collect();
        let shares = runs.iter().filter_map(|Run { at, found }| {
            let LimitShare { part, of } = found.as_ref().ok()?.limits?;
            Some((part, format!("{at}: {of}")))
        });
        let limits = Verdict::new(self, LIMITS, 1.0, shares);
        verdicts.extend((limits.runs > 0).then_some(limits));
        verdicts
    }
}

/// Returns all cases in the order of the table.
pub fn cases() -> impl Iterator<Item = &'static Case> {
    let parts: [&[Case]; 9] = [
        &still::CASES,
        &motions::CASES,
        &loads::CASES,
        &volumes::CASES,
        &contacts::CASES,
        &cuts::CASES,
        &heaps::CASES,
        &solids::CASES,
        &drop::CASES,
    ];
    parts.into_iter().flatten()
}

/// Returns the larger of two numbers; unlike `f64::max`, NaN is larger than any.
fn larger(one: f64, other: f64) -> f64 {
    if other > one || other.is_nan() {
        other
    } else {
        one
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CASE: Case = Case {
        id: "T0",
        stress: "none",
        invariants: &[("at most 1", 1.0), ("at most 2", 2.0)],
        run: |runner| {
            runner.each(&[0.5, 3.0, f64::NAN], |&value| {
                let share = LimitShare {
                    part: value,
                    of: "way",
                };
                let found = Outcome {
                    values: vec![Some(1.0), (value < 1.0).then_some(value)],
                    limits: (value > 1.0).then_some(share),
                };
                Run::new(format!("{value}"), Ok(found))
            })
        },
    };

    #[test]
    fn a_verdict_is_that_of_the_worst_run() {
        let runner = Runner::cpu();
        let [first, second, limits] = CASE.verdicts(&runner).try_into().unwrap();
        assert!(first.passed() && first.runs == 3, "{first:?}");
        assert!(second.passed() && second.runs == 1, "{second:?}");
        assert!(!limits.passed() && limits.runs == 1, "{limits:?}");
        assert_eq!((limits.worst, limits.at.as_str()), (3.0, "3: way"));
        let verdict = |found| {
            let run: Vec<Found<f64>> = found;
            let values = run
                .into_iter()
                .map(|found| (found.unwrap_or(f64::NAN), String::new()));
            let (invariant, bound) = CASE.invariants[0];
            Verdict::new(&CASE, invariant, bound, values)
        };
        assert!(!verdict(vec![]).passed(), "no run");
        assert!(verdict(vec![Ok(1.0)]).passed(), "at the bound");
        assert!(!verdict(vec![Ok(1.001)]).passed(), "beyond it");
        assert!(!verdict(vec![Ok(0.0), Ok(f64::NAN)]).passed(), "NaN");
    }
}
