//! Numbers on the command line, in scene files and in reports.

use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer};
use std::fmt;
use std::num::NonZeroU16;
use std::str::FromStr;

/// N numbers, separated by commas on the command line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Numbers<const N: usize>(pub(crate) [f64; N]);

impl<'de, const N: usize> Deserialize<'de> for Numbers<N> {
    /// Reads an array of N finite numbers.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let values = Vec::<f64>::deserialize(deserializer)?;
        let found = values.len();
        let values = <[f64; N]>::try_from(values)
            .map_err(|_| D::Error::custom(format!("{found} numbers, expected {N}")))?;
        match values.iter().find(|value| !value.is_finite()) {
            Some(value) => Err(D::Error::custom(format!("{value} is not finite"))),
            None => Ok(Self(values)),
        }
    }
}

/// Reads a finite number.
pub(crate) fn finite_number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let value = f64::deserialize(deserializer)?;
    if value.is_finite() {
        Ok(value)
    } else {
        Err(D::Error::custom(format!("{value} is not finite")))
    }
}

/// Reads a positive number, or a fraction of two as text; see [`positive`].
pub(crate) fn positive_number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    struct Positive;
    impl Visitor<'_> for Positive {
        type Value = f64;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a positive number, or a fraction such as \"1/60\"")
        }

        fn visit_f64<E: Error>(self, value: f64) -> Result<f64, E> {
            self.visit_str(&value.to_string())
        }

        fn visit_i64<E: Error>(self, value: i64) -> Result<f64, E> {
            self.visit_str(&value.to_string())
        }

        fn visit_str<E: Error>(self, text: &str) -> Result<f64, E> {
            positive(text).map_err(E::custom)
        }
    }
    deserializer.deserialize_any(Positive)
}

/// Parses N finite numbers between commas; an error names the first bad one.
pub(crate) fn numbers<const N: usize>(text: &str) -> Result<Numbers<N>, String> {
    let mut values = Vec::with_capacity(N);
    for (i, part) in text.split(',').map(str::trim).enumerate() {
        let fault = match part.parse::<f64>() {
            Ok(value) if value.is_finite() => {
                values.push(value);
                continue;
            }
            Ok(_) => "is not finite",
            Err(_) => "is not a number",
        };
        return Err(format!(
            "number {}, '{part}', {fault}: expected {N} finite numbers, separated by commas",
            i + 1
        ));
    }
    let found = values.len();
    (values.try_into().map(Numbers)).map_err(|_| {
        format!("found {found} numbers: expected {N} finite numbers, separated by commas")
    })
}

/// Parses a positive number, or a fraction of two.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    let value = number_or_fraction(text).filter(|&value| value > 0.0);
    value.ok_or_else(|| format!("'{text}' is not a positive number or fraction"))
}

/// Parses 0 or a positive number, or a fraction of two.
pub(crate) fn not_negative(text: &str) -> Result<f64, String> {
    let value = number_or_fraction(text).filter(|&value| value >= 0.0);
    value.ok_or_else(|| format!("'{text}' is not 0, a positive number or a fraction"))
}

fn number_or_fraction(text: &str) -> Option<f64> {
    let number = |s: &str| s.trim().parse::<f64>().ok();
    let value = match text.split_once('/') {
        Some((above, below)) => number(above)? / number(below)?,
        None => number(text)?,
    };
    Some(value).filter(|value| value.is_finite())
}

/// Parses a whole number of at least 1, of 16 bits.
pub(crate) fn small_count(text: &str) -> Result<NonZeroU16, String> {
    positive_whole(text, u16::MAX)
}

fn positive_whole<T: FromStr, M: fmt::Display>(text: &str, max: M) -> Result<T, String> {
    let value = text.trim().parse();
    value.map_err(|_| format!("'{text}' is not a whole number from 1 to {max}"))
}

/// Returns a count and its noun, in the plural unless there is one: `1 piece`, `2 pieces`.
pub(crate) fn counted(count: usize, noun: &str) -> String {
    match (count, noun) {
        (1, _) => format!("1 {noun}"),
        (_, "vertex") => format!("{count} vertices"),
        _ => format!("{count} {noun}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_singular() {
        assert_eq!(counted(1, "piece"), "1 piece");
        assert_eq!(counted(0, "cap triangle"), "0 cap triangles");
        assert_eq!(counted(2, "vertex"), "2 vertices");
    }

    #[test]
    fn positive_accepts_fractions() {
        assert_eq!(positive("1/60"), Ok(1.0 / 60.0));
        for bad in ["0", "-1", "1/0", "a", "1/2/3", "nan"] {
            assert!(positive(bad).is_err(), "{bad}");
        }
        assert_eq!(not_negative("0"), Ok(0.0));
        assert!(not_negative("-1/60").is_err());
    }

    #[test]
    fn numbers_need_the_exact_count() {
        assert_eq!(numbers::<3>("1, -2,3e1").unwrap().0, [1.0, -2.0, 30.0]);
        for (bad, message) in [
            ("1,2", "found 2 numbers"),
            ("1,2,3,4", "found 4 numbers"),
            ("1,2,inf", "number 3, 'inf', is not finite"),
            ("nan,2,inf", "number 1, 'nan', is not finite"),
            ("1,x,3", "number 2, 'x', is not a number"),
            ("", "number 1, '', is not a number"),
        ] {
            let error = numbers::<3>(bad).unwrap_err();
            assert!(error.starts_with(message), "{bad}: {error}");
            assert!(error.contains("expected 3 finite numbers"), "{error}");
        }
    }
}
