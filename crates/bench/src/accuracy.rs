//! Work and precision: what a frame costs for a given error, scene by scene.

mod cuts;
#[cfg(feature = "gpu")]
mod device;
#[cfg(not(feature = "gpu"))]
#[path = "accuracy/no_device.rs"]
mod device;
mod dual;
mod error;
mod front;
mod ladder;
mod plot;
mod row;
mod run;
mod scene;
mod scenes;
mod schemes;
mod shapes;
mod substep;
mod table;
#[cfg(test)]
mod tests;

use crate::backend::Executor;
use crate::json::Json;
use crate::machine;
use crate::options::RunArguments;
use crate::output;
use clap::Args;
use device::Device;
use error::Yardstick;
use incise_bench::State;
use incise_mesh::TriangleId;
use incise_pbd_gpu::SolverParams;
use incise_progress::Progress;
use ladder::Ladder;
use plot::PlotFiles;
use row::Row;
use run::Run;
use scene::{Body, DT, Scene, Scheme};
use std::error::Error;
use std::io::Write;
use std::path::PathBuf;

/// Which scenes are stepped and how often.
#[derive(Args, Clone)]
pub(crate) struct AccuracyArguments {
    /// Scenes to run, separated by commas.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = scenes::NAMES)]
    only: Vec<String>,
    #[command(flatten)]
    pub(crate) run: RunArguments,
    /// The most substeps, and the most iterations: powers of two up to that.
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=64))]
    most: u32,
    /// The most iterations a frame, those of all substeps together.
    #[arg(long, value_name = "N", default_value_t = 4096, value_parser = clap::value_parser!(u32).range(1..))]
    most_iterations: u32,
    /// Measure what cuts are off by instead: round bodies against closed forms.
    #[arg(long, conflicts_with_all = ["only", "backend", "adapter", "most", "most_iterations", "plot"])]
    cuts: bool,
    /// Print total errors of ways that the solver has and of ways that it has not, at equal projections, instead.
    #[arg(long, conflicts_with_all = ["backend", "adapter", "most", "most_iterations", "plot", "cuts", "json"])]
    schemes: bool,
    /// Also draw a picture of every scene, as SVG and PNG, with the rows behind it as CSV.
    #[arg(long, value_name = "DIR")]
    plot: Option<PathBuf>,
}

impl AccuracyArguments {
    /// Whether the run is for more files than that of its rows.
    pub(crate) fn writes_more(&self) -> bool {
        self.plot.is_some()
    }
}

/// What all runs have in common.
struct Setup<'a> {
    arguments: &'a AccuracyArguments,
    machine: String,
    commit: String,
    /// None where nothing runs there.
    device: Option<Device>,
}

/// Measures and prints.
pub(crate) fn run(
    arguments: &AccuracyArguments,
    out: &mut impl Write,
) -> Result<(), Box<dyn Error>> {
    let mut json = Json::open(arguments.run.rows.json.as_deref())?;
    let wanted =
        |name: &&str| arguments.only.is_empty() || arguments.only.iter().any(|n| n == name);
    let names = || scenes::NAMES.into_iter().filter(wanted);
    let mut plots = Vec::new();
    if let Some(folder) = &arguments.plot {
        output::folder(folder)?;
        // One picture a backend; with several, their names end with the backend's.
        let backends = arguments.run.backends();
        for name in names() {
            for backend in backends.iter().map(|executor| executor.name()) {
                let file = match backends.len() {
                    1 => name.to_owned(),
                    _ => format!("{name}-{backend}"),
                };
                plots.push(PlotFiles::open(folder, &file, backend)?);
            }
        }
    }
    let mut plots = plots.into_iter();
    let device = match arguments.run.backends().contains(&Executor::Gpu) {
        true => Some(Device::open(arguments.run.gpu.adapter.as_deref())?),
        false => None,
    };
    let mut setup = Setup {
        arguments,
        machine: machine::machine(),
        commit: machine::commit(),
        device,
    };
    writeln!(out, "{}, commit {}", setup.machine, setup.commit)?;
    if arguments.cuts {
        let rows = cuts::run(&setup.machine, &setup.commit, out)?;
        return Ok(json.write(&rows)?);
    }
    writeln!(out, "Errors are of positions, over the mean rest length.")?;
    if let Some(device) = &setup.device {
        writeln!(out, "gpu: {}", device.name())?;
    }
    let mut rows: Vec<Row> = Vec::new();
    let (mut written, mut drawn) = (Ok(()), Ok(()));
    let ways = Scheme::ALL.len() * powers(arguments.most).len() * arguments.run.backends().len();
    let ways = if arguments.schemes { 1 } else { ways };
    let progress = arguments.run.rows.progress(names().count(), ways as u64);
    for name in names() {
        progress.begin(name);
        let scene = scenes::scene(name)?;
        if arguments.schemes {
            let body = scene.body()?;
            let ladder = Ladder::climb(&scene, &body, &[])?;
            let exact = ladder.exact();
            progress.step();
            progress.aside(|| -> Result<(), Box<dyn Error>> {
                table::reference(out, &scene, &body, &ladder, exact.as_ref())?;
                let start = State::of(&body.solver, &body.surface);
                schemes::run(&ladder.model, &start, &exact?.states, out)
            })?;
            continue;
        }
        let first = rows.len();
        setup.measure(&scene, &mut rows, &progress, out)?;
        progress.aside(|| {
            table::scene(out, &rows[first..])?;
            out.flush()
        })?;
        // What cannot be written does not end a run of hours; the next scene's rows bring these along.
        written = json.write(&rows);
        for mut plot in plots.by_ref().take(arguments.run.backends().len()) {
            drawn = drawn.and(plot.draw(name, &rows[first..]));
        }
    }
    progress.end();
    if !arguments.schemes {
        table::summary(out, &rows)?;
    }
    drawn?;
    Ok(written?)
}

