//! `incise-bench accuracy`: time per frame against error, scene by scene (work-precision fronts).

mod convergence;
mod cuts;
mod error;
mod run;
mod scene;
mod scenes;
#[cfg(test)]
mod tests;

use crate::gpu::Device;
use crate::models::named;
use crate::motion::DT;
use crate::options::{BackendArguments, OutputArguments};
use crate::output::Output;
use clap::{Args, ValueEnum};
use convergence::{Convergence, Exact, FLOOR_SUBSTEPS};
use error::Errors;
use incise_pbd_gpu::SolverParams;
use incise_reference::ReferenceError;
use incise_scene::BackendChoice;
use run::Run;
use scene::{Scene, Scheme};
use serde::Serialize;
use std::collections::BTreeMap;
use std::error::Error;
use std::io::Write;

/// Measures time per frame against error.
///
/// Rows are runs with a scheme, a number of substeps and one of iterations; printed are those of
/// the Pareto front of time and total position error. `solver` are errors to the converged implicit
/// step of the same size, `total` to the limit of small steps: position (root mean square over
/// vertices and frames, over the mean rest length), largest vertex error, relative force on the
/// pins, root mean square strain, largest strain, volume, energy per second over the largest
/// kinetic energy, sag. Total errors below ten times `uncertainty` are uncertain. `floor_position`
/// is the error of converged second-order steps of the same size. `report.py` draws the fronts.
#[derive(Args, Clone)]
pub(crate) struct AccuracyArguments {
    /// Scenes to run, separated by commas.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = scenes::NAMES)]
    only: Vec<String>,
    #[command(flatten)]
    backends: BackendArguments,
    /// Largest number of substeps and of iterations.
    ///
    /// All powers of two up to it run, and the default number of substeps.
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
        conflicts_with_all = ["only", "backend", "adapter", "most", "most_iterations"]
    )]
    cuts: bool,
    #[command(flatten)]
    output: OutputArguments,
}

/// The output of the bench.
type AccuracyOutput<'a> = Output<'a, ()>;

/// A run of a scene with one scheme, number of substeps and of iterations.
#[derive(Debug, Serialize)]
struct Row {
    kind: &'static str,
    scheme: Scheme,
    substeps: u32,
    iterations: u32,
    #[serde(flatten)]
    found: Found,
    /// The error of the run, if it failed.
    refusal: Option<String>,
}

/// Time and errors of a run.
#[derive(Debug, Default, Serialize)]
struct Found {
    /// Median time of a frame until the backend is done.
    ms_per_frame: Option<f64>,
    /// Median time to encode a frame; none on the CPU.
    ms_encode: Option<f64>,
    /// Median GPU time by timestamps; none on the CPU and on devices without timestamps.
    ms_device: Option<f64>,
    projections_per_frame: u64,
    /// Errors to the converged implicit step of the same size.
    solver: Option<Errors>,
    /// Errors to the limit of small steps.
    total: Option<Errors>,
    /// Estimated error of the limit; total errors below ten times of it are uncertain.
    uncertainty: Option<f64>,
    /// Position error to the limit of a converged second-order step of the same size: no solver of
    /// such steps can have a smaller one but by chance.
    floor_position: Option<f64>,
}

impl Found {
    /// Returns time \[ms\] and total position error.
    fn point(&self) -> Option<[f64; 2]> {
        Some([self.ms_per_frame?, self.total?.position])
    }
}

/// The reference of a scene.
#[derive(Debug, Serialize)]
struct ReferenceRow {
    kind: &'static str,
    triangles: usize,
    vertices: usize,
    pins: usize,
    frames: u32,
    /// Time of all reference motions.
    seconds: f64,
    uncertainty: Option<f64>,
    /// Error of converged second-order steps, by [`FLOOR_SUBSTEPS`].
    floors: BTreeMap<u32, Option<f64>>,
    /// Largest way of a vertex along gravity \[m\]; none without pins or gravity.
    sag: Option<f64>,
    /// The error of the reference, without which there are no total errors.
    refusal: Option<String>,
}

/// Runs the scenes, prints and writes their rows.
pub(crate) fn run(
    arguments: &AccuracyArguments,
    out: &mut dyn Write,
) -> Result<(), Box<dyn Error>> {
    let mut output = Output::open("accuracy", &arguments.output, (), out)?;
    if arguments.cuts {
        return cuts::run(&mut output);
    }
    let backends = arguments.backends.devices()?;
    let mut device = match backends.contains(&BackendChoice::Gpu) {
        true => Some(Device::open(arguments.backends.adapter.as_deref())?),
        false => None,
    };
    let names = named(scenes::NAMES.to_vec(), |name| name, &arguments.only)?;
    let ways =
        Scheme::value_variants().len() * substep_counts(arguments.most).len() * backends.len();
    output.start(names.len(), ways as u64);
    for name in names {
        output.progress.begin(name);
        output.set_backend("cpu", None);
        let runs = SceneRuns::new(arguments, name, &mut output)?;
        output.table()?;
        for &backend in &backends {
            let device = device.as_mut().filter(|_| backend == BackendChoice::Gpu);
            let points = runs.measure(device, &mut output)?;
            let front = pareto_front(&points);
            output.table_of(|i| front.contains(&i))?;
        }
    }
    Ok(())
}

/// Returns the powers of two up to `most`.
fn powers(most: u32) -> Vec<u32> {
    (0..).map(|k| 1 << k).take_while(|&n| n <= most).collect()
}

