//! The solver on every backend: how long a frame takes, model by model, and what part of the
//! memory's bandwidth that is.

mod bandwidth;
mod bytes;
mod case;
mod clock;
#[cfg(feature = "gpu")]
mod copies;
mod cpu;
#[cfg(feature = "gpu")]
mod device;
#[cfg(not(feature = "gpu"))]
#[path = "step/no_device.rs"]
mod device;
mod row;
mod stage;
mod subject;
mod table;

use crate::backend::BackendChoice;
use crate::json::Json;
use crate::options::{AdapterArguments, ModelArguments, OutputArguments};
use crate::{columns, machine};
use case::Setup;
use clap::{Args, ValueEnum};
use clock::Budget;
use incise_pbd_gpu::SolverParams;
use stage::Stage;
use std::error::Error;
use std::io::Write;

/// What is stepped, on what and for how long.
#[derive(Args, Clone)]
pub(crate) struct StepArguments {
    #[command(flatten)]
    from: ModelArguments,
    /// Models to run, separated by commas: those of the table, and Sphere3072, Sphere12288,
    /// Sphere49152, Sphere196608, Sphere1002252.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,
    /// What executes the solver, separated by commas: every model runs on each. By default the
    /// processor, and a GPU if there is one.
    #[arg(long, value_enum, value_name = "NAMES", value_delimiter = ',')]
    backend: Vec<BackendChoice>,
    #[command(flatten)]
    gpu: AdapterArguments,
    /// How frames become dispatches on a GPU, separated by commas. By default in every way that a
    /// model fits.
    #[arg(long, value_enum, value_name = "NAMES", value_delimiter = ',')]
    schedule: Vec<ScheduleChoice>,
    /// Iterations of the solver a substep.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..))]
    iterations: u32,
    /// Substeps of a frame.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    substeps: u32,
    /// Leave out larger models.
    #[arg(long, value_name = "N", default_value_t = usize::MAX, hide_default_value = true)]
    max_triangles: usize,
    /// Frames of each measurement.
    #[arg(long, conflicts_with = "seconds_per_row", value_parser = clap::value_parser!(u32).range(1..))]
    frames: Option<u32>,
    /// Seconds of each measurement, about.
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = crate::options::positive)]
    seconds_per_row: f64,
    /// Bodies that are stepped together, all of one model.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    bodies: u32,
    #[command(flatten)]
    pub(crate) rows: OutputArguments,
}

/// How a body's step is cut into dispatches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ScheduleChoice {
    /// The one that the backend takes by itself.
    Auto,
    /// One workgroup a body.
    WholeBody,
    /// One dispatch a color.
    Colors,
    /// One dispatch a layer of patches.
    Patches,
}

#[cfg(feature = "gpu")]
impl ScheduleChoice {
    const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::WholeBody => "whole-body",
            Self::Colors => "colors",
            Self::Patches => "patches",
        }
    }
}

/// Measures and prints.
pub(crate) fn run(arguments: &StepArguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let folder = arguments.from.models.as_deref();
    let subjects = subject::list(folder, &arguments.only, arguments.max_triangles)?;
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
    let mut stage = Stage::open(arguments, &setup, out)?;
    writeln!(
        out,
        "{}, commit {}; iterations {}, substeps {}",
        setup.machine, setup.commit, setup.params.iterations, setup.params.substeps
    )?;
    table::header(out)?;
    let mut rows = Vec::new();
    let progress = arguments.rows.progress(subjects.len(), 1);
    for subject in &subjects {
        progress.begin(&subject.name());
        let mut of_subject = stage.rows(subject, &setup)?;
        row::compare(&mut of_subject);
        progress.aside(|| of_subject.iter().try_for_each(|row| table::row(out, row)))?;
        rows.extend(of_subject);
        progress.step();
        // After every model: what a long run has measured is not lost with it.
        written = json.write(&rows);
    }
    progress.end();
    write!(out, "{}", columns::paragraphs(table::LEGEND))?;
    Ok(written?)
}
