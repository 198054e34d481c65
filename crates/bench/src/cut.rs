//! `incise-bench cut`: the time of a cut, stage by stage, from 20 triangles to a million, and of
//! the steps of a progressive one.

mod body;
mod latency;
mod planes;
mod progressive;
mod times;

use crate::method::MethodArguments;
use crate::options::{ModelArguments, OutputArguments};
use crate::output::Output;
use crate::workload::workloads;
use clap::Args;
use serde::Serialize;
use std::error::Error;
use std::io::Write;

/// Measures cuts of models, finer armadillos and spheres.
///
/// Times are those of stages, medians over cuts and 99th percentiles. detect: search and
/// intersection; split: mesh edit along the sweep; separate: pieces, unless beside the cap; commit:
/// delta and undo; `bvh_update`: unless beside the solver; constraints: update of constraints and
/// masses. `middle` is the plane through the middle, 15 times; `seeded` are seeded planes. Every
/// cut is undone before the next. Rows of kind `latency` have cuts of about equal size after many
/// others.
///
/// With --progressive a step is one mean edge length. refit: the BVH of a body in motion; growth:
/// mean step of the last tenth relative to the first; `us_standing`: a call with the blade inside
/// and unmoved. drag: one end of the blade in the body; press: both ends outside.
#[derive(Args, Clone)]
pub(crate) struct CutArguments {
    #[command(flatten)]
    models: ModelArguments,
    /// Move a blade on through bodies of 30,000 triangles, one mean edge length a step: Armadillo,
    /// Sphere30000 and Torus30000, or the selection of --only.
    #[arg(long, conflicts_with_all = ["method", "planes", "max_triangles", "cuts"])]
    progressive: bool,
    /// Total number of steps over ten bodies, which are validated now and then and replaced when
    /// they have grown.
    #[arg(long, value_name = "N", requires = "progressive")]
    steps: Option<usize>,
    #[command(flatten)]
    parameters: Parameters,
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
    #[command(flatten)]
    output: OutputArguments,
}

/// The parameters of all rows.
#[derive(Args, Clone, Debug, Serialize)]
struct Parameters {
    #[command(flatten)]
    #[serde(flatten)]
    caps: MethodArguments,
    /// Seed of the planes.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// The output of the bench.
type CutOutput<'a> = Output<'a, Parameters>;

/// Successful and failed cuts.
#[derive(Debug, Default)]
struct Counts {
    done: usize,
    failed: usize,
}

impl Counts {
    fn add(&mut self, done: usize, failures: &[String]) {
        self.done += done;
        self.failed += failures.len();
    }
}

/// Measures all workloads, prints and writes the rows.
pub(crate) fn run(arguments: &CutArguments, out: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let parameters = arguments.parameters.clone();
    let (method, exact) = (parameters.caps.method(), parameters.caps.exact());
    let seed = parameters.seed;
    let mut output = Output::open("cut", &arguments.output, parameters, out)?;
    if arguments.progressive {
        return progressive::run(arguments, &exact, output);
    }
    let workloads = workloads(&arguments.models, arguments.max_triangles)?;
    let mut counts = Counts::default();
    let progress = output.progress(workloads.len(), 1);
    for workload in &workloads {
        progress.begin(&workload.name);
        for row in planes::measure(workload, &method, arguments.planes, seed)? {
            counts.add(row.cuts, &row.failures);
            output.cpu_row(&workload.name, &row)?;
        }
        progress.step();
    }
    progress.end();
    output.table()?;
    let is_latency = |name: &String| name.trim().eq_ignore_ascii_case(latency::MODEL);
    let only = &arguments.models.only;
    if arguments.cuts > 0 && (only.is_empty() || only.iter().any(is_latency)) {
        // With coarser caps, no slice would hit as many triangles after a few hundred others.
        output.parameters.caps.grading = 0.0;
        let method = output.parameters.caps.method();
        for row in latency::measure(method, arguments.cuts, seed)? {
            counts.add(row.probes, &row.failures);
            output.cpu_row(latency::MODEL, &row)?;
        }
        output.table()?;
    }
    let Counts { done, failed } = counts;
    Ok(output.print(format_args!("Failed: {failed} of {} cuts.", done + failed))?)
}