/// Returns the numbers of substeps up to `most` that run: powers of two, and the default.
fn substep_counts(most: u32) -> Vec<u32> {
    let mut counts = powers(most);
    counts.push(SolverParams::default().substeps(DT));
    counts.retain(|&n| n <= most);
    counts.sort_unstable();
    counts.dedup();
    counts
}

/// Returns the points that no other is both faster and more accurate than, by time.
fn pareto_front(points: &[Option<[f64; 2]>]) -> Vec<usize> {
    let is_finite = |p: &[f64; 2]| p.iter().all(|x| x.is_finite());
    let known = (0..)
        .zip(points)
        .filter_map(|(i, p)| Some((i, p.filter(is_finite)?)));
    let mut known: Vec<(usize, [f64; 2])> = known.collect();
    known.sort_by(|(_, a), (_, b)| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut best = f64::INFINITY;
    known.retain(|(_, p)| {
        let is_better = p[1] < best;
        best = best.min(p[1]);
        is_better
    });
    known.into_iter().map(|(i, _)| i).collect()
}

/// A scene with its reference, for runs on every backend.
struct SceneRuns<'a> {
    arguments: &'a AccuracyArguments,
    scene: Scene,
    convergence: Convergence,
    exact: Result<Exact, ReferenceError>,
}

impl<'a> SceneRuns<'a> {
    /// Computes the reference of a scene and writes its row.
    fn new(
        arguments: &'a AccuracyArguments,
        name: &'static str,
        output: &mut AccuracyOutput<'_>,
    ) -> Result<Self, Box<dyn Error>> {
        let scene = scenes::scene(name)?;
        let body = scene.body()?;
        let convergence = Convergence::compute(&scene, &body, &powers(arguments.most))?;
        let exact = convergence.exact();
        let (topology, known) = (body.surface.topology(), exact.as_ref().ok());
        let row = ReferenceRow {
            kind: "reference",
            triangles: topology.triangle_count(),
            vertices: topology.vertex_count(),
            pins: body.solver.pins().len(),
            frames: scene.frames,
            seconds: convergence.seconds,
            uncertainty: known.map(|exact| exact.uncertainty),
            floors: FLOOR_SUBSTEPS
                .map(|n| (n, known.and_then(|exact| convergence.floor(exact, n))))
                .into(),
            sag: known.and_then(|exact| convergence.measure.sag(&exact.states)),
            refusal: exact.as_ref().err().map(ReferenceError::to_string),
        };
        output.row(name, &row)?;
        Ok(Self {
            arguments,
            scene,
            convergence,
            exact,
        })
    }

    /// Makes all runs on a GPU, or on the CPU; returns their times and total errors.
    fn measure(
        &self,
        mut device: Option<&mut Device>,
        output: &mut AccuracyOutput<'_>,
    ) -> Result<Vec<Option<[f64; 2]>>, Box<dyn Error>> {
        let scene = &self.scene;
        match &device {
            Some(device) => output.set_backend("gpu", Some(device.name())),
            None => output.set_backend("cpu", None),
        }
        let (numbers, counts) = (
            powers(self.arguments.most),
            substep_counts(self.arguments.most),
        );
        let schemes = Scheme::value_variants().iter();
        let both = schemes.flat_map(|scheme| counts.iter().map(move |n| (*scheme, *n)));
        let mut points = Vec::new();
        for (scheme, substeps) in both {
            output.progress.step();
            if device.is_some() && !scheme.is_on_gpu() {
                continue;
            }
            let body = scene.body_by(scheme, f64::from(DT) / f64::from(substeps))?;
            let most = (self.arguments.most_iterations).min(scheme.most_iterations());
            let ways = numbers.iter().copied();
            for iterations in ways.take_while(|iterations| substeps * iterations <= most) {
                let params = scene.params_by(scheme, substeps, iterations);
                let frames = scene.frames;
                let run: Result<Run, Box<dyn Error>> = match &mut device {
                    _ if scheme == Scheme::Patches => {
                        run::by_patches(&body, &params, frames).map_err(Into::into)
                    }
                    Some(gpu) => run::on_gpu(gpu, &body, &params, frames).map_err(Into::into),
                    None => run::on_cpu(&body, &params, frames).map_err(Into::into),
                };
                let (found, refusal) = match run {
                    Ok(run) => (self.found(&run, scheme, substeps), None),
                    Err(error) => (Found::default(), Some(error.to_string())),
                };
                points.push(found.point());
                let row = Row {
                    kind: "run",
                    scheme,
                    substeps,
                    iterations,
                    found,
                    refusal,
                };
                output.row(scene.name, &row)?;
            }
        }
        Ok(points)
    }

    /// Compares a run with the reference.
    fn found(&self, run: &Run, scheme: Scheme, substeps: u32) -> Found {
        let measure = &self.convergence.measure;
        let solver = self.convergence.known(scheme.integrator(), substeps);
        let exact = self.exact.as_ref().ok();
        Found {
            ms_per_frame: run.frames.median_ms(),
            ms_encode: run.encode.median_ms(),
            ms_device: run.device.median_ms(),
            projections_per_frame: run.projections,
            solver: solver.map(|reference| measure.errors(&run.states, reference)),
            total: exact.map(|exact| measure.errors(&run.states, &exact.states)),
            uncertainty: exact.map(|exact| exact.uncertainty),
            floor_position: exact.and_then(|exact| self.convergence.floor(exact, substeps)),
        }
    }
}
