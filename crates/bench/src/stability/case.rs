//! Stress cases: what is done to a body, the invariant that must hold, and the worst value found.

use super::error::StressError;
use super::runner::Runner;

/// A stress test with one invariant. It passes when no value exceeds the bound.
#[derive(Debug, Clone, Copy)]
pub(super) struct Case {
    /// Name in results: T1 to T20, or a word.
    pub(super) id: &'static str,
    /// The treatment of the body.
    pub(super) stress: &'static str,
    /// The measured quantity that must not exceed the bound.
    pub(super) invariant: &'static str,
    /// The largest value that passes.
    pub(super) bound: f64,
    pub(super) run: fn(&mut Runner) -> Result<Worst, StressError>,
}

/// Returns the larger of two numbers; unlike `f64::max`, NaN is larger than any.
pub(super) fn larger(one: f64, other: f64) -> f64 {
    if other > one || other.is_nan() {
        other
    } else {
        one
    }
}

/// The result of one run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Outcome {
    /// The value that the case compares with its bound.
    pub(super) value: f64,
    /// The largest share of the limits of every motion, where they were checked.
    pub(super) share: Option<LimitShare>,
}

/// A quantity relative to its limit for every motion, see [`super::energy::Limits`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LimitShare {
    /// The quantity over its limit.
    pub(super) part: f64,
    /// The name of the quantity.
    pub(super) of: &'static str,
}

impl From<f64> for Outcome {
    fn from(value: f64) -> Self {
        Self { value, share: None }
    }
}

impl Outcome {
    /// Returns the same run with another value.
    pub(super) fn by(self, value: f64) -> Self {
        Self { value, ..self }
    }

    /// Returns the same run with a share of a limit added.
    pub(super) fn with(self, share: LimitShare) -> Self {
        let share = Some(self.share.map_or(share, |known| known.worse(share)));
        Self { share, ..self }
    }
}

impl LimitShare {
    /// Returns the larger share; NaN is larger than any.
    pub(super) fn worse(self, other: Self) -> Self {
        if other.part > self.part || other.part.is_nan() {
            other
        } else {
            self
        }
    }
}

/// The largest value of a case, and where it was found.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Worst {
    /// Negative infinity before the first run.
    pub(super) value: f64,
    pub(super) at: String,
    /// Number of runs or edits.
    pub(super) runs: u32,
    /// Every run and its value, in their order.
    pub(super) all: Vec<(f64, String)>,
    /// The largest share of the limits of every motion, in the runs that check them.
    pub(super) limits: Option<Box<Self>>,
}

impl Default for Worst {
    fn default() -> Self {
        Self {
            value: f64::NEG_INFINITY,
            at: String::new(),
            runs: 0,
            all: Vec::new(),
            limits: None,
        }
    }
}

impl Worst {
    /// Records a value; NaN counts as infinite.
    pub(super) fn take(&mut self, value: f64, at: impl Fn() -> String) {
        let value = if value.is_nan() { f64::INFINITY } else { value };
        let at = at();
        if value > self.value {
            self.value = value;
            self.at.clone_from(&at);
        }
        self.all.push((value, at));
    }

    /// Counts a run and records its value; a failed run counts as infinite.
    pub(super) fn judge(
        &mut self,
        found: Result<impl Into<Outcome>, StressError>,
        at: impl Fn() -> String,
    ) {
        self.runs += 1;
        match found.map(Into::into) {
            Ok(Outcome { value, share }) => {
                self.take(value, &at);
                if let Some(LimitShare { part, of }) = share {
                    let limits = self.limits.get_or_insert_default();
                    limits.runs += 1;
                    limits.take(part, || format!("{}: {of}", at()));
                }
            }
            Err(error) => self.take(f64::INFINITY, || format!("{}: {error}", at())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_is_the_largest_value_and_nan_is_worse() {
        let mut worst = Worst::default();
        worst.judge(Ok(1.0), || "a".to_owned());
        worst.judge(Ok(3.0), || "b".to_owned());
        worst.judge(Ok(2.0), || "c".to_owned());
        assert_eq!((worst.value, worst.at.as_str(), worst.runs), (3.0, "b", 3));
        worst.judge(Ok(f64::NAN), || "d".to_owned());
        assert_eq!((worst.value, worst.at.as_str()), (f64::INFINITY, "d"));
        let mut worst = Worst::default();
        let broken: Result<f64, _> = Err(StressError::Invariant("broken".to_owned()));
        worst.judge(broken, || "e".to_owned());
        assert_eq!(
            (worst.value, worst.at.as_str()),
            (f64::INFINITY, "e: broken")
        );
    }

    #[test]
    fn limits_of_every_motion_are_recorded_beside() {
        let mut worst = Worst::default();
        let kept = |part| {
            let of = "way";
            Outcome::from(2.0).by(1.0).with(LimitShare { part, of })
        };
        worst.judge(Ok(kept(0.5)), || "a".to_owned());
        worst.judge(Ok(kept(f64::NAN)), || "b".to_owned());
        worst.judge(Ok(3.0), || "c".to_owned());
        let limits = worst.limits.unwrap();
        assert_eq!((worst.value, worst.runs), (3.0, 3));
        assert_eq!(
            (limits.value, limits.at.as_str(), limits.runs),
            (f64::INFINITY, "b: way", 2)
        );
    }
}
