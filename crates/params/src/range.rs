//! [`Range`]: the numbers that a parameter may have.

use std::fmt;

/// An interval of finite numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Lower bound.
    pub min: f64,
    /// Upper bound.
    pub max: f64,
    /// Whether the lower bound is not in the range.
    pub above_min: bool,
    /// Whether the upper bound is not in the range.
    pub below_max: bool,
}

impl Range {
    /// All finite numbers.
    pub const FINITE: Self = Self {
        min: f64::NEG_INFINITY,
        max: f64::INFINITY,
        above_min: true,
        below_max: true,
    };

    /// Finite numbers from 0.
    pub const NOT_NEGATIVE: Self = Self {
        min: 0.0,
        above_min: false,
        ..Self::FINITE
    };

    /// Finite numbers above 0.
    pub const POSITIVE: Self = Self {
        min: 0.0,
        ..Self::FINITE
    };

    /// Numbers from 0 to 1.
    pub const FRACTION: Self = Self::NOT_NEGATIVE.up_to(1.0);

    /// Finite numbers from `min`.
    #[must_use]
    pub const fn at_least(min: f64) -> Self {
        Self {
            min,
            above_min: false,
            ..Self::FINITE
        }
    }

    /// Ends the range at `max`, which is in it.
    #[must_use]
    pub const fn up_to(self, max: f64) -> Self {
        Self {
            max,
            below_max: false,
            ..self
        }
    }

    /// Ends the range below `max`.
    #[must_use]
    pub const fn below(self, max: f64) -> Self {
        Self {
            max,
            below_max: true,
            ..self
        }
    }

    /// Returns whether a number is in the range; NaN is in none.
    #[must_use]
    pub fn contains(&self, x: f64) -> bool {
        let from_min = if self.above_min {
            x > self.min
        } else {
            x >= self.min
        };
        from_min
            && if self.below_max {
                x < self.max
            } else {
                x <= self.max
            }
    }
}

impl fmt::Display for Range {
    /// Writes the range as in "it must be ...".
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { min, max, .. } = *self;
        let from = if self.above_min { "above" } else { "at least" };
        let to = if self.below_max { "below" } else { "at most" };
        match (min.is_finite(), max.is_finite()) {
            (false, false) => f.write_str("a finite number"),
            (true, false) => {
                let of = if self.above_min { "" } else { "of " };
                write!(f, "a finite number {of}{from} {min}")
            }
            (false, true) => {
                let of = if self.below_max { "" } else { "of " };
                write!(f, "a finite number {of}{to} {max}")
            }
            (true, true) if self.above_min || self.below_max => {
                write!(f, "{from} {min} and {to} {max}")
            }
            (true, true) => write!(f, "from {min} to {max}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_belong_to_a_range_as_its_text_says() {
        for (range, text, inside, outside) in [
            (Range::FINITE, "a finite number", -1e300, f64::INFINITY),
            (
                Range::NOT_NEGATIVE,
                "a finite number of at least 0",
                0.0,
                -1e-300,
            ),
            (Range::POSITIVE, "a finite number above 0", 1e-300, 0.0),
            (Range::FRACTION, "from 0 to 1", 1.0, 1.1),
            (
                Range::NOT_NEGATIVE.below(0.5),
                "at least 0 and below 0.5",
                0.0,
                0.5,
            ),
            (
                Range::POSITIVE.up_to(100.0),
                "above 0 and at most 100",
                100.0,
                0.0,
            ),
            (
                Range::at_least(1.0),
                "a finite number of at least 1",
                1.0,
                0.0,
            ),
        ] {
            assert_eq!(range.to_string(), text);
            assert!(range.contains(inside), "{inside} is {text}");
            assert!(!range.contains(outside), "{outside} is not {text}");
            assert!(!range.contains(f64::NAN), "NaN is not {text}");
        }
    }
}
