//! How fine a patch gets: the paper's five levels, or any factor.

use std::fmt;
use std::str::FromStr;

/// How long a patch's edges get, as a multiple of the mean edge of its rim: the z of the paper's
/// Formula 2.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum RefinementLevel {
    /// "2 times coarser": z = 2.
    Coarser2,
    /// "1.5 times coarser": z = 1.5.
    Coarser1_5,
    /// "Original": z = 1.
    #[default]
    Original,
    /// "1.5 times more refine": z = 1 / 1.5.
    Finer1_5,
    /// "2 times more refine": z = 1 / 2.
    Finer2,
    /// Any z > 0.
    Z(f64),
}

impl RefinementLevel {
    /// The paper's five levels, from coarse to fine.
    pub const FIVE: [Self; 5] = [
        Self::Coarser2,
        Self::Coarser1_5,
        Self::Original,
        Self::Finer1_5,
        Self::Finer2,
    ];

    /// The factor z.
    #[must_use]
    pub const fn z(self) -> f64 {
        match self {
            Self::Coarser2 => 2.0,
            Self::Coarser1_5 => 1.5,
            Self::Original => 1.0,
            Self::Finer1_5 => 1.0 / 1.5,
            Self::Finer2 => 0.5,
            Self::Z(z) => z,
        }
    }
}

impl fmt::Display for RefinementLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Coarser2 => f.write_str("2x-coarser"),
            Self::Coarser1_5 => f.write_str("1.5x-coarser"),
            Self::Original => f.write_str("original"),
            Self::Finer1_5 => f.write_str("1.5x-finer"),
            Self::Finer2 => f.write_str("2x-finer"),
            Self::Z(z) => write!(f, "{z}"),
        }
    }
}

/// A text that names no refinement level.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "'{0}' is no refinement level: use 2x-coarser, 1.5x-coarser, original, 1.5x-finer, 2x-finer or a number z > 0"
)]
pub struct ParseLevelError(String);

impl FromStr for RefinementLevel {
    type Err = ParseLevelError;

    fn from_str(text: &str) -> Result<Self, ParseLevelError> {
        if let Some(level) = Self::FIVE.into_iter().find(|l| l.to_string() == text) {
            return Ok(level);
        }
        match text.parse::<f64>() {
            Ok(z) if z > 0.0 && z.is_finite() => Ok(Self::Z(z)),
            _ => Err(ParseLevelError(text.to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_back_and_numbers_are_z() {
        for level in RefinementLevel::FIVE {
            assert_eq!(level.to_string().parse(), Ok(level));
        }
        assert_eq!("0.7".parse(), Ok(RefinementLevel::Z(0.7)));
        for bad in ["0", "-1", "nan", "inf", "finer", ""] {
            assert!(bad.parse::<RefinementLevel>().is_err(), "{bad}");
        }
    }
}
