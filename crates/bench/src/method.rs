//! Cut methods of the command line.

use clap::{Args, ValueEnum};
use incise_cut::{CutError, CutOutcome, CutParams, Cutter, Sweep};
use incise_mesh::Surface;
use incise_paper::{PaperError, PaperParams};
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
    /// Returns the method with its parameters.
    pub(crate) fn method(&self) -> Method {
        match self.method {
            MethodChoice::Exact => Method::Exact(self.exact()),
            MethodChoice::Paper => Method::Paper(PaperParams {
                level: self.level,
                ..PaperParams::default()
            }),
        }
    }

    /// Returns the parameters of a cut by the exact method.
    pub(crate) fn exact(&self) -> CutParams {
        CutParams {
            refine: RefineParams {
                level: self.level,
                grading: self.grading,
                ..RefineParams::default()
            },
            ..CutParams::default()
        }
    }
}

/// A cut method with its parameters.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Method {
    Exact(CutParams),
    Paper(PaperParams),
}

/// The reason why a method refused a cut.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Refusal {
    #[error(transparent)]
    Exact(#[from] CutError),
    #[error(transparent)]
    Paper(#[from] PaperError),
}

impl Method {
    /// Returns the method for cuts of one piece.
    pub(crate) fn only(mut self, piece: u32) -> Self {
        match &mut self {
            Self::Exact(params) => params.only_piece = Some(piece),
            Self::Paper(params) => params.only_piece = Some(piece),
        }
        self
    }

    /// Cuts a surface.
    pub(crate) fn cut(
        &self,
        cutter: &mut Cutter,
        surface: &mut Surface,
        sweep: &Sweep,
    ) -> Result<CutOutcome, Refusal> {
        Ok(match self {
            Self::Exact(params) => cutter.cut(surface, sweep, params)?,
            Self::Paper(params) => incise_paper::cut(cutter, surface, sweep, params)?.cut,
        })
    }
}

/// Serializes a refinement level as its number.
fn z<S: Serializer>(level: &RefinementLevel, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_f64(level.z())
}
