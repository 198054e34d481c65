//! Cut methods of the command line.

use clap::ValueEnum;
use incise_cut::{CutMethod, CutParams, PaperParams};
use incise_refine::{RefineParams, RefinementLevel};

/// A cut method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodChoice {
    /// Splits hit triangles, keeps the volume, closes any cross-section.
    Exact,
    /// The paper's method: deletes hit triangles and rebuilds the rim.
    Paper,
}

impl MethodChoice {
    /// Returns the name in tables.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Paper => "paper",
        }
    }

    /// Returns the parameters of a cut.
    pub(crate) fn params(self, level: RefinementLevel) -> CutParams {
        CutParams {
            method: match self {
                Self::Exact => CutMethod::default(),
                Self::Paper => CutMethod::Paper(PaperParams::default()),
            },
            refine: RefineParams {
                level,
                ..RefineParams::default()
            },
            ..CutParams::default()
        }
    }
}
