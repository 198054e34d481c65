//! `incise-bench accuracy`: time per frame against error, scene by scene (work-precision fronts).

mod after_cut;
mod cuts;
#[cfg(feature = "gpu")]
mod device;
#[cfg(not(feature = "gpu"))]
mod device {
    use super::run::Run;
    use super::scene::Body;
    use incise_pbd_gpu::SolverParams;

    crate::no_gpu::absent_device! {
        name() -> &str;
        run(&Body, &SolverParams, u32) -> Result<Run, crate::no_gpu::NoGpu>;
    }
}
mod convergence;
mod error;
mod plot;
mod ranks;
mod run;
mod scene;
mod scenes;
mod shapes;
mod table;
#[cfg(test)]
mod tests;

use crate::backend::Executor;
use crate::json::Json;
use crate::machine;
use crate::options::RunArguments;
use crate::output;
use crate::work_precision::Row;
use clap::Args;
use convergence::Convergence;
use device::Device;
use error::ErrorMeasure;
use incise_mesh::TriangleId;
use incise_pbd_gpu::SolverParams;
use incise_progress::Progress;
use incise_reference::State;
use plot::PlotFiles;
use ranks::RanksFile;
use run::Run;
use scene::{Body, DT, Scene, Scheme};
use std::error::Error;
use std::io::Write;
use std::path::PathBuf;

/// Measures time per frame against error.
#[derive(Args, Clone)]
pub(crate) struct AccuracyArguments {
    /// Scenes to run, separated by commas.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = scenes::NAMES)]
    only: Vec<String>,
    #[command(flatten)]
    pub(crate) run: RunArguments,
    /// Largest number of substeps and of iterations; all powers of two up to it run.
    #[arg(
        long,
        value_name = "N",
        default_value_t = 64,
        value_parser = clap::value_parser!(u32).range(1..=64)
    )]
    most: u32,
    /// Largest number of iterations per frame, over all substeps.
    #[arg(
        long,
        value_name = "N",
        default_value_t = 4096,
        value_parser = clap::value_parser!(u32).range(1..)
    )]
    most_iterations: u32,
    /// Measure the error of cuts instead: round bodies against closed forms.
    #[arg(
        long,
        conflicts_with_all = ["only", "backend", "adapter", "most", "most_iterations", "plot"]
    )]
    cuts: bool,
    /// Measure the first frames after a cut instead, against converged steps.
    #[arg(
        long,
        conflicts_with_all = ["cuts", "only", "backend", "adapter", "most", "most_iterations"]
    )]
    after_cut: bool,
    /// Also draw every scene as SVG and PNG, with its rows as CSV; a run of all scenes writes
    /// `ranks.csv`, too.
    #[arg(long, value_name = "DIR")]
    plot: Option<PathBuf>,
}

impl AccuracyArguments {
    /// Returns whether the run writes more files than its rows.
    pub(crate) fn writes_more(&self) -> bool {
        self.plot.is_some()
    }
}

/// The setup that all runs share.
struct Setup<'a> {
    arguments: &'a AccuracyArguments,
    machine: String,
    commit: String,
    /// The GPU; none if no run uses it.
    device: Option<Device>,
}

/// Runs the scenes, prints and writes their rows.
pub(crate) fn run(
    arguments: &AccuracyArguments,
    out: &mut impl Write,
) -> Result<(), Box<dyn Error>> {
    let mut json = Json::open(arguments.run.rows.json.as_deref())?;
    let wanted =
        |name: &&str| arguments.only.is_empty() || arguments.only.iter().any(|n| n == name);
    let names = || scenes::NAMES.into_iter().filter(wanted);
    let (machine, commit) = (machine::machine(), machine::commit());
    if arguments.after_cut || arguments.cuts {
        writeln!(out, "{machine}, commit {commit}")?;
    }
    if arguments.after_cut {
        let rows = after_cut::run((&machine, &commit), arguments.plot.as_deref(), out)?;
        return Ok(json.write(&rows)?);
    }
    if arguments.cuts {
        let rows = cuts::run(&machine, &commit, out)?;
        return Ok(json.write(&rows)?);
    }
    let mut plots = Vec::new();
    let mut ranks_file = None;
    if let Some(folder) = &arguments.plot {
        output::folder(folder)?;
        if arguments.only.is_empty() {
            ranks_file = Some(RanksFile::open(folder)?);
        }
        // One picture per backend; with several, the backend ends the name.
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
        machine,
        commit,
        device,
    };
    writeln!(out, "{}, commit {}", setup.machine, setup.commit)?;
    writeln!(out, "Errors are of positions, over the mean rest length.")?;
    if let Some(device) = &setup.device {
        writeln!(out, "gpu: {}", device.name())?;
    }
    let mut rows: Vec<Row> = Vec::new();
    let (mut written, mut drawn) = (Ok(()), Ok(()));
    let ways = Scheme::ALL.len() * powers(arguments.most).len() * arguments.run.backends().len();
    let progress = arguments.run.rows.progress(names().count(), ways as u64);
    for name in names() {
        progress.begin(name);
        let scene = scenes::scene(name)?;
        let first = rows.len();
        setup.measure(&scene, &mut rows, &progress, out)?;
        progress.suspend(|| {
            table::scene(out, &rows[first..])?;
            out.flush()
        })?;
        // A failed write does not end a run of hours; the next write has these rows too.
        written = json.write(&rows);
        for mut plot in plots.by_ref().take(arguments.run.backends().len()) {
            drawn = drawn.and(plot.draw(name, &rows[first..]));
        }
    }
    progress.end();
    table::summary(out, &rows)?;
    let ranks = ranks::ranks(&rows);
    ranks::print(out, &ranks)?;
    drawn?;
    ranks_file.map_or(Ok(()), |mut file| file.write(&ranks))?;
    Ok(written?)
}

