//! `incise-bench skip`: the cost of features that a scene does not use, and of some that it does.
//!
//! Every claim bounds the time of one frame relative to another. Counts of skipped work are tests
//! of `incise-scene` and `incise-pbd-gpu`.

mod claims;
#[cfg(feature = "gpu")]
mod device;
#[cfg(not(feature = "gpu"))]
mod device {
    use super::{Claim, Effort};

    crate::no_gpu::absent_device! {
        describe() -> String;
        claims(Effort) -> Vec<Claim>;
    }
}
pub(crate) mod row;

use crate::backend::Executor;
use crate::clock;
use crate::json::Json;
use crate::machine;
use crate::options::{OutputArguments, RunArguments};
use crate::text_table::{count, paragraphs, table_with_text};
use clap::Args;
use device::Device;
use incise_models::Model;
use row::Row;
use std::error::Error;
use std::io::Write;

/// Measures the cost of features; fails if a bound is exceeded.
#[derive(Args, Clone)]
pub(crate) struct SkipArguments {
    /// Features to measure, separated by commas.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = NAMES)]
    only: Vec<String>,
    /// Measure small bodies and fewer pairs of times: seconds instead of minutes.
    #[arg(long)]
    quick: bool,
    #[command(flatten)]
    pub(crate) run: RunArguments,
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

/// Length of a frame \[s\].
const DT: f32 = 1.0 / 60.0;

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
    on: String,
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
            on: model.name().to_owned(),
            bound,
            is_time: false,
            frames: Box::new(frames),
        }
    }

    /// Times the frames in turns.
    ///
    /// # Errors
    /// The error of a frame.
    fn measure(self, pairs: u32, device: &str) -> Result<Row, Box<dyn Error>> {
        let [mut first, mut second] = (self.frames)()?;
        let found = clock::pairs(pairs, &mut first, &mut second)?;
        let [one, other] = found.seconds.map(microseconds);
        let measured = match self.is_time {
            true => found.seconds[0] * 1e6,
            false => found.ratio,
        };
        Ok(Row {
            skip: self.feature.to_owned(),
            claim: self.text.to_owned(),
            at: match self.is_time {
                true => self.on,
                false => format!("{}: {one} of {other} us", self.on),
            },
            bound: Some(self.bound),
            measured: Some(measured),
            passed: measured <= self.bound,
            device: device.to_owned(),
            commit: machine::commit(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        })
    }
}

/// Formats seconds as microseconds with three digits.
fn microseconds(seconds: f64) -> String {
    let us = seconds * 1e6;
    let digits = if us < 10.0 {
        2
    } else {
        usize::from(us < 100.0)
    };
    format!("{us:.digits$}")
}

/// Measures the claims that `only` names, or all.
fn measure(
    mut claims: Vec<Claim>,
    (only, pairs): (&[String], u32),
    device: &str,
    rows: &OutputArguments,
) -> Result<Vec<Row>, Box<dyn Error>> {
    claims.retain(|claim| only.is_empty() || only.iter().any(|name| name == claim.feature));
    let progress = rows.progress(claims.len(), 1);
    let mut out = Vec::new();
    for claim in claims {
        progress.begin(&format!("{}, {}", claim.feature, claim.on));
        out.push(claim.measure(pairs, device)?);
        progress.step();
    }
    progress.end();
    Ok(out)
}

/// Measures the claims, prints and writes their rows.
pub(crate) fn run(arguments: &SkipArguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let SkipArguments { run, only, quick } = arguments;
    let effort = if *quick { QUICK } else { FULL };
    let mut json = Json::open(run.rows.json.as_deref())?;
    let mut rows: Vec<Row> = Vec::new();
    for executor in run.backends() {
        let (claims, device) = match executor {
            Executor::Cpu => (claims::on_cpu(effort), machine::machine()),
            Executor::Gpu => {
                let device = Device::open(run.gpu.adapter.as_deref())?;
                (device.claims(effort), device.describe())
            }
        };
        let (name, commit) = (executor.name(), machine::commit());
        writeln!(out, "{name}: {device}, commit {commit}")?;
        out.flush()?;
        rows.extend(measure(claims, (only, effort.pairs), &device, &run.rows)?);
    }
    if rows.is_empty() {
        return Err("--only names no feature of these backends".into());
    }
    let table = table_with_text(row::COLUMNS, &rows, "claim and body", Row::text);
    write!(out, "{table}")?;
    write!(out, "{}", paragraphs(row::LEGEND))?;
    let failed = rows.iter().filter(|row| !row.passed).count();
    writeln!(out, "Failed: {failed} of {}.", count(rows.len(), "claim"))?;
    json.write(&rows)?;
    if failed > 0 {
        let verb = if failed == 1 { "does" } else { "do" };
        return Err(format!("{} {verb} not hold", count(failed, "claim")).into());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_feature_has_a_claim() {
        for effort in [FULL, QUICK] {
            let claims = claims::on_cpu(effort);
            assert!(claims.iter().all(|claim| NAMES.contains(&claim.feature)));
            for name in NAMES {
                assert!(claims.iter().any(|claim| claim.feature == name), "{name}");
            }
        }
    }

    #[test]
    fn named_claims_are_measured() {
        let only = ["early-out".to_owned()];
        let output = OutputArguments::default();
        let rows = measure(claims::on_cpu(QUICK), (&only, 1), "D", &output).unwrap();
        let features: Vec<&str> = rows.iter().map(|row| row.skip.as_str()).collect();
        assert_eq!(features, ["early-out"]);
        assert!(rows[0].measured.unwrap() > 0.0, "{rows:?}");
    }
}
