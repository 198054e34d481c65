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

/// The larger of two numbers. What is no number is larger than any: `f64::max` would forget it.
pub(super) fn larger(one: f64, other: f64) -> f64 {
    if other > one || other.is_nan() {
        other
    } else {
        one
    }
}

/// What a run came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Found {
    /// The number that the case judges.
    pub(super) value: f64,
    /// How near the run came to breaking what every motion has to keep, where that was looked at.
    pub(super) kept: Option<Kept>,
}

/// A part of the rule for every motion, see [`super::audit::Rule`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Kept {
    /// The number, of what it may be.
    pub(super) part: f64,
    /// What number it is.
    pub(super) of: &'static str,
}

impl From<f64> for Found {
    fn from(value: f64) -> Self {
        Self { value, kept: None }
    }
}

impl Found {
    /// The same run, judged by another number.
    pub(super) fn by(self, value: f64) -> Self {
        Self { value, ..self }
    }

    /// Two runs as one.
    pub(super) fn worse(self, other: Self) -> Self {
        let value = larger(self.value, other.value);
        let all = Self { value, ..self };
        other.kept.map_or(all, |kept| all.with(kept))
    }

    /// The same run, in which so much of the rule was kept.
    pub(super) fn with(self, kept: Kept) -> Self {
        let kept = Some(self.kept.map_or(kept, |known| known.worse(kept)));
        Self { kept, ..self }
    }
}

impl Kept {
    /// The one that is nearer to being broken. What is no number is broken.
    pub(super) fn worse(self, other: Self) -> Self {
        if other.part > self.part || other.part.is_nan() {
            other
        } else {
            self
        }
    }
}

/// The largest number of a case, and where it was found.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Worst {
    /// Negative infinity as long as nothing was found.
    pub(super) value: f64,
    pub(super) at: String,
    /// How many runs or edits were judged.
    pub(super) runs: u32,
    /// The same of the rule for every motion, of the runs in which it was looked at.
    pub(super) rule: Option<Box<Self>>,
}

impl Default for Worst {
    fn default() -> Self {
        Self {
            value: f64::NEG_INFINITY,
            at: String::new(),
            runs: 0,
            rule: None,
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
    pub(super) fn judge(
        &mut self,
        found: Result<impl Into<Found>, Failure>,
        at: impl Fn() -> String,
    ) {
        self.runs += 1;
        match found.map(Into::into) {
            Ok(Found { value, kept }) => {
                self.take(value, &at);
                if let Some(Kept { part, of }) = kept {
                    let rule = self.rule.get_or_insert_default();
                    rule.runs += 1;
                    rule.take(part, || format!("{}: {of}", at()));
                }
            }
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
        let broken: Result<f64, _> = Err(Failure::Law("broken".to_owned()));
        worst.judge(broken, || "e".to_owned());
        assert_eq!(
            (worst.value, worst.at.as_str()),
            (f64::INFINITY, "e: broken")
        );
    }

    #[test]
    fn the_rule_for_every_motion_is_judged_beside() {
        let mut worst = Worst::default();
        let kept = |part| {
            let of = "way";
            Found::from(2.0).by(1.0).with(Kept { part, of })
        };
        worst.judge(Ok(kept(0.5)), || "a".to_owned());
        worst.judge(Ok(kept(f64::NAN)), || "b".to_owned());
        worst.judge(Ok(3.0), || "c".to_owned());
        let rule = worst.rule.unwrap();
        assert_eq!((worst.value, worst.runs), (3.0, 3));
        assert_eq!(
            (rule.value, rule.at.as_str(), rule.runs),
            (f64::INFINITY, "b: way", 2)
        );
    }
}
