//! `incise-bench solver`: projections and frames per second of the solver alone.

use crate::json::Json;
use crate::numbers::fixed;
use crate::options::{ModelArguments, OutputArguments};
use crate::text_table::{Column, text_table};
use crate::{machine, models};
use clap::Args;
use incise_mesh::Surface;
use incise_pbd_gpu::{ConstraintError, Material, Solver, SolverParams, StepError};
use serde::Serialize;
use std::error::Error;
use std::io::Write;
use std::time::Instant;

/// Measures the solver alone.
#[derive(Args, Clone)]
pub(crate) struct SolverArguments {
    #[command(flatten)]
    from: ModelArguments,
    /// Models to run, separated by commas.
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        default_value = "Armadillo"
    )]
    only: Vec<String>,
    /// Frames per measurement; the fastest counts.
    #[arg(long, default_value_t = 120, value_parser = clap::value_parser!(u32).range(1..))]
    frames: u32,
    #[command(flatten)]
    pub(crate) rows: OutputArguments,
}

/// Iterations per frame.
const ITERATIONS: u32 = 10;

/// A row of the table and of the JSON.
#[derive(Debug, Serialize)]
struct Row {
    model: &'static str,
    source: String,
    triangles: usize,
    iterations: u32,
    /// Measured frames; the fastest counts.
    frames: u32,
    threads: usize,
    constraints: &'static str,
    ms_per_frame: f64,
    projections_per_second: f64,
    machine: String,
    commit: String,
}

const COLUMNS: &[Column<Row>] = &[
    ("model", |row| row.model.to_owned()),
    ("triangles", |row| row.triangles.to_string()),
    ("constraints", |row| row.constraints.to_owned()),
    ("threads", |row| row.threads.to_string()),
    ("ms", |row| fixed(row.ms_per_frame, 3)),
    ("FPS", |row| fixed(1e3 / row.ms_per_frame, 1)),
    ("M proj/s", |row| fixed(row.projections_per_second / 1e6, 1)),
    ("source", |row| row.source.clone()),
];

/// Measures all models, prints and writes the rows.
pub(crate) fn run(arguments: &SolverArguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let (machine, commit) = (machine::machine(), machine::commit());
    let mut json = Json::open(arguments.rows.json.as_deref())?;
    writeln!(out, "{machine}, commit {commit}; {ITERATIONS} iterations")?;
    let stretch_only = Material {
        bending: None,
        ..Material::default()
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let models = models::load(arguments.from.models.as_deref(), &arguments.only)?;
    let used = models.iter().map(|l| (l.model.name(), l.source.as_str()));
    models::warn_built_in(arguments.from.models.as_deref(), used);
    let mut rows = Vec::new();
    let progress = arguments.rows.progress(models.len(), 4);
    for loaded in models {
        progress.begin(loaded.model.name());
        for threads in [1, cores] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()?;
            for (constraints, material) in [
                ("stretch", stretch_only),
                ("stretch and bending", Material::default()),
            ] {
                let (seconds, projections) =
                    pool.install(|| measure(&loaded.surface, &material, arguments.frames))?;
                progress.step();
                rows.push(Row {
                    model: loaded.model.name(),
                    source: loaded.source.clone(),
                    triangles: loaded.surface.topology().triangle_count(),
                    iterations: ITERATIONS,
                    frames: arguments.frames,
                    threads,
                    constraints,
                    ms_per_frame: seconds * 1e3,
                    projections_per_second: projections / seconds,
                    machine: machine.clone(),
                    commit: commit.clone(),
                });
            }
        }
    }
    progress.end();
    write!(out, "{}", text_table(COLUMNS, &rows))?;
    writeln!(out, "ms: the fastest of {} frames.", arguments.frames)?;
    Ok(json.write(&rows)?)
}

/// An error of a measurement.
#[derive(Debug, thiserror::Error)]
enum MeasureError {
    #[error(transparent)]
    Constraint(#[from] ConstraintError),
    #[error(transparent)]
    Step(#[from] StepError),
}

/// Returns the time of the fastest frame \[s\] and its projections.
fn measure(
    surface: &Surface,
    material: &Material,
    frames: u32,
) -> Result<(f64, f64), MeasureError> {
    let mut surface = surface.clone();
    let mut solver = Solver::new(&mut surface, material)?;
    let params = SolverParams {
        iterations: ITERATIONS,
        ..SolverParams::paper()
    };
    let mut best = f64::INFINITY;
    for _ in 0..frames {
        let begin = Instant::now();
        solver.step(&mut surface, 1.0 / 60.0, &params)?;
        best = best.min(begin.elapsed().as_secs_f64());
    }
    let stats = solver.stats();
    let projections = stats.stretch_projections + stats.bending_projections;
    #[expect(
        clippy::cast_precision_loss,
        reason = "a frame has far fewer than 2^53 projections"
    )]
    Ok((best, projections as f64))
}
