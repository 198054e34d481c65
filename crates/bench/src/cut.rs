//! `incise-bench cut`: the time of a cut, stage by stage, from 20 triangles to a million, and of
//! the steps of a progressive one.

mod body;
mod latency;
mod planes;
pub(crate) mod progressive;
pub(crate) mod row;
pub(crate) mod times;

use crate::json::Json;
use crate::method::MethodArguments;
use crate::options::{ModelArguments, OutputArguments};
use crate::text_table::{paragraphs, text_table};
use crate::{machine, workload};
use clap::Args;
use row::{Record, Slope, Stamp};
use std::error::Error;
use std::io::Write;

/// Measures cuts of models, finer armadillos and spheres.
#[derive(Args, Clone)]
pub(crate) struct CutArguments {
    #[command(flatten)]
    from: ModelArguments,
    /// Models to cut, separated by commas: those of the table, finer armadillos such as
    /// Armadillo120000, and spheres such as Sphere3072; with --progressive also Sphere30000,
    /// Torus30000 and Icosphere1280.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,
    /// Move a blade on through bodies of 30,000 triangles, one mean edge length a step.
    #[arg(long, conflicts_with_all = ["method", "planes", "max_triangles", "cuts"])]
    progressive: bool,
    /// Total number of steps over ten bodies, which are validated now and then and replaced when
    /// they have grown.
    #[arg(long, value_name = "N", requires = "progressive")]
    steps: Option<usize>,
    #[command(flatten)]
    caps: MethodArguments,
    /// Number of seeded planes per model, besides the one through the middle.
    #[arg(long, value_name = "N", default_value_t = 100)]
    planes: u32,
    /// Omit larger models.
    #[arg(long, value_name = "N", default_value_t = 1_400_000)]
    max_triangles: usize,
    /// Number of earlier cuts at which latencies are compared; 0 compares none. The body is
    /// Sphere49152, so that --only has to name it, or nothing.
    #[arg(long, value_name = "N", default_value_t = 1000)]
    cuts: u32,
    /// Seed of the planes.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    pub(crate) rows: OutputArguments,
}

/// Measures all workloads, prints and writes the records.
pub(crate) fn run(arguments: &CutArguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let params = arguments.caps.params();
    let stamp = Stamp {
        method: arguments.caps.method.name().to_owned(),
        level: arguments.caps.level.z(),
        grading: arguments.caps.grading,
        seed: arguments.seed,
        machine: machine::machine(),
        commit: machine::commit(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
    };
    writeln!(
        out,
        "{}, commit {}; method {}, level {}, grading {}, seed {}",
        stamp.machine, stamp.commit, stamp.method, arguments.caps.level, stamp.grading, stamp.seed
    )?;
    let mut json = Json::open(arguments.rows.json.as_deref())?;
    if arguments.progressive {
        return progressive::run(arguments, &params, &stamp, &mut json, out);
    }
    let folder = arguments.from.models.as_deref();
    let workloads = workload::workloads(folder, &arguments.only, arguments.max_triangles)?;
    let mut records = Vec::new();
    let progress = arguments.rows.progress(workloads.len(), 1);
    for workload in &workloads {
        progress.begin(&workload.name);
        for row in planes::measure(workload, &params, arguments.planes, &stamp)? {
            records.push(Record::Cut(Box::new(row)));
        }
        progress.step();
        // An interrupted run keeps its rows; the last write reports a failure.
        let _ = json.write(&records);
    }
    progress.end();
    let rows: Vec<_> = records.iter().filter_map(Record::row).collect();
    write!(out, "{}", text_table(row::COLUMNS, &rows))?;
    write!(out, "{}", paragraphs(row::LEGEND))?;
    let slopes = Slope::of_families(&records, &stamp);
    records.extend(slopes.into_iter().map(Record::Slope));
    let is_latency = |name: &String| name.trim().eq_ignore_ascii_case(latency::MODEL);
    let is_wanted = arguments.only.is_empty() || arguments.only.iter().any(is_latency);
    if arguments.cuts > 0 && is_wanted {
        let rows = latency::measure(&params, arguments.cuts, &stamp)?;
        records.extend(rows.into_iter().map(|row| Record::Latency(Box::new(row))));
    }
    let (mut done, mut failed) = (0, 0);
    for record in &records {
        if let Some(sentence) = record.sentence() {
            write!(out, "{}", paragraphs(&sentence))?;
        }
        let (model, cuts, failures) = record.failures();
        for failure in failures {
            writeln!(out, "Failed cut of {model}: {failure}.")?;
        }
        done += cuts;
        failed += failures.len();
    }
    writeln!(out, "Failed: {failed} of {} cuts.", done + failed)?;
    Ok(json.write(&records)?)
}
