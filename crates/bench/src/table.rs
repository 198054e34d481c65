//! `incise-bench table`: the paper's Table 1 and Figure 11 on seven models.

mod protocol;

use crate::models;
use crate::options::{
    BackendArguments, LengthArguments, MethodArguments, ModelArguments, OutputArguments, positive,
};
use crate::output::Output;
use clap::Args;
use incise_mesh::geometry::round_to_f32;
use incise_models::Model;
use incise_paper::TABLE_1;
use incise_pbd_gpu::SolverParams;
use incise_scene::{BackendChoice, BackendRequest, ContactParams, Scene, SceneError, SceneParams};
use serde::Serialize;
use std::error::Error;
use std::io::Write;

/// Runs the paper's protocol on seven models.
///
/// Frames per second of the solver alone (pbd), and with a moving blade that slices the largest
/// piece once a second (`pbd_cs`). The time of a cut is that of detection, topology, refinement and
/// the update of constraints. `paper` has the paper's numbers, and `gain` the ratios to them, above
/// 1 where incise is better. Stretch errors are means over frames, with edges weighted by length.
/// The volume error is the rest volume lost in all cuts together.
///
/// On a GPU a frame ends when the GPU is done, and the first frame, which compiles kernels, is not
/// timed. Sweeps that miss the body's box are skipped, the time of a cut includes readback and
/// upload, stretch errors are sampled once a second, and allocations include those of the driver.
#[derive(Args, Clone)]
pub(crate) struct TableArguments {
    #[command(flatten)]
    models: ModelArguments,
    #[command(flatten)]
    backends: BackendArguments,
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
    /// Simulated time of a run \[s\].
    #[arg(skip = 15.0)]
    seconds: f64,
    /// Length of a frame in seconds, as a number or a fraction.
    #[arg(long, default_value = "1/60", value_parser = positive)]
    dt: f64,
    /// Solver iterations per frame; 5 project every constraint 10 times, as the paper does.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    iterations: u32,
    #[command(flatten)]
    #[serde(flatten)]
    caps: MethodArguments,
    /// Add volume constraints; the paper's bodies have none.
    #[arg(long)]
    volume: bool,
    /// Add interior springs, one per vertex; the paper's bodies have none.
    #[arg(long)]
    interior_springs: bool,
    /// Resolve contacts between pieces; the paper's pieces pass through each other.
    #[arg(long)]
    contacts: bool,
    /// Seed of the directions of slices.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl Parameters {
    /// Returns the number of frames of a run.
    fn frames(&self) -> u32 {
        nearest(self.seconds / self.dt)
    }

    /// Returns the number of frames of a simulated second.
    fn frames_a_second(&self) -> u32 {
        nearest(1.0 / self.dt).max(1)
    }

    /// Returns the parameters of the scene.
    fn scene(&self) -> SceneParams {
        SceneParams {
            dt: round_to_f32(self.dt),
            solver: SolverParams {
                iterations: self.iterations,
                gravity: [0.0; 3],
                ..SolverParams::paper()
            },
            cut: self.caps.exact(),
            // The paper tests every triangle in every frame.
            skip_far_sweeps: false,
            // Checkpoints would add a readback to timed frames.
            checkpoint: 0,
            contacts: self.contacts.then(ContactParams::default),
            // The paper has no sleep.
            sleep: None,
        }
    }
}

/// Rounds a positive number.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a positive number"
)]
fn nearest(x: f64) -> u32 {
    x.round() as u32
}

/// Runs the protocol on all models, prints and writes the rows.
pub(crate) fn run(arguments: &TableArguments, out: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let mut parameters = arguments.parameters;
    parameters.seconds = match arguments.length.frames {
        Some(frames) => f64::from(frames) * parameters.dt,
        None => arguments.length.seconds.unwrap_or(parameters.seconds),
    };
    let frames = parameters.frames();
    if frames == 0 {
        return Err("the simulated time is shorter than half a frame: raise --seconds".into());
    }
    let loaded = models::load(&arguments.models)?;
    let mut backends = arguments.backends.named();
    if backends.is_empty() {
        backends.push(BackendChoice::Cpu);
    }
    let mut output = Output::open("table", &arguments.output, parameters, out)?;
    output.start(loaded.len() * backends.len(), 2 * u64::from(frames));
    for backend in backends {
        let (request, fallback) = request(&parameters, backend, &arguments.backends)?;
        for model in &loaded {
            let name = model.model.name();
            output.progress.begin(name);
            let tick = || output.progress.step();
            let (gpu, row) = protocol::run(model, &parameters, &request, &tick)?;
            output.set_backend(backend.name(), gpu);
            output.row(name, &row)?;
        }
        if let Some(why) = fallback {
            output.print(format_args!("All on the CPU: {why}."))?;
        }
    }
    Ok(output.table()?)
}

/// Returns the backend of all runs, and the reason for a fallback to the CPU. `auto` is calibrated
/// once, so that all runs use the same backend.
fn request(
    parameters: &Parameters,
    backend: BackendChoice,
    arguments: &BackendArguments,
) -> Result<(BackendRequest, Option<String>), SceneError> {
    let mut request = arguments.request(backend);
    let report = Scene::with_backend(parameters.scene(), &request)?.backend_report();
    request.min_gpu_constraints = report.min_gpu_constraints;
    if report.adapter.is_none() {
        request.choice = BackendChoice::Cpu;
    }
    let why = report.fallback_reason.map(|reason| reason.to_string());
    Ok((request, why))
}

/// One row of the paper's table, or the ratios of another to it.
#[derive(Debug, Serialize)]
struct PaperRow {
    pbd_fps: f64,
    pbd_cs_fps: f64,
    fps_difference_percent: f64,
    cut_ms: f64,
}

impl PaperRow {
    /// Returns the paper's numbers for a model.
    fn of(model: Model) -> Self {
        let row = TABLE_1.iter().find(|row| row.model == model.name());
        let row = row.expect("the table has every model");
        Self {
            pbd_fps: row.pbd_fps,
            pbd_cs_fps: row.pbd_cs_fps,
            fps_difference_percent: row.fps_difference_percent,
            cut_ms: row.cut_ms,
        }
    }

    /// Returns how many times better other numbers are.
    fn gain(&self, other: &Self) -> Self {
        Self {
            pbd_fps: other.pbd_fps / self.pbd_fps,
            pbd_cs_fps: other.pbd_cs_fps / self.pbd_cs_fps,
            fps_difference_percent: self.fps_difference_percent / other.fps_difference_percent,
            cut_ms: self.cut_ms / other.cut_ms,
        }
    }
}