/// Returns the powers of two up to `most`.
fn powers(most: u32) -> Vec<u32> {
    (0..).map(|k| 1 << k).take_while(|&n| n <= most).collect()
}

impl Setup<'_> {
    /// Makes all runs of a scene.
    fn measure(
        &mut self,
        scene: &Scene,
        rows: &mut Vec<Row>,
        progress: &Progress,
        out: &mut impl Write,
    ) -> Result<(), Box<dyn Error>> {
        let body = scene.body()?;
        let numbers = powers(self.arguments.most);
        let convergence = Convergence::compute(scene, &body, &numbers)?;
        let exact = convergence.exact();
        progress.suspend(|| {
            table::reference(out, scene, &body, &convergence, exact.as_ref())?;
            out.flush()
        })?;
        let start = State::of(&body.solver, &body.surface);
        let triangles = closed_triangles(&body);
        let measure = ErrorMeasure {
            model: &convergence.model,
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
                if executor == Executor::Gpu && scheme.is_cpu_only() {
                    continue;
                }
                let body = scene.body_by(scheme, f64::from(DT) / f64::from(substeps))?;
                let most = self.arguments.most_iterations.min(scheme.most_iterations());
                let ways: Vec<SolverParams> = (numbers.iter())
                    .take_while(|&&iterations| substeps * iterations <= most)
                    .map(|&iterations| scene.params_by(scheme, substeps, iterations))
                    .collect();
                for params in ways {
                    let mut row = self.row(scene, executor, scheme);
                    (row.substeps, row.iterations) = (params.substeps, params.iterations);
                    match self.step((executor, scheme), &body, &params, scene.frames) {
                        Ok(run) => {
                            row.ms_per_frame = run.seconds * 1e3;
                            row.ms_encode = run.encode.map(|seconds| seconds * 1e3);
                            row.ms_device = run.device.map(|seconds| seconds * 1e3);
                            row.projections_per_frame = run.projections;
                            let states = &run.states;
                            if let Some(reference) = convergence.known(scheme, substeps) {
                                measure.errors(states, reference).store_solver(&mut row);
                            }
                            if let Ok(exact) = &exact {
                                measure.errors(states, &exact.states).store_total(&mut row);
                                row.uncertainty = Some(exact.uncertainty);
                                row.floor_position = convergence.floor(exact, substeps);
                            }
                        }
                        Err(error) => row.refusal = Some(error.to_string()),
                    }
                    rows.push(row);
                }
            }
        }
        Ok(())
    }

    fn step(
        &mut self,
        (executor, scheme): (Executor, Scheme),
        body: &Body,
        params: &SolverParams,
        frames: u32,
    ) -> Result<Run, Box<dyn Error>> {
        match (executor, &mut self.device) {
            _ if scheme == Scheme::Patches => Ok(run::by_patches(body, params, frames)?),
            (Executor::Gpu, Some(device)) => Ok(device.run(body, params, frames)?),
            _ => Ok(run::on_cpu(body, params, frames)?),
        }
    }

    /// Returns a row without measurements.
    fn row(&self, scene: &Scene, executor: Executor, scheme: Scheme) -> Row {
        let (backend, device) = match (executor, &self.device) {
            (Executor::Gpu, Some(device)) => ("gpu", device.name()),
            _ => ("cpu", self.machine.as_str()),
        };
        Row {
            scene: scene.name.to_owned(),
            backend: backend.to_owned(),
            device: device.to_owned(),
            scheme: scheme.name().to_owned(),
            machine: self.machine.clone(),
            commit: self.commit.clone(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            ..Row::default()
        }
    }
}

/// Returns the triangles of a closed surface, none of an open one.
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
