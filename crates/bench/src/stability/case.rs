//! What a case is: a torture, the law that must hold under it, and the worst that was found.

use super::failure::Failure;
use super::stage::Stage;
use incise_pbd_gpu::Stiffness;

/// One torture and one law. It passes when nothing found is above the bound.
#[derive(Debug, Clone, Copy)]
pub(super) struct Case {
    /// The torture's number, T1 to T20, or a name for those beside them.
    pub(super) id: &'static str,
    /// What is done to the body.
    pub(super) torture: &'static str,
    /// What must hold: what the numbers are and what they must not exceed.
    pub(super) law: &'static str,
    /// The largest number with which it holds.
    pub(super) bound: f64,
    pub(super) run: fn(&mut Stage) -> Result<Worst, Failure>,
}

/// The largest number of a case, and where it was found.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Worst {
    /// Negative infinity as long as nothing was found.
    pub(super) value: f64,
    pub(super) at: String,
    /// How many runs or edits were judged.
    pub(super) runs: u32,
}

impl Default for Worst {
    fn default() -> Self {
        Self {
            value: f64::NEG_INFINITY,
            at: String::new(),
            runs: 0,
        }
    }
}

impl Worst {
    /// Takes a number up. What is no number is worse than any.
    pub(super) fn take(&mut self, value: f64, at: impl Fn() -> String) {
        let value = if value.is_nan() { f64::INFINITY } else { value };
        if value > self.value {
            self.value = value;
            self.at = at();
        }
    }

    /// Counts a run and takes its number up. A run that failed is worse than any number.
    pub(super) fn judge(&mut self, found: Result<f64, Failure>, at: impl Fn() -> String) {
        self.runs += 1;
        match found {
            Ok(value) => self.take(value, &at),
            Err(failure) => self.take(f64::INFINITY, || format!("{}: {failure}", at())),
        }
    }
}

/// A stiffness as a place is told by it.
pub(super) fn told(stiffness: Stiffness) -> String {
    match stiffness {
        Stiffness::Pbd(k) => format!("stiffness {k}"),
        Stiffness::Compliance(value) => format!("compliance {value:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_is_the_largest_and_no_number_is_worse() {
        let mut worst = Worst::default();
        worst.judge(Ok(1.0), || "a".to_owned());
        worst.judge(Ok(3.0), || "b".to_owned());
        worst.judge(Ok(2.0), || "c".to_owned());
        assert_eq!((worst.value, worst.at.as_str(), worst.runs), (3.0, "b", 3));
        worst.judge(Ok(f64::NAN), || "d".to_owned());
        assert_eq!((worst.value, worst.at.as_str()), (f64::INFINITY, "d"));
        let mut worst = Worst::default();
        worst.judge(Err(Failure::Law("broken".to_owned())), || "e".to_owned());
        assert_eq!(
            (worst.value, worst.at.as_str()),
            (f64::INFINITY, "e: broken")
        );
    }
}
