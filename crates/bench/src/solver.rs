//! `incise-bench solver`: projections per second by kind and number of threads, and the share of a
//! frame that is not projection.

use crate::measure::{Budget, measure};
use crate::motion;
use crate::options::{LengthArguments, ModelArguments, OutputArguments};
use crate::output::Output;
use crate::workload::workloads;
use clap::Args;
use incise_mesh::Surface;
use incise_pbd_gpu::{Material, SolverParams};
use incise_scene::{Scene, SceneError, SceneParams};
use serde::Serialize;
use std::error::Error;
use std::io::Write;

/// Measures the solver alone.
///
/// Bodies fall freely; the fastest frame counts. Projections per second of all threads come from
/// frames of twice as many iterations and of stretch alone. `other` is the share of a frame that is
/// not projection.
#[derive(Args, Clone)]
pub(crate) struct SolverArguments {
    #[command(flatten)]
    models: ModelArguments,
    #[command(flatten)]
    length: LengthArguments,
    #[command(flatten)]
    parameters: Parameters,
    #[command(flatten)]
    output: OutputArguments,
}

/// The parameters of all rows.
#[derive(Args, Clone, Copy, Debug, Serialize)]
struct Parameters {
    /// Copies of the model in the scene.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    bodies: u32,
    /// Iterations per frame, of two projections of every constraint.
    #[arg(skip = ITERATIONS)]
    iterations: u32,
}

/// Models that run by default.
const MODELS: [&str; 2] = ["Bunny", "Armadillo"];

/// Iterations per frame; the share that is not projection comes from twice as many.
///
/// They project every constraint ten times, as often as those of other engines.
const ITERATIONS: u32 = 5;

/// Triangles of the largest model.
const MAX_TRIANGLES: usize = 2_000_000;

/// A number of threads.
#[derive(Debug, Serialize)]
struct Row {
    source: String,
    /// Of one body, like edges and hinges.
    triangles: usize,
    edges: usize,
    hinges: usize,
    threads: usize,
    ms_per_frame: f64,
    /// Time of one thread over this time.
    speed_up: f64,
    stretch_projections_per_second: f64,
    bending_projections_per_second: f64,
    /// Share of a frame that is not projection, 0 to 1.
    other: f64,
}

/// Measures all models, prints and writes the rows.
pub(crate) fn run(arguments: &SolverArguments, out: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let mut models = arguments.models.clone();
    if models.only.is_empty() {
        models.only = MODELS.map(str::to_owned).to_vec();
    }
    let workloads = workloads(&models, MAX_TRIANGLES)?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut output = Output::open("solver", &arguments.output, arguments.parameters, out)?;
    output.start(workloads.len(), cores as u64);
    for workload in &workloads {
        output.progress.begin(&workload.name);
        let surface = workload.surface()?;
        let mut one_thread = None;
        for threads in 1..=cores {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()?;
            let mut row = pool.install(|| Row::measure(&surface, arguments))?;
            row.source.clone_from(&workload.source);
            row.speed_up = *one_thread.get_or_insert(row.ms_per_frame) / row.ms_per_frame;
            output.row(&workload.name, &row)?;
            output.progress.step();
        }
    }
    Ok(output.table()?)
}

impl Row {
    /// Measures the current number of threads; without the source and the speed-up.
    fn measure(surface: &Surface, arguments: &SolverArguments) -> Result<Self, SceneError> {
        let material = motion::material();
        let stretch = Material {
            bending: None,
            ..material
        };
        let frame = |material: &Material, iterations: u32| {
            fastest_frame(surface, material, iterations, arguments)
        };
        let per_iteration = |few: f64, many: f64| (many - few) / f64::from(ITERATIONS);
        let seconds = frame(&material, ITERATIONS)?;
        let iteration = per_iteration(seconds, frame(&material, 2 * ITERATIONS)?);
        let stretch = per_iteration(
            frame(&stretch, ITERATIONS)?,
            frame(&stretch, 2 * ITERATIONS)?,
        );
        let topology = surface.topology();
        // Every edge of a closed surface has a stretch and a bending constraint.
        let edges = topology.edges().count();
        let all = 2.0 * edges as f64 * f64::from(arguments.parameters.bodies);
        Ok(Self {
            source: String::new(),
            triangles: topology.triangle_count(),
            edges,
            hinges: edges,
            threads: rayon::current_num_threads(),
            ms_per_frame: seconds * 1e3,
            speed_up: 1.0,
            stretch_projections_per_second: all / stretch,
            bending_projections_per_second: all / (iteration - stretch),
            other: (1.0 - f64::from(ITERATIONS) * iteration / seconds).max(0.0),
        })
    }
}

/// Returns the time of the fastest frame \[s\].
fn fastest_frame(
    surface: &Surface,
    material: &Material,
    iterations: u32,
    arguments: &SolverArguments,
) -> Result<f64, SceneError> {
    let mut scene = Scene::new(SceneParams {
        solver: SolverParams {
            iterations,
            ..SolverParams::paper()
        },
        sleep: None,
        ..SceneParams::default()
    });
    for _ in 0..arguments.parameters.bodies {
        scene.add_body(surface.clone(), material)?;
    }
    let budget = Budget {
        warm_up: 0,
        runs: [5, arguments.length.frames.unwrap_or(120)],
        seconds: [arguments.length.seconds.unwrap_or(3.0), f64::INFINITY],
    };
    let times = measure(&budget, |times| times.time(|| scene.step().map(|_| ())))?;
    Ok(times.min())
}
