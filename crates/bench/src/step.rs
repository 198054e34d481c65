//! `incise-bench step`: the time of a frame on every backend and schedule.

#[cfg(feature = "gpu")]
mod device;
#[cfg(not(feature = "gpu"))]
mod device {
    use super::{Case, Device, Row, ScheduleChoice, SolverParams};

    pub(super) fn describe(device: &Device) -> String {
        match *device {}
    }

    pub(super) fn calibrate(
        device: &mut Device,
        _: &SolverParams,
    ) -> Result<Option<usize>, String> {
        match *device {}
    }

    pub(super) fn rows(device: &mut Device, _: &Case<'_>, _: &[ScheduleChoice]) -> Vec<Row> {
        match *device {}
    }
}

use crate::gpu::Device;
use crate::measure::{FrameTimes, Length, measure_frames};
use crate::motion::{self, Body, DT};
use crate::options::{BackendArguments, LengthArguments, ModelArguments, OutputArguments};
use crate::output::Output;
use crate::workload::{Workload, workloads};
use clap::{Args, ValueEnum};
#[cfg(feature = "gpu")]
use incise_pbd_gpu::PatchParams;
use incise_pbd_gpu::{Solver, SolverParams, StepError};
use incise_scene::BackendChoice;
use serde::Serialize;
use std::error::Error;
use std::io::Write;

/// Measures frames of models, finer armadillos and spheres.
///
/// Weightless bodies spin and are squeezed. A GPU gets a batch of frames and is waited for at its
/// end; `ms_per_frame` is the median over batches, `ms_latency` the time of a frame that is waited
/// for. Projections are those of stretch and bending constraints. `chosen` marks the schedule that
/// the backend chooses.
#[derive(Args, Clone)]
pub(crate) struct StepArguments {
    #[command(flatten)]
    models: ModelArguments,
    #[command(flatten)]
    backends: BackendArguments,
    #[command(flatten)]
    length: LengthArguments,
    /// GPU schedules, separated by commas. The default is every schedule that a model fits.
    #[arg(long, value_enum, value_name = "NAMES", value_delimiter = ',')]
    schedule: Vec<ScheduleChoice>,
    #[command(flatten)]
    parameters: Parameters,
    /// Omit larger models.
    #[arg(long, value_name = "N", default_value_t = 1_400_000)]
    max_triangles: usize,
    #[command(flatten)]
    output: OutputArguments,
}

/// The parameters of all rows.
#[derive(Args, Clone, Copy, Debug, Serialize)]
struct Parameters {
    /// Number of bodies that are stepped together, all of one model.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    bodies: u32,
    /// Solver iterations per substep.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    iterations: u32,
    /// Substeps per frame.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    substeps: u32,
}

impl Parameters {
    fn solver(&self) -> SolverParams {
        SolverParams {
            iterations: self.iterations,
            gravity: [0.0; 3],
            ..SolverParams::paper()
        }
        .with_substeps(DT, self.substeps)
    }
}

/// The division of a body's step into GPU dispatches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ScheduleChoice {
    /// The schedule that the backend chooses.
    Auto,
    /// One workgroup per body.
    WholeBody,
    /// One dispatch per layer of patches, and per color between them.
    Patches,
}

/// Measures all workloads, prints and writes the rows.
pub(crate) fn run(arguments: &StepArguments, out: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let workloads = workloads(&arguments.models, arguments.max_triangles)?;
    let parameters = arguments.parameters;
    let length = match arguments.length.frames {
        Some(frames) => Length::Frames(frames),
        None => Length::Seconds(arguments.length.seconds.unwrap_or(1.0)),
    };
    let mut output = Output::open("step", &arguments.output, parameters, out)?;
    let mut backends = Backends::open(arguments, &mut output)?;
    output.start(workloads.len(), 1);
    for workload in &workloads {
        output.progress.begin(&workload.name);
        let mut rows = backends.rows(&Case::new(workload, parameters, length)?);
        compare(&mut rows);
        for row in rows {
            output.set_backend(row.backend, row.gpu.clone());
            output.row(&workload.name, &row)?;
        }
        output.progress.step();
    }
    Ok(output.table()?)
}

