//! `incise-bench solver`: projections per second by kind and number of threads, and the share of a
//! frame that is not projection.

use crate::json::Json;
use crate::numbers::fixed;
use crate::options::{ModelArguments, OutputArguments};
use crate::text_table::{Column, paragraphs, text_table};
use crate::workload::{Workload, workloads};
use crate::{machine, motion};
use clap::Args;
use incise_mesh::Surface;
use incise_pbd_gpu::{Material, SolverParams};
use incise_scene::{Scene, SceneError, SceneParams};
use serde::Serialize;
use std::error::Error;
use std::io::Write;
use std::time::{Duration, Instant};

/// Measures the solver alone.
#[derive(Args, Clone)]
pub(crate) struct SolverArguments {
    #[command(flatten)]
    from: ModelArguments,
    /// Models to run, separated by commas; `Sphere1306800` has 1.3 million triangles.
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        default_value = "Bunny,Armadillo"
    )]
    only: Vec<String>,
    /// Copies of the model in the scene.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    bodies: u32,
    /// Maximum number of frames per measurement; the fastest counts.
    #[arg(long, default_value_t = 120, value_parser = clap::value_parser!(u32).range(1..))]
    frames: u32,
    #[command(flatten)]
    pub(crate) rows: OutputArguments,
}

/// Iterations per frame; the share that is not projection comes from twice as many.
const ITERATIONS: u32 = 10;

/// Triangles of the largest model.
const MAX_TRIANGLES: usize = 2_000_000;

/// Time after which a measurement ends, with 5 frames or more.
const MAX_TIME: Duration = Duration::from_secs(3);

/// A row of the table and of the JSON.
#[derive(Debug, Serialize)]
struct Row {
    model: String,
    source: String,
    /// Of one body, like edges and hinges.
    triangles: usize,
    edges: usize,
    hinges: usize,
    bodies: u32,
    iterations: u32,
    threads: usize,
    ms_per_frame: f64,
    /// Time of one thread over this time.
    speed_up: f64,
    stretch_projections_per_second: f64,
    bending_projections_per_second: f64,
    /// Share of a frame that is not projection, 0 to 1.
    other: f64,
    machine: String,
    commit: String,
}

const COLUMNS: &[Column<Row>] = &[
    ("model", |row| row.model.clone()),
    ("triangles", |row| row.triangles.to_string()),
    ("bodies", |row| row.bodies.to_string()),
    ("threads", |row| row.threads.to_string()),
    ("ms", |row| fixed(row.ms_per_frame, 3)),
    ("x", |row| fixed(row.speed_up, 2)),
    ("stretch M/s", |row| {
        fixed(row.stretch_projections_per_second / 1e6, 0)
    }),
    ("bending M/s", |row| {
        fixed(row.bending_projections_per_second / 1e6, 0)
    }),
    ("other %", |row| fixed(100.0 * row.other, 1)),
    ("source", |row| row.source.clone()),
];

const LEGEND: &str = "\
Bodies fall freely. ms: the fastest frame. x: speed relative to one thread. M/s: millions of \
projections per second of all threads, from frames of twice as many iterations and of stretch \
alone. other %: share of a frame that is not projection.";

/// Measures all models, prints and writes the rows.
pub(crate) fn run(arguments: &SolverArguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let (machine, commit) = (machine::machine(), machine::commit());
    let mut json = Json::open(arguments.rows.json.as_deref())?;
    let folder = arguments.from.models.as_deref();
    let workloads = workloads(folder, &arguments.only, MAX_TRIANGLES)?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut rows: Vec<Row> = Vec::new();
    let progress = arguments.rows.progress(workloads.len(), cores as u64);
    for workload in &workloads {
        progress.begin(&workload.name);
        let surface = workload.surface()?;
        let mut one_thread = None;
        for threads in 1..=cores {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()?;
            let times = pool.install(|| Times::measure(&surface, arguments))?;
            let one_thread = *one_thread.get_or_insert(times.frame);
            rows.push(times.row(workload, &surface, arguments, threads, one_thread));
            progress.step();
        }
    }
    progress.end();
    for row in &mut rows {
        (row.machine, row.commit) = (machine.clone(), commit.clone());
    }
    write!(out, "{}", text_table(COLUMNS, &rows))?;
    writeln!(out, "\n{machine}, commit {commit}; {ITERATIONS} iterations")?;
    write!(out, "{}", paragraphs(LEGEND))?;
    Ok(json.write(&rows)?)
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

    #[expect(
        clippy::cast_precision_loss,
        reason = "a frame has far fewer than 2^53 projections"
    )]
    fn row(
        self,
        workload: &Workload,
        surface: &Surface,
        arguments: &SolverArguments,
        threads: usize,
        one_thread: f64,
    ) -> Row {
        let topology = surface.topology();
        // Every edge of a closed surface has a stretch and a bending constraint.
        let edges = topology.edges().count();
        let all = edges as f64 * f64::from(arguments.bodies);
        Row {
            model: workload.name.clone(),
            source: workload.source.clone(),
            triangles: topology.triangle_count(),
            edges,
            hinges: edges,
            bodies: arguments.bodies,
            iterations: ITERATIONS,
            threads,
            ms_per_frame: self.frame * 1e3,
            speed_up: one_thread / self.frame,
            stretch_projections_per_second: all / self.stretch,
            bending_projections_per_second: all / (self.iteration - self.stretch),
            other: (1.0 - f64::from(ITERATIONS) * self.iteration / self.frame).max(0.0),
            machine: String::new(),
            commit: String::new(),
        }
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
    for _ in 0..arguments.bodies {
        scene.add_body(surface.clone(), material)?;
    }
    let begin = Instant::now();
    let mut fastest = f64::INFINITY;
    for frame in 0..arguments.frames {
        if frame >= 5 && begin.elapsed() > MAX_TIME {
            break;
        }
        let start = Instant::now();
        scene.step()?;
        fastest = fastest.min(start.elapsed().as_secs_f64());
    }
    Ok(fastest)
}
