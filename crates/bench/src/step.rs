//! `incise-bench step`: the time of a frame on every backend and schedule.

mod case;
#[cfg(feature = "gpu")]
mod device;
#[cfg(not(feature = "gpu"))]
mod device {
    use super::ScheduleChoice;
    use super::case::{Case, CaseRow};
    use incise_pbd_gpu::SolverParams;

    crate::no_gpu::absent_device! {
        describe() -> String;
        calibrate(&SolverParams) -> Result<Option<usize>, String>;
        rows(&Case<'_>, &[ScheduleChoice]) -> Vec<CaseRow>;
    }
}

use crate::measure::Length;
use crate::options::{BackendArguments, LengthArguments, ModelArguments, OutputArguments};
use crate::output::{Origin, Output};
use crate::workload::{Workload, workloads};
use case::{Case, CaseRow, Setup, compare};
use clap::{Args, ValueEnum};
use device::Device;
use incise_pbd_gpu::SolverParams;
use incise_scene::BackendChoice;
use serde::Serialize;
use std::error::Error;
use std::io::{self, Write};

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
#[derive(Args, Clone, Debug, Serialize)]
struct Parameters {
    /// Number of bodies that are stepped together, all of one model.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    bodies: u32,
    /// Solver iterations per substep.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..))]
    iterations: u32,
    /// Substeps per frame.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    substeps: u32,
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
    let parameters = arguments.parameters.clone();
    let setup = Setup {
        params: SolverParams {
            iterations: parameters.iterations,
            substeps: parameters.substeps,
            gravity: [0.0; 3],
            ..SolverParams::paper()
        },
        bodies: parameters.bodies,
        length: match arguments.length.frames {
            Some(frames) => Length::Frames(frames),
            None => Length::Seconds(arguments.length.seconds.unwrap_or(1.0)),
        },
    };
    let mut output = Output::open("step", &arguments.output, parameters, out)?;
    let mut backends = Backends::open(arguments, &setup, &mut output)?;
    let progress = output.progress(workloads.len(), 1);
    for workload in &workloads {
        progress.begin(&workload.name);
        let mut rows = backends.rows(workload, &setup)?;
        compare(&mut rows);
        let machine = output.machine.clone();
        for CaseRow {
            backend,
            device,
            row,
        } in &rows
        {
            let device = device.as_deref().unwrap_or(&machine);
            output.row(&workload.name, Origin { backend, device }, row)?;
        }
        progress.step();
    }
    progress.end();
    Ok(output.table()?)
}

/// The backends that every model runs on.
struct Backends {
    choices: Vec<BackendChoice>,
    device: Option<Device>,
    /// Number of constraints from which [`BackendChoice::Auto`] uses the GPU.
    min_gpu_constraints: Option<usize>,
    schedules: Vec<ScheduleChoice>,
}

impl Backends {
    /// Opens the requested backends and prints their names.
    ///
    /// # Errors
    /// An error when a requested GPU is absent.
    fn open(
        arguments: &StepArguments,
        setup: &Setup,
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
            schedules: arguments.schedule.clone(),
        };
        if backends.choices == [BackendChoice::Cpu] {
            return Ok(backends);
        }
        let adapter = arguments.backends.adapter.as_deref();
        match Device::open(adapter) {
            Ok(device) => {
                output.print(format_args!("gpu: {}", device.describe()))?;
                backends.device = Some(device);
            }
            Err(error) if named.contains(&BackendChoice::Gpu) || adapter.is_some() => {
                return Err(error.into());
            }
            Err(error) => output.print(format_args!("gpu: none: {error}"))?,
        }
        if backends.choices.contains(&BackendChoice::Auto) {
            backends.calibrate(setup, output)?;
        }
        Ok(backends)
    }

    /// Measures from which size on the GPU is faster, and prints it.
    fn calibrate(&mut self, setup: &Setup, output: &mut Output<'_, Parameters>) -> io::Result<()> {
        let Some(device) = &mut self.device else {
            return Ok(());
        };
        match device.calibrate(&setup.params) {
            Ok(Some(count)) => {
                self.min_gpu_constraints = Some(count);
                output.print(format_args!("auto: the GPU from {count} constraints on"))
            }
            Ok(None) => output.print(format_args!("auto: the CPU, which is faster at every size")),
            Err(error) => output.print(format_args!("auto: the CPU: {error}")),
        }
    }

    /// Measures a workload on every backend.
    fn rows(&mut self, workload: &Workload, setup: &Setup) -> Result<Vec<CaseRow>, Box<dyn Error>> {
        let case = Case::new(workload, setup)?;
        let is_large = (self.min_gpu_constraints).is_some_and(|count| case.constraints() >= count);
        let mut rows = Vec::new();
        for &choice in &self.choices {
            let first = rows.len();
            match (choice, &mut self.device) {
                (BackendChoice::Gpu, Some(device)) => {
                    rows.extend(device.rows(&case, &self.schedules))
                }
                (BackendChoice::Gpu, None) => {}
                (BackendChoice::Auto, Some(device)) if is_large => {
                    rows.extend(device.rows(&case, &[ScheduleChoice::Auto]));
                }
                _ => rows.push(case.on_cpu()),
            }
            for row in &mut rows[first..] {
                row.backend = choice.name();
            }
        }
        Ok(rows)
    }
}