/// The backends that every model runs on.
struct Backends<'a> {
    choices: Vec<BackendChoice>,
    device: Option<Device>,
    /// Number of constraints from which [`BackendChoice::Auto`] uses the GPU.
    min_gpu_constraints: Option<usize>,
    schedules: &'a [ScheduleChoice],
}

impl<'a> Backends<'a> {
    /// Opens the requested backends and prints their names. For [`BackendChoice::Auto`] it measures
    /// from which size on the GPU is faster.
    ///
    /// # Errors
    /// An error when a requested GPU is absent.
    fn open(
        arguments: &'a StepArguments,
        output: &mut Output<'_, Parameters>,
    ) -> Result<Self, Box<dyn Error>> {
        let named = arguments.backends.named();
        let mut backends = Self {
            choices: match named.is_empty() {
                true => vec![BackendChoice::Cpu, BackendChoice::Gpu],
                false => named.clone(),
            },
            device: None,
            min_gpu_constraints: None,
            schedules: &arguments.schedule,
        };
        if backends.choices == [BackendChoice::Cpu] {
            return Ok(backends);
        }
        let adapter = arguments.backends.adapter.as_deref();
        let mut device = match Device::open(adapter) {
            Ok(device) => device,
            Err(error) if named.contains(&BackendChoice::Gpu) || adapter.is_some() => {
                return Err(error.into());
            }
            Err(error) => {
                output.print(format_args!("gpu: none: {error}"))?;
                return Ok(backends);
            }
        };
        output.print(format_args!("gpu: {}", device::describe(&device)))?;
        if backends.choices.contains(&BackendChoice::Auto) {
            let measured = device::calibrate(&mut device, &arguments.parameters.solver());
            backends.min_gpu_constraints = measured.clone().unwrap_or(None);
            match measured {
                Ok(Some(n)) => output.print(format_args!("auto: the GPU from {n} constraints on")),
                Ok(None) => {
                    output.print(format_args!("auto: the CPU, which is faster at every size"))
                }
                Err(error) => output.print(format_args!("auto: the CPU: {error}")),
            }?;
        }
        backends.device = Some(device);
        Ok(backends)
    }

    /// Measures a case on every backend.
    fn rows(&mut self, case: &Case<'_>) -> Vec<Row> {
        let is_large = (self.min_gpu_constraints).is_some_and(|count| case.constraints() >= count);
        let mut rows = Vec::new();
        for &choice in &self.choices {
            let first = rows.len();
            match (choice, &mut self.device) {
                (BackendChoice::Gpu, Some(device)) => {
                    rows.extend(device::rows(device, case, self.schedules));
                }
                (BackendChoice::Gpu, None) => {}
                (BackendChoice::Auto, Some(device)) if is_large => {
                    rows.extend(device::rows(device, case, &[ScheduleChoice::Auto]));
                }
                _ => rows.push(case.on_cpu()),
            }
            for row in &mut rows[first..] {
                row.backend = choice.name();
            }
        }
        rows
    }
}

/// A workload with its solver.
struct Case<'a> {
    workload: &'a Workload,
    parameters: Parameters,
    length: Length,
    body: Body,
}

/// Frames of a model on one backend and schedule.
#[derive(Debug, Clone, Serialize)]
struct Row {
    #[serde(skip)]
    backend: &'static str,
    /// Name of the GPU; none on the CPU.
    #[serde(skip)]
    gpu: Option<String>,
    source: String,
    /// Of one body, like vertices and constraints.
    triangles: usize,
    vertices: usize,
    constraints: usize,
    /// Driver of the GPU; none on the CPU.
    driver: Option<String>,
    /// GPU schedule; `colors` on the CPU.
    schedule: &'static str,
    /// Whether the backend chooses this schedule.
    chosen: bool,
    /// None for a refusal.
    #[serde(flatten)]
    measured: Option<Measured>,
    /// The error of a measurement.
    refusal: Option<String>,
}

