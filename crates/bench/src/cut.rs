//! `incise-bench cut`: the time of a cut, stage by stage, from 20 triangles to a million, and of
//! the steps of a progressive one.

mod body;
mod latency;
mod progressive;

use crate::options::{MaterialArguments, MethodArguments, ModelArguments, OutputArguments};
use crate::output::Output;
use crate::workload::{Workload, workloads};
use body::{CutBody, Outcomes, StageTimes};
use clap::Args;
use incise_models::scenes::RelativePlane;
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
/// With --progressive a step is one mean edge length. refit: the BVH, of a body at rest only;
/// growth: mean step of the last tenth relative to the first; `us_standing`: a call with the blade
/// inside and unmoved. drag: one end of the blade in the body; press: both ends outside.
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
#[derive(Args, Clone, Copy, Debug, Serialize)]
struct Parameters {
    #[command(flatten)]
    #[serde(flatten)]
    caps: MethodArguments,
    #[command(flatten)]
    #[serde(flatten)]
    material: MaterialArguments,
    /// Seed of the planes.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// The output of the bench.
type CutOutput<'a> = Output<'a, Parameters>;

/// Measures all workloads, prints and writes the rows.
pub(crate) fn run(arguments: &CutArguments, out: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let parameters = arguments.parameters;
    let mut output = Output::open("cut", &arguments.output, parameters, out)?;
    if arguments.progressive {
        return progressive::run(arguments, output);
    }
    let workloads = workloads(&arguments.models, arguments.max_triangles)?;
    let (mut done, mut failed) = (0, 0);
    output.start(workloads.len(), 1);
    for workload in &workloads {
        output.progress.begin(&workload.name);
        for row in measure(workload, arguments)? {
            done += row.cuts;
            failed += row.failures.len();
            output.row(&workload.name, &row)?;
        }
        output.progress.step();
    }
    output.table()?;
    let is_latency = |name: &String| name.trim().eq_ignore_ascii_case(latency::MODEL);
    let only = &arguments.models.only;
    if arguments.cuts > 0 && (only.is_empty() || only.iter().any(is_latency)) {
        // With coarser caps, no slice would hit as many triangles after a few hundred others.
        output.parameters.caps.grading = 0.0;
        for row in latency::measure(&output.parameters, arguments.cuts)? {
            done += row.probes;
            failed += row.failures.len();
            output.row(latency::MODEL, &row)?;
        }
        output.table()?;
    }
    Ok(output.print(format_args!("Failed: {failed} of {} cuts.", done + failed))?)
}

/// Repetitions of the plane through the middle.
const REPEATS: usize = 15;

/// Cuts of one model along one plane or many.
#[derive(Debug, Serialize)]
struct Row {
    kind: &'static str,
    family: Option<&'static str>,
    source: String,
    /// `middle`: the plane through the middle, repeated; `seeded`: seeded planes.
    planes: &'static str,
    triangles: usize,
    /// Hit triangles, median.
    hits: f64,
    /// Triangles of both caps, median.
    cap_triangles: f64,
    cuts: usize,
    /// Number of planes without a hit.
    missed: usize,
    /// Errors of cuts, with their planes.
    failures: Vec<String>,
    ms_median: StageTimes,
    ms_p99: StageTimes,
}

/// Returns a row for the plane through the middle and one for the seeded planes.
///
/// # Errors
/// An error of the solver or of an undo; errors of cuts are recorded.
fn measure(workload: &Workload, arguments: &CutArguments) -> Result<Vec<Row>, Box<dyn Error>> {
    let parameters = &arguments.parameters;
    let mut body = CutBody::new(workload.surface()?, parameters)?;
    let triangles = body.surface.topology().triangle_count();
    let mut run = |planes: &[RelativePlane]| -> Result<Outcomes, Box<dyn Error>> {
        let mut outcomes = Outcomes::default();
        for plane in planes {
            let (sweep, d) = plane.sweep(&body.surface)?;
            body.probe(&sweep, plane.normal, d, &mut outcomes)?;
        }
        Ok(outcomes)
    };
    // The first cut grows buffers.
    run(&[RelativePlane::middle()])?;
    let mut all = vec![("middle", run(&[RelativePlane::middle(); REPEATS])?)];
    if arguments.planes > 0 {
        all.push((
            "seeded",
            run(&RelativePlane::seeded(parameters.seed, arguments.planes))?,
        ));
    }
    let rows = all.into_iter().map(|(planes, outcomes)| {
        let [hits, cap_triangles] = outcomes.medians();
        Row {
            kind: "cut",
            family: workload.family,
            source: workload.source.clone(),
            planes,
            triangles,
            hits,
            cap_triangles,
            cuts: outcomes.times.len(),
            missed: outcomes.missed,
            ms_median: StageTimes::percentile(&outcomes.times, 50),
            ms_p99: StageTimes::percentile(&outcomes.times, 99),
            failures: outcomes.failures,
        }
    });
    Ok(rows.collect())
}
