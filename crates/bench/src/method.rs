//! Cut methods of the command line.

use clap::{Args, ValueEnum};
use incise_cut::{CutMethod, CutParams, PaperParams};
use incise_refine::{RefineParams, RefinementLevel};
use serde::{Serialize, Serializer};

/// A cut method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum MethodChoice {
    /// Splits hit triangles, keeps the volume, closes any cross-section.
    Exact,
    /// The paper's method: deletes hit triangles and rebuilds the rim.
    Paper,
}

/// The cut method and the refinement of its caps.
#[derive(Args, Debug, Clone, Serialize)]
pub(crate) struct MethodArguments {
    /// Cut method.
    #[arg(long, value_enum, default_value_t = MethodChoice::Exact)]
    pub(crate) method: MethodChoice,
    /// Refinement level of the caps: one of the five names, or z.
    #[arg(long, default_value = "1")]
    #[serde(serialize_with = "z")]
    pub(crate) level: RefinementLevel,
    /// Growth of the caps' edge length per meter of distance from the boundary.
    #[arg(long, default_value_t = RefineParams::default().grading)]
    pub(crate) grading: f64,
}

impl MethodArguments {
    /// Returns the parameters of a cut.
    pub(crate) fn params(&self) -> CutParams {
        CutParams {
            method: match self.method {
                MethodChoice::Exact => CutMethod::default(),
                MethodChoice::Paper => CutMethod::Paper(PaperParams::default()),
            },
            refine: RefineParams {
                level: self.level,
                grading: self.grading,
                ..RefineParams::default()
            },
            ..CutParams::default()
        }
    }
}

/// Serializes a refinement level as its number.
fn z<S: Serializer>(level: &RefinementLevel, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_f64(level.z())
}
