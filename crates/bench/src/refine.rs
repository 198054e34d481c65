//! `incise-bench refine`: time and quality of the section meshes (caps) that cuts need.

mod sections;

use crate::options::{ModelArguments, OutputArguments};
use crate::output::Output;
use crate::workload::workloads;
use clap::Args;
use incise_refine::{RefineParams, RefinementLevel};
use serde::Serialize;
use std::error::Error;
use std::io::Write;

/// Triangulates cross-sections of models at several levels.
///
/// Points, triangles and times are medians over sections; times are those of the fastest of five
/// repetitions. Angles are the smallest of every triangle, in degrees, over all meshes: minimum,
/// minimum of sections without a corner below 40 degrees, 5th percentile, that of the worst mesh,
/// and median. Edges are inner edges over their target lengths: mean, maximum, and the number above
/// 1.8. `middle` is the plane through the middle, `seeded` are seeded planes.
#[derive(Args, Clone)]
pub(crate) struct RefineArguments {
    #[command(flatten)]
    models: ModelArguments,
    /// Number of seeded planes per model, besides the one through the middle.
    #[arg(long, value_name = "N", default_value_t = 100)]
    planes: u32,
    /// Omit larger models.
    #[arg(long, value_name = "N", default_value_t = 200_000)]
    max_triangles: usize,
    /// Refinement levels, separated by commas: the five names, or numbers z.
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "2x-coarser,1.5x-coarser,original,1.5x-finer,2x-finer"
    )]
    levels: Vec<RefinementLevel>,
    #[command(flatten)]
    parameters: Parameters,
    #[command(flatten)]
    output: OutputArguments,
}

/// The parameters of all rows.
#[derive(Args, Clone, Debug, Serialize)]
struct Parameters {
    /// Growth of the target edge length per meter of distance from the boundary.
    #[arg(long, default_value_t = RefineParams::default().grading)]
    grading: f64,
    /// Shortest edges along the boundary, in local edge lengths.
    #[arg(long, default_value_t = 0.1)]
    snap: f64,
    /// Seed of the planes.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Measures all workloads, prints and writes the rows.
pub(crate) fn run(arguments: &RefineArguments, out: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let workloads = workloads(&arguments.models, arguments.max_triangles)?;
    let parameters = &arguments.parameters;
    let mut output = Output::open("refine", &arguments.output, parameters.clone(), out)?;
    let (mut failed, mut meshes) = (0, 0);
    let progress = output.progress(workloads.len(), 1);
    for workload in &workloads {
        progress.begin(&workload.name);
        for sections in sections::cut(workload, &arguments.levels, arguments.planes, parameters)? {
            let row = sections.measure(workload, parameters)?;
            failed += row.failures.len();
            meshes += row.meshes;
            output.cpu_row(&workload.name, &row)?;
        }
        progress.step();
    }
    progress.end();
    output.table()?;
    output.print(format_args!(
        "Failed: {failed} of {} sections.",
        meshes + failed
    ))?;
    match failed {
        0 => Ok(()),
        failed => Err(format!("{failed} sections could not be cut or triangulated").into()),
    }
}
