//! The solver alone: projections a second, and frames a second of both kinds.

use crate::json::Json;
use crate::options::{ModelArguments, OutputArguments};
use crate::{machine, models};
use clap::Args;
use incise_mesh::Surface;
use incise_pbd_gpu::{ConstraintError, Material, Solver, SolverParams, StepError};
use serde::Serialize;
use std::error::Error;
use std::io::Write;
use std::time::Instant;

/// Which model the solver is measured on.
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
    /// Frames of each measurement; the fastest counts.
    #[arg(long, default_value_t = 120, value_parser = clap::value_parser!(u32).range(1..))]
    frames: u32,
    #[command(flatten)]
    pub(crate) rows: OutputArguments,
}

/// Iterations of a measured frame.
const ITERATIONS: u32 = 10;

/// A measurement, as JSON.
#[derive(Debug, Serialize)]
struct Row {
    model: &'static str,
    source: String,
    triangles: usize,
    iterations: u32,
    /// Frames of which the fastest counts.
    frames: u32,
    threads: usize,
    constraints: &'static str,
    ms_per_frame: f64,
    projections_per_second: f64,
    machine: String,
    commit: String,
}

/// Measures and prints.
pub(crate) fn run(arguments: &SolverArguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let (machine, commit) = (machine::machine(), machine::commit());
    let mut json = Json::open(arguments.rows.json.as_deref())?;
    writeln!(out, "{machine}, commit {commit}")?;
    let stretch_only = Material {
        bending: None,
        ..Material::default()
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let models = models::load(arguments.from.models.as_deref(), &arguments.only)?;
    let used = models.iter().map(|l| (l.model.name(), l.source.as_str()));
    models::tell_built_in(arguments.from.models.as_deref(), used);
    let mut rows = Vec::new();
    let progress = arguments.rows.progress(models.len(), 4);
    for loaded in models {
        let (model, triangles) = (
            loaded.model.name(),
            loaded.surface.topology().triangle_count(),
        );
        progress.begin(model);
        progress.aside(|| {
            writeln!(
                out,
                "{model} ({}), {triangles} triangles, {ITERATIONS} iterations, fastest of {} frames",
                loaded.source, arguments.frames
            )
        })?;
        for threads in [1, cores] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()?;
            for (name, material) in [
                ("stretch", stretch_only),
                ("stretch and bending", Material::default()),
            ] {
                let (seconds, projections) =
                    pool.install(|| measure(&loaded.surface, &material, arguments.frames))?;
                progress.aside(|| {
                    writeln!(
                        out,
                        "  {threads} threads, {name:20} {:8.3} ms a frame, {:6.1} FPS, {:6.1} M projections/s",
                        seconds * 1e3,
                        1.0 / seconds,
                        projections / seconds / 1e6
                    )
                })?;
                progress.step();
                rows.push(Row {
                    model,
                    source: loaded.source.clone(),
                    triangles,
                    iterations: ITERATIONS,
                    frames: arguments.frames,
                    threads,
                    constraints: name,
                    ms_per_frame: seconds * 1e3,
                    projections_per_second: projections / seconds,
                    machine: machine.clone(),
                    commit: commit.clone(),
                });
            }
        }
    }
    progress.end();
    Ok(json.write(&rows)?)
}

/// Why a model cannot be measured.
#[derive(Debug, thiserror::Error)]
enum MeasureError {
    #[error(transparent)]
    Constraint(#[from] ConstraintError),
    #[error(transparent)]
    Step(#[from] StepError),
}

/// The fastest frame's time \[s\] and its projections.
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
