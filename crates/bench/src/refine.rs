//! `incise-bench refine`: time and quality of the section meshes (caps) that cuts need.

pub(crate) mod row;
mod sections;

use crate::json::Json;
use crate::options::{ModelArguments, OutputArguments};
use crate::{machine, text_table, workload};
use clap::Args;
use incise_refine::{RefineParams, RefinementLevel};
use row::{Row, Stamp};
use std::error::Error;
use std::io::Write;

/// Triangulates cross-sections of models at several levels.
#[derive(Args, Clone)]
pub(crate) struct RefineArguments {
    #[command(flatten)]
    from: ModelArguments,
    /// Models to cut, separated by commas: those of the table, finer armadillos such as
    /// Armadillo120000, and spheres such as Sphere3072.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,
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
    /// Growth of the target edge length per meter of distance from the boundary.
    #[arg(long, default_value_t = RefineParams::default().grading)]
    grading: f64,
    /// Shortest edges along the boundary, in local edge lengths.
    #[arg(long, default_value_t = 0.1)]
    snap: f64,
    /// Seed of the planes.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    pub(crate) rows: OutputArguments,
}

/// Measures all workloads, prints and writes the rows.
pub(crate) fn run(arguments: &RefineArguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let folder = arguments.from.models.as_deref();
    let workloads = workload::workloads(folder, &arguments.only, arguments.max_triangles)?;
    let stamp = Stamp {
        grading: arguments.grading,
        snap: arguments.snap,
        seed: arguments.seed,
        machine: machine::machine(),
        commit: machine::commit(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
    };
    let mut json = Json::open(arguments.rows.json.as_deref())?;
    writeln!(
        out,
        "{}, commit {}; grading {}, snap {}, seed {}",
        stamp.machine, stamp.commit, stamp.grading, stamp.snap, stamp.seed
    )?;
    let mut rows: Vec<Row> = Vec::new();
    let mut written = Ok(());
    let progress = arguments.rows.progress(workloads.len(), 1);
    for workload in &workloads {
        progress.begin(&workload.name);
        for sections in sections::cut(workload, &arguments.levels, arguments.planes, &stamp)? {
            rows.push(sections.measure(workload, &stamp)?);
        }
        progress.step();
        written = json.write(&rows);
    }
    progress.end();
    write!(out, "{}", text_table::text_table(row::COLUMNS, &rows))?;
    write!(out, "{}", text_table::paragraphs(row::LEGEND))?;
    let failed: usize = rows.iter().map(|row| row.failures.len()).sum();
    let meshes: usize = rows.iter().map(|row| row.covers).sum();
    writeln!(out, "Failed: {failed} of {} sections.", meshes + failed)?;
    for failure in rows.iter().flat_map(|row| &row.failures) {
        writeln!(out, "  {failure}")?;
    }
    written?;
    if failed > 0 {
        return Err(format!("{failed} sections could not be cut or triangulated").into());
    }
    Ok(())
}