/// Measurements of all bodies together.
#[derive(Debug, Clone, Serialize)]
struct Measured {
    /// Dispatches of a frame; none on the CPU.
    dispatches: Option<u32>,
    #[serde(flatten)]
    times: FrameTimes,
    projections_per_second: f64,
    /// Upload of a frame without edits.
    bytes_uploaded: u64,
    /// Upload before the first frame.
    bytes_uploaded_at_start: u64,
    /// Time of the CPU over this time.
    speed_up_over_cpu: Option<f64>,
}

/// Sets the speed-ups of one model's rows.
fn compare(rows: &mut [Row]) {
    let cpu = rows.iter().find(|row| row.backend == "cpu");
    let cpu = cpu.and_then(|row| Some(row.measured.as_ref()?.times.ms_per_frame));
    for row in rows.iter_mut().filter(|row| row.gpu.is_some()) {
        if let Some(measured) = &mut row.measured {
            measured.speed_up_over_cpu = cpu.map(|ms| ms / measured.times.ms_per_frame);
        }
    }
}

impl<'a> Case<'a> {
    fn new(
        workload: &'a Workload,
        parameters: Parameters,
        length: Length,
    ) -> Result<Self, Box<dyn Error>> {
        let material = motion::material();
        let new_solver = |surface: &mut _| Solver::new(surface, &material);
        Ok(Self {
            workload,
            parameters,
            length,
            body: Body::moving(workload.surface()?, new_solver)?,
        })
    }

    /// Returns the bodies at their start.
    fn bodies(&self) -> Vec<Body> {
        vec![self.body.clone(); self.parameters.bodies as usize]
    }

    /// Returns the bodies at their start, divided into patches or undivided.
    #[cfg(feature = "gpu")]
    fn divided_bodies(&self, patches: Option<&PatchParams>) -> Result<Vec<Body>, Box<dyn Error>> {
        let material = motion::material();
        let new_solver = |surface: &mut _| Solver::with_patches(surface, &material, patches);
        let body = Body::moving(self.workload.surface()?, new_solver)?;
        Ok(vec![body; self.parameters.bodies as usize])
    }

    /// Returns the number of constraints of one body.
    fn constraints(&self) -> usize {
        let solver = &self.body.solver;
        solver.stretch().len() + solver.bending().map_or(0, |set| set.len())
    }

    /// Returns the measurements that follow from times alone.
    fn measured(&self, times: FrameTimes) -> Measured {
        let Parameters {
            bodies,
            iterations,
            substeps,
        } = self.parameters;
        // An iteration projects forward and back.
        let rounds = 2 * u64::from(substeps) * u64::from(iterations) * u64::from(bodies);
        let projections = rounds * self.constraints() as u64;
        Measured {
            dispatches: None,
            projections_per_second: projections as f64 * times.frames_per_second,
            times,
            bytes_uploaded: 0,
            bytes_uploaded_at_start: 0,
            speed_up_over_cpu: None,
        }
    }

    /// Returns a row as of the CPU; the error of a measurement becomes its refusal.
    fn row(&self, measured: Result<Measured, String>) -> Row {
        let (measured, refusal) = match measured {
            Ok(measured) => (Some(measured), None),
            Err(error) => (None, Some(error)),
        };
        let topology = self.body.surface.topology();
        Row {
            backend: "cpu",
            gpu: None,
            source: self.workload.source.clone(),
            triangles: topology.triangle_count(),
            vertices: topology.vertex_count(),
            constraints: self.constraints(),
            driver: None,
            schedule: "colors",
            chosen: true,
            measured,
            refusal,
        }
    }

    /// Measures the workload on the CPU.
    fn on_cpu(&self) -> Row {
        let mut bodies = self.bodies();
        let params = self.parameters.solver();
        let times = measure_frames(self.length, |frames| {
            for _ in 0..frames {
                for Body { surface, solver } in &mut bodies {
                    solver.step(surface, DT, &params)?;
                }
            }
            Ok::<(), StepError>(())
        });
        let measured = times.map(|times| self.measured(times));
        self.row(measured.map_err(|error| error.to_string()))
    }
}
