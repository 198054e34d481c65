//! Refinement parameters: the paper's five levels, the grading and the limits of a patch.

use crate::error::RefineError;
use incise_params::{Params, Range};
use std::fmt;
use std::str::FromStr;

incise_params::variants! {
    /// The edge length of a patch relative to its rim: the z of the paper's Formula 2.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub enum RefinementLevel = Self::Original;
    names {
        /// "2 times coarser": z = 2.
        Coarser2 = "2x-coarser";
        /// "1.5 times coarser": z = 1.5.
        Coarser1_5 = "1.5x-coarser";
        /// "Original": z = 1.
        Original = "original";
        /// "1.5 times more refine": z = 1 / 1.5.
        Finer1_5 = "1.5x-finer";
        /// "2 times more refine": z = 1 / 2.
        Finer2 = "2x-finer";
    }
    values {
        /// Any z > 0.
        Z(f64) = "z", range: Range::POSITIVE;
    }
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

    /// Returns the factor z.
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
            Self::Z(z) => write!(f, "{z}"),
            named => f.write_str(named.name()),
        }
    }
}

/// The error of parsing a [`RefinementLevel`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "'{0}' is not a refinement level: use 2x-coarser, 1.5x-coarser, original, 1.5x-finer, \
     2x-finer or a number z > 0"
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

incise_params::params! {
    /// Parameters for the refinement of a patch.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct RefineParams {
        /// Edge length relative to the rim's edges.
        level: RefinementLevel = RefinementLevel::Original;
        /// Edge length of the surface at the rim: the t of the paper's Formula 2.
        ///
        /// `None`: the mean edge of the surface at every rim vertex.
        rim_length: Option<f64> = None, range: Range::POSITIVE, unit: "m";
        /// Growth of the target length with the distance from the rim.
        ///
        /// 0: the target at the rim holds everywhere. Above 0, the number of triangles grows with
        /// the rim, not with the area.
        grading: f64 = 0.3, range: Range::NOT_NEGATIVE, unit: "m/m";
        /// Maximum number of triangles of a patch; a patch that needs more is an error.
        max_triangles: usize = 4_000_000;
    }
}

impl RefineParams {
    /// Checks that every number is in its range.
    ///
    /// # Errors
    /// [`RefineError::Parameter`] with the first number that is not.
    pub fn check(&self) -> Result<(), RefineError> {
        Ok(self.check_ranges()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn level_names_round_trip_and_numbers_parse_as_z() {
        for level in RefinementLevel::FIVE {
            assert_eq!(level.to_string().parse(), Ok(level));
        }
        assert_eq!("0.7".parse(), Ok(RefinementLevel::Z(0.7)));
        for bad in ["0", "-1", "nan", "inf", "finer", ""] {
            assert!(bad.parse::<RefinementLevel>().is_err(), "{bad}");
        }
    }
}
