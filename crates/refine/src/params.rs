//! Refinement parameters: the paper's five levels, the method and the limits of a patch.

use crate::error::RefineError;
use std::fmt;
use std::str::FromStr;

/// The edge length of a patch relative to its rim: the z of the paper's Formula 2.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
            Self::Coarser2 => f.write_str("2x-coarser"),
            Self::Coarser1_5 => f.write_str("1.5x-coarser"),
            Self::Original => f.write_str("original"),
            Self::Finer1_5 => f.write_str("1.5x-finer"),
            Self::Finer2 => f.write_str("2x-finer"),
            Self::Z(z) => write!(f, "{z}"),
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

/// The algorithm that triangulates and refines a section.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RefineMethod {
    /// A core of equilateral triangles with a Delaunay band around it.
    ///
    /// Where target lengths differ too much for one core, frontal Delaunay refinement.
    #[default]
    Delaunay,
    /// The paper's method: ear clipping (Algorithm A2), then subdivision and edge swaps.
    ///
    /// Algorithms 4 and A3 run until mean edges reach the mean of the targets along the rim. The
    /// paper has no nested loops; they start from a constrained Delaunay triangulation.
    Paper,
}

/// Parameters for the refinement of a patch.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RefineParams {
    /// The algorithm for caps of the exact cutting method. [`crate::paper::fill`] ignores it.
    pub method: RefineMethod,
    /// Edge length relative to the rim's edges.
    pub level: RefinementLevel,
    /// The t of Formula 2 for the whole patch \[m\].
    ///
    /// `None`: the exact method uses the mean edge of the surface at every rim vertex, the paper's
    /// method the mean edge of the rim.
    pub rim_length: Option<f64>,
    /// Growth of the target length with the distance from the rim \[m/m\].
    ///
    /// Only for the exact method with [`RefineMethod::Delaunay`]. 0: the target at the rim holds
    /// everywhere. Above 0, the number of triangles grows with the rim, not with the area. The
    /// default is 0.3, see `docs/log/2026-11.md`.
    pub grading: f64,
    /// Maximum rounds of subdivision and edge swaps: n of Algorithm 4.
    ///
    /// A round divides edge lengths by about the root of 3. Refinement ends earlier when no
    /// triangle is too large.
    pub max_rounds: u32,
    /// Maximum number of triangles of a patch; a patch that needs more is an error.
    pub max_triangles: usize,
}

impl Default for RefineParams {
    fn default() -> Self {
        Self {
            method: RefineMethod::default(),
            level: RefinementLevel::Original,
            rim_length: None,
            grading: 0.3,
            max_rounds: 24,
            max_triangles: 4_000_000,
        }
    }
}

impl RefineParams {
    /// Checks that level and rim length are positive numbers and the grading is not negative.
    ///
    /// # Errors
    /// [`RefineError::NonPositiveLevel`], [`RefineError::NonPositiveLength`] and
    /// [`RefineError::NegativeGrading`].
    pub fn check(&self) -> Result<(), RefineError> {
        let z = self.level.z();
        if !(z > 0.0 && z.is_finite()) {
            return Err(RefineError::NonPositiveLevel { z });
        }
        let grading = self.grading;
        if !(grading >= 0.0 && grading.is_finite()) {
            return Err(RefineError::NegativeGrading { grading });
        }
        match self.rim_length {
            Some(length) if !(length > 0.0 && length.is_finite()) => {
                Err(RefineError::NonPositiveLength { length })
            }
            _ => Ok(()),
        }
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