/// Powers of two.
fn powers(most: u32) -> Vec<u32> {
    (0..).map(|k| 1 << k).take_while(|&n| n <= most).collect()
}

impl Setup<'_> {
    /// All runs of a scene.
    fn measure(
        &mut self,
        scene: &Scene,
        rows: &mut Vec<Row>,
        progress: &Progress,
        out: &mut impl Write,
    ) -> Result<(), Box<dyn Error>> {
        let body = scene.body()?;
        let numbers = powers(self.arguments.most);
        let ladder = Ladder::climb(scene, &body, &numbers)?;
        let exact = ladder.exact();
        progress.aside(|| {
            table::reference(out, scene, &body, &ladder, exact.as_ref())?;
            out.flush()
        })?;
        let start = State::of(&body.solver, &body.surface);
        let triangles = closed_triangles(&body);
        let yardstick = Yardstick {
            model: &ladder.model,
            triangles: &triangles,
            start: &start,
            is_held: !scene.pins.is_empty(),
        };
        for executor in [Executor::Cpu, Executor::Gpu] {
            if !self.arguments.run.backends().contains(&executor) {
                continue;
            }
            for (scheme, &substeps) in Scheme::ALL
                .into_iter()
                .flat_map(|s| numbers.iter().map(move |n| (s, n)))
            {
                progress.step();
                // A device has no second order.
                if (executor, scheme) == (Executor::Gpu, Scheme::Second) {
                    continue;
                }
                let body = scene.body_by(scheme, f64::from(DT) / f64::from(substeps))?;
                let most = self.arguments.most_iterations;
                let ways: Vec<SolverParams> = (numbers.iter())
                    .take_while(|&&iterations| substeps * iterations <= most)
                    .map(|&iterations| scene.params_by(scheme, substeps, iterations))
                    .collect();
                // They do not depend on who steps, but for rounding.
                let left = match executor {
                    Executor::Cpu => substep::left(&body, &ladder, &ways),
                    Executor::Gpu => None,
                };
                for (way, params) in ways.into_iter().enumerate() {
                    let mut row = self.row(scene, executor, scheme);
                    (row.substeps, row.iterations) = (params.substeps, params.iterations);
                    row.residuals = left.as_ref().map(|all| all[way]);
                    match self.step(executor, &body, &params, scene.frames) {
                        Ok(run) => {
                            row.ms_per_frame = run.seconds * 1e3;
                            row.ms_encode = run.encode.map(|seconds| seconds * 1e3);
                            row.ms_device = run.device.map(|seconds| seconds * 1e3);
                            row.projections_per_frame = run.projections;
                            let states = &run.states;
                            row.solver_error = (ladder.known(scheme, substeps))
                                .map(|reference| yardstick.errors(states, reference));
                            row.total_error = (exact.as_ref().ok())
                                .map(|exact| yardstick.errors(states, &exact.states));
                            row.uncertainty = exact.as_ref().ok().map(|exact| exact.uncertainty);
                        }
                        Err(error) => row.refusal = Some(error),
                    }
                    rows.push(row);
                }
            }
        }
        Ok(())
    }

    fn step(
        &mut self,
        executor: Executor,
        body: &Body,
        params: &SolverParams,
        frames: u32,
    ) -> Result<Run, String> {
        match (executor, &mut self.device) {
            (Executor::Gpu, Some(device)) => device.run(body, params, frames),
            _ => run::on_processor(body, params, frames).map_err(|error| error.to_string()),
        }
    }

    /// A row without numbers.
    fn row(&self, scene: &Scene, executor: Executor, scheme: Scheme) -> Row {
        let (backend, device) = match (executor, &self.device) {
            (Executor::Gpu, Some(device)) => ("gpu", device.name()),
            _ => ("cpu", self.machine.as_str()),
        };
        Row {
            scene: scene.name,
            backend,
            device: device.to_owned(),
            scheme: scheme.name(),
            machine: self.machine.clone(),
            commit: self.commit.clone(),
            version: env!("CARGO_PKG_VERSION"),
            ..Row::default()
        }
    }
}

/// The triangles of a surface without a boundary.
fn closed_triangles(body: &Body) -> Vec<[usize; 3]> {
    let topology = body.surface.topology();
    let is_open = |t: TriangleId| t.half_edges().iter().any(|&h| topology.twin(h).is_null());
    if topology.triangles().any(is_open) {
        return Vec::new();
    }
    let triangles = topology.triangles();
    triangles
        .map(|t| topology.triangle(t).map(|v| v.index()))
        .collect()
}
