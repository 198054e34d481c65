//! `incise-bench step`: the time of a frame on every backend and schedule.

mod case;
#[cfg(feature = "gpu")]
mod device;
#[cfg(not(feature = "gpu"))]
mod device {
    use super::ScheduleChoice;
    use super::case::Case;
    use super::row::Row;
    use incise_pbd_gpu::SolverParams;

    crate::no_gpu::absent_device! {
        describe() -> String;
        calibrate(&SolverParams) -> Result<Option<usize>, String>;
        rows(&Case<'_>, &[ScheduleChoice]) -> Vec<Row>;
    }
}
pub(crate) mod row;

use crate::backend::BackendChoice;
use crate::clock::Budget;
use crate::json::Json;
use crate::options::{AdapterArguments, ModelArguments, OutputArguments};
use crate::text_table::{paragraphs, text_table};
use crate::workload::{self, Workload};
use crate::{machine, options};
use case::{Case, Setup};
use clap::{Args, ValueEnum};
use device::Device;
use incise_pbd_gpu::SolverParams;
use row::Row;
use std::error::Error;
use std::io::{self, Write};

/// Measures frames of models, finer armadillos and spheres.
#[derive(Args, Clone)]
pub(crate) struct StepArguments {
    #[command(flatten)]
    from: ModelArguments,
    /// Models to step, separated by commas: those of the table, finer armadillos such as
    /// Armadillo120000, and spheres such as Sphere3072.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,
    /// Backends, separated by commas: every model runs on each. The default is the CPU, and a GPU
    /// if there is one.
    #[arg(long, value_enum, value_name = "NAMES", value_delimiter = ',')]
    backend: Vec<BackendChoice>,
    #[command(flatten)]
    gpu: AdapterArguments,
    /// GPU schedules, separated by commas. The default is every schedule that a model fits.
    #[arg(long, value_enum, value_name = "NAMES", value_delimiter = ',')]
    schedule: Vec<ScheduleChoice>,
    /// Solver iterations per substep.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..))]
    iterations: u32,
    /// Substeps per frame.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    substeps: u32,
    /// Omit larger models.
    #[arg(long, value_name = "N", default_value_t = 1_400_000)]
    max_triangles: usize,
    /// Frames per measurement.
    #[arg(
        long,
        conflicts_with = "seconds_per_row",
        value_parser = clap::value_parser!(u32).range(1..)
    )]
    frames: Option<u32>,
    /// Approximate seconds per measurement.
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = options::positive)]
    seconds_per_row: f64,
    /// Number of bodies that are stepped together, all of one model.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    bodies: u32,
    #[command(flatten)]
    pub(crate) rows: OutputArguments,
}

/// The division of a body's step into GPU dispatches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ScheduleChoice {
    /// The schedule that the backend chooses.
    Auto,
    /// One workgroup per body.
    WholeBody,
    /// One dispatch per color.
    Colors,
    /// One dispatch per layer of patches.
    Patches,
}

/// Measures all workloads, prints and writes the rows.
pub(crate) fn run(arguments: &StepArguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let folder = arguments.from.models.as_deref();
    let workloads = workload::workloads(folder, &arguments.only, arguments.max_triangles)?;
    let setup = Setup {
        params: SolverParams {
            iterations: arguments.iterations,
            substeps: arguments.substeps,
            gravity: [0.0; 3],
            ..SolverParams::paper()
        },
        bodies: arguments.bodies,
        budget: match arguments.frames {
            Some(frames) => Budget::Frames(frames),
            None => Budget::Seconds(arguments.seconds_per_row),
        },
        machine: machine::machine(),
        commit: machine::commit(),
    };
    let mut json = Json::open(arguments.rows.json.as_deref())?;
    let mut written = Ok(());
    let mut backends = Backends::open(arguments, &setup, out)?;
    writeln!(
        out,
        "{}, commit {}; iterations {}, substeps {}",
        setup.machine, setup.commit, setup.params.iterations, setup.params.substeps
    )?;
    let mut rows = Vec::new();
    let progress = arguments.rows.progress(workloads.len(), 1);
    for workload in &workloads {
        progress.begin(&workload.name);
        let mut of_workload = backends.rows(workload, &setup)?;
        row::compare(&mut of_workload);
        rows.extend(of_workload);
        progress.step();
        // An interrupted run keeps its rows.
        written = json.write(&rows);
    }
    progress.end();
    write!(out, "{}", text_table(row::COLUMNS, &rows))?;
    write!(out, "{}", paragraphs(row::LEGEND))?;
    Ok(written?)
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
        out: &mut impl Write,
    ) -> Result<Self, Box<dyn Error>> {
        let asked = match arguments.backend.as_slice() {
            [] => &[BackendChoice::Cpu, BackendChoice::Gpu][..],
            asked => asked,
        };
        let all = [BackendChoice::Cpu, BackendChoice::Gpu, BackendChoice::Auto];
        let mut backends = Self {
            choices: all.into_iter().filter(|c| asked.contains(c)).collect(),
            device: None,
            min_gpu_constraints: None,
            schedules: arguments.schedule.clone(),
        };
        if asked == [BackendChoice::Cpu] {
            return Ok(backends);
        }
        match Device::open(arguments.gpu.adapter.as_deref()) {
            Ok(device) => {
                writeln!(out, "gpu: {}", device.describe())?;
                backends.device = Some(device);
            }
            Err(error) => {
                let is_required = arguments.backend.contains(&BackendChoice::Gpu);
                if is_required || arguments.gpu.adapter.is_some() {
                    return Err(error.into());
                }
                writeln!(out, "gpu: none: {error}")?;
            }
        }
        if asked.contains(&BackendChoice::Auto) {
            backends.calibrate(setup, out)?;
        }
        Ok(backends)
    }

    /// Measures from which size on the GPU is faster, and prints it.
    fn calibrate(&mut self, setup: &Setup, out: &mut impl Write) -> io::Result<()> {
        let Some(device) = &mut self.device else {
            return Ok(());
        };
        match device.calibrate(&setup.params) {
            Ok(Some(count)) => {
                writeln!(out, "auto: the GPU from {count} constraints on")?;
                self.min_gpu_constraints = Some(count);
            }
            Ok(None) => writeln!(out, "auto: the CPU, which is faster at every size")?,
            Err(error) => writeln!(out, "auto: the CPU: {error}")?,
        }
        Ok(())
    }

    /// Measures a workload on every backend.
    fn rows(&mut self, workload: &Workload, setup: &Setup) -> Result<Vec<Row>, Box<dyn Error>> {
        let case = Case::new(workload, setup)?;
        let is_large = (self.min_gpu_constraints).is_some_and(|count| case.constraints() >= count);
        let mut rows = Vec::new();
        for &choice in &self.choices {
            let first = rows.len();
            match (choice, &mut self.device) {
                (BackendChoice::Gpu, Some(device)) => {
                    rows.extend(device.rows(&case, &self.schedules));
                }
                (BackendChoice::Gpu, None) => {}
                (BackendChoice::Auto, Some(device)) if is_large => {
                    rows.extend(device.rows(&case, &[ScheduleChoice::Auto]));
                }
                _ => rows.push(case.on_cpu()),
            }
            for row in &mut rows[first..] {
                row.backend = choice.name().to_owned();
            }
        }
        Ok(rows)
    }
}
