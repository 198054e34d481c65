//! How surfaces are opened, as the command line names it.

use clap::ValueEnum;
use incise_cut::{CutMethod, CutParams};
use incise_refine::{RefineParams, RefinementLevel};

/// How surfaces are opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodChoice {
    /// Hit triangles are split: nothing is lost, any cross-section is closed.
    Exact,
    /// The paper's: hit triangles are deleted and the rim is built anew.
    Rebuild,
}

impl MethodChoice {
    /// Its name for tables.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Rebuild => "rebuild",
        }
    }

    /// How to cut with it.
    pub(crate) fn params(self, level: RefinementLevel) -> CutParams {
        CutParams {
            method: match self {
                Self::Exact => CutMethod::Exact,
                Self::Rebuild => CutMethod::Rebuild,
            },
            refine: RefineParams {
                level,
                ..RefineParams::default()
            },
            ..CutParams::default()
        }
    }
}
