//! Options of the method of `cut` and `render`: the exact one, or the paper's with its parameters.

use crate::cut_options::{CutOptions, CutPlan};
use crate::failure::Failure;
use crate::param_options::{OptionSet, ParamOptions};
use clap::{Arg, ValueEnum};
use incise_paper::PaperParams;
use incise_params::{Params, resolve};

/// The options of the method.
#[derive(clap::Args)]
pub(crate) struct MethodOptions {
    /// Method to open the surface.
    #[arg(long, value_enum, default_value_t = Method::Exact, requires = "cutter")]
    method: Method,
    #[command(flatten)]
    paper: ParamOptions<PaperOptionSet>,
}

/// A method to open a surface along a sweep.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Method {
    /// Splits the hit triangles along the sweep; any cross-section.
    Exact,
    /// Deletes the hit triangles and rebuilds the boundary by the paper's listings; closed bodies
    /// without holes only.
    Paper,
}

/// Names of the options that the paper's method alone has.
const OF_PAPER: [&str; 4] = ["max-rounds", "min-distance", "beta", "ear-angle"];

/// The parameters of the paper's method; others than [`OF_PAPER`] share options with the exact one.
#[derive(Debug)]
struct PaperOptionSet;

impl OptionSet for PaperOptionSet {
    type Params = PaperParams;

    fn option(_: &str, option: Arg) -> Option<Arg> {
        OF_PAPER
            .contains(&option.get_id().as_str())
            .then_some(option)
    }
}

impl MethodOptions {
    /// Returns the name of the method.
    pub(crate) fn name(&self) -> &'static str {
        match self.method {
            Method::Exact => "exact",
            Method::Paper => "paper",
        }
    }

    /// Returns the plan of a cut by the chosen method, which must have all given options.
    pub(crate) fn plan<'a>(&self, cut: &'a CutOptions) -> Result<CutPlan<'a>, Failure> {
        let plan = cut.check()?;
        let refused = |name: &str, with| Failure::NotWith {
            option: format!("--{name}"),
            with,
        };
        if self.method == Method::Exact {
            let mut given = self.paper.given().iter().map(|(name, _)| name.as_str());
            return match given.find(|name| OF_PAPER.contains(name)) {
                Some(name) => Err(refused(name, "--method exact")),
                None => Ok(plan),
            };
        }
        let params = self.paper.params()?;
        for (name, _) in cut.given() {
            if resolve(PaperParams::FIELDS, name).is_err() {
                return Err(refused(name, "--method paper"));
            }
        }
        Ok(plan.by_paper(params))
    }
}
