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
#[derive(Args, Clone, Debug, Serialize)]
struct Parameters {
    /// Copies of the model in the scene.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    bodies: u32,
    /// Iterations per frame.
    #[arg(skip = ITERATIONS)]
    iterations: u32,
}

/// Models that run by default.
const MODELS: [&str; 2] = ["Bunny", "Armadillo"];

/// Iterations per frame; the share that is not projection comes from twice as many.
const ITERATIONS: u32 = 10;

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
    let mut output = Output::open(
        "solver",
        &arguments.output,
        arguments.parameters.clone(),
        out,
    )?;
    let progress = output.progress(workloads.len(), cores as u64);
    for workload in &workloads {
        progress.begin(&workload.name);
        let surface = workload.surface()?;
        let mut one_thread = None;
        for threads in 1..=cores {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()?;
            let times = pool.install(|| Times::measure(&surface, arguments))?;
            let topology = surface.topology();
            // Every edge of a closed surface has a stretch and a bending constraint.
            let edges = topology.edges().count();
            let all = edges as f64 * f64::from(arguments.parameters.bodies);
            let projection = f64::from(ITERATIONS) * times.iteration;
            let row = Row {
                source: workload.source.clone(),
                triangles: topology.triangle_count(),
                edges,
                hinges: edges,
                threads,
                ms_per_frame: times.frame * 1e3,
                speed_up: *one_thread.get_or_insert(times.frame) / times.frame,
                stretch_projections_per_second: all / times.stretch,
                bending_projections_per_second: all / (times.iteration - times.stretch),
                other: (1.0 - projection / times.frame).max(0.0),
            };
            output.cpu_row(&workload.name, &row)?;
            progress.step();
        }
    }
    progress.end();
    Ok(output.table()?)
}

/// Times of a number of threads \[s\].
#[derive(Debug, Clone, Copy)]
struct Times {
    /// A frame.
    frame: f64,
    /// An iteration of stretch and bending.
    iteration: f64,
    /// An iteration of stretch alone.
    stretch: f64,
}

impl Times {
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
        let few = frame(&material, ITERATIONS)?;
        Ok(Self {
            frame: few,
            iteration: per_iteration(few, frame(&material, 2 * ITERATIONS)?),
            stretch: per_iteration(
                frame(&stretch, ITERATIONS)?,
                frame(&stretch, 2 * ITERATIONS)?,
            ),
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
