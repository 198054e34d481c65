//! `incise-bench skip`: the cost of features that a scene does not use, and of some that it does.
//!
//! Every claim bounds the time of one frame relative to another. Counts of skipped work are tests
//! of `incise-scene` and `incise-pbd-gpu`.

mod claims;

use crate::measure::measure_pairs;
use crate::options::{BackendArguments, OutputArguments};
use crate::output::Output;
use clap::Args;
use incise_models::Model;
use incise_scene::{Scene, SceneParams};
use serde::Serialize;
use std::error::Error;
use std::io::Write;

/// Measures the cost of features; fails if a bound is exceeded.
///
/// A claim holds when the measured value is at most the bound. Two frames are timed in turns; the
/// median of their ratios counts, not the ratio of the medians shown.
#[derive(Args, Clone)]
pub(crate) struct SkipArguments {
    /// Features to measure, separated by commas.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = NAMES)]
    only: Vec<String>,
    /// Measure small bodies and fewer pairs of times: seconds instead of minutes.
    #[arg(long)]
    quick: bool,
    #[command(flatten)]
    backends: BackendArguments,
    #[command(flatten)]
    output: OutputArguments,
}

/// The measured features in the order of the table.
const NAMES: [&str; 8] = [
    "sleep",
    "absent",
    "volume",
    "interior-springs",
    "contacts",
    "blade-at-rest",
    "far-blade",
    "early-out",
];

/// The extent of a run.
#[derive(Debug, Clone, Copy)]
struct Effort {
    /// Pairs of times per claim; the median counts.
    pairs: u32,
    /// Models of sleeping bodies.
    sleepers: &'static [Model],
    /// Models of all other claims.
    models: &'static [Model],
}

const FULL: Effort = Effort {
    pairs: 101,
    sleepers: &Model::ALL,
    models: &[Model::Bunny, Model::Armadillo],
};

const QUICK: Effort = Effort {
    pairs: 21,
    sleepers: &[Model::Sphere20, Model::Bunny],
    models: &[Model::Bunny],
};

/// A frame that can be repeated.
type Frame = Box<dyn FnMut() -> Result<(), Box<dyn Error>>>;
/// Sets up the two frames that a claim compares.
type SetUp = Box<dyn FnOnce() -> Result<[Frame; 2], Box<dyn Error>>>;

/// A bound on the time of a frame relative to another.
struct Claim {
    /// One of [`NAMES`].
    feature: &'static str,
    text: &'static str,
    /// The measured body.
    on: &'static str,
    bound: f64,
    /// Whether the bound is the time of the first frame itself \[us\].
    is_time: bool,
    frames: SetUp,
}

impl Claim {
    /// Returns a bound on the ratio of two frames of a model.
    fn new(
        feature: &'static str,
        text: &'static str,
        model: Model,
        bound: f64,
        frames: impl FnOnce() -> Result<[Frame; 2], Box<dyn Error>> + 'static,
    ) -> Self {
        Self {
            feature,
            text,
            on: model.name(),
            bound,
            is_time: false,
            frames: Box::new(frames),
        }
    }

    /// Times the frames in turns.
    ///
    /// # Errors
    /// The error of a frame.
    fn measure(self, pairs: u32) -> Result<Row, Box<dyn Error>> {
        let found = measure_pairs(pairs, &mut (self.frames)()?)?;
        let measured = match self.is_time {
            true => found.seconds[0] * 1e6,
            false => found.ratio,
        };
        Ok(Row {
            on: self.on,
            claim: self.text,
            bound: self.bound,
            measured,
            passed: measured <= self.bound,
            us: found.seconds[0] * 1e6,
            us_without: (!self.is_time).then_some(found.seconds[1] * 1e6),
        })
    }
}

/// A claim and its verdict.
#[derive(Debug, Serialize)]
struct Row {
    /// The measured body.
    on: &'static str,
    claim: &'static str,
    /// Largest value that passes.
    bound: f64,
    measured: f64,
    passed: bool,
    /// Median times of both frames \[us\]; none of a frame that does nothing.
    us: f64,
    us_without: Option<f64>,
}

/// Measures the claims, prints and writes their rows.
pub(crate) fn run(arguments: &SkipArguments, out: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let effort = if arguments.quick { QUICK } else { FULL };
    let mut output = Output::open("skip", &arguments.output, (), out)?;
    let (mut count, mut failed) = (0, 0);
    for backend in arguments.backends.devices()? {
        let request = arguments.backends.request(backend);
        let scene = Scene::with_backend(SceneParams::default(), &request)?;
        output.set_backend(backend.name(), scene.backend_report().adapter);
        let mut claims = claims::claims(effort, &request);
        let is_named = |claim: &Claim| arguments.only.iter().any(|name| name == claim.feature);
        claims.retain(|claim| arguments.only.is_empty() || is_named(claim));
        output.start(claims.len(), 1);
        for claim in claims {
            let feature = claim.feature;
            output.progress.begin(&format!("{feature}, {}", claim.on));
            let row = claim.measure(effort.pairs)?;
            (count, failed) = (count + 1, failed + u32::from(!row.passed));
            output.row(feature, &row)?;
            output.progress.step();
        }
    }
    output.table()?;
    match (count, failed) {
        (0, _) => Err("--only names no feature of these backends".into()),
        (_, 0) => Ok(()),
        _ => Err(format!("{failed} of {count} claims do not hold").into()),
    }
}
