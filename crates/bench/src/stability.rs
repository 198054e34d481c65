//! `incise-bench stability`: stress cases, with a verdict on each of their invariants.

use crate::models::{files, named};
use crate::options::{BackendArguments, OutputArguments};
use crate::output::Output;
use crate::text_table::number;
use clap::Args;
use incise_mesh::{RepairParams, read_mesh};
use incise_scene::BackendChoice;
use incise_tests::stability::{Case, Runner, Subject, Verdict, cases};
use serde::Serialize;
use std::collections::BTreeMap;
use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::thread;
use std::time::Instant;

/// Runs stress tests of the solver; fails if an invariant does not hold.
///
/// `worst` is the largest value of all runs; a case passes when it is at most the bound. It is none
/// when a run ended in an error or in a position that is not finite. The limits of every motion
/// hold where no unknown work is done: ten times the speed that all of the energy would give the
/// lightest vertex, a stated distance from the origin, a mean strain of 5% after 5 s, 1.01 of the
/// energy.
#[derive(Args, Clone)]
pub(crate) struct StabilityArguments {
    #[command(flatten)]
    backends: BackendArguments,
    /// Cases to run, separated by commas, for example T1,T3,volume.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,
    /// Folder of meshes for the cases over models, instead of the built-in models.
    #[arg(long, value_name = "DIR")]
    models: Option<PathBuf>,
    /// Drops of each model in the case `drop`, at most 800, or runs of each mesh in `still`.
    ///
    /// By default large models have fewer drops, and meshes 24 runs.
    #[arg(long, value_name = "N")]
    samples: Option<u32>,
    /// Only drops whose description, as printed by --list, contains a text.
    #[arg(long, value_name = "TEXT")]
    matching: Option<String>,
    /// Print every run beyond its bound, the worst first.
    #[arg(long)]
    list: bool,
    #[command(flatten)]
    output: OutputArguments,
}

/// The case whose runs `report.py` draws.
const MAP: &str = "map";

/// The verdict on one invariant of a case.
#[derive(Debug, Serialize)]
struct Row<'a> {
    passed: bool,
    bound: f64,
    /// The largest value; none when a run failed.
    worst: Option<f64>,
    runs: usize,
    /// Time of all runs of the case, with its first invariant \[s\].
    seconds: f64,
    stress: &'a str,
    invariant: &'a str,
    /// The run of the largest value, or the error.
    at: &'a str,
}

/// A run of the case `map`: a time step, a compliance and a load, with the largest energy.
#[derive(Debug, Serialize)]
struct Cell<'a> {
    kind: &'static str,
    at: &'a str,
    energy: f64,
    bound: f64,
}

/// Returns the meshes of a folder that can be cut.
fn subjects(folder: &Path) -> Result<Vec<Subject>, Box<dyn Error>> {
    let repairs = RepairParams {
        allow_boundaries: true,
        separate_sheets: true,
    };
    let subject = |path: &PathBuf| {
        let (surface, _) = read_mesh(path).ok()?.repair(repairs).ok()?;
        let name = path.file_name().unwrap_or_default();
        Subject::new(name.to_string_lossy().into_owned(), surface)
    };
    Ok(files(folder)?.iter().filter_map(subject).collect())
}

/// Opens a backend; also returns the description of a GPU.
fn open(
    arguments: &StabilityArguments,
    backend: BackendChoice,
) -> Result<(Runner, Option<String>), Box<dyn Error>> {
    let (mut runner, device) = match backend {
        #[cfg(feature = "gpu")]
        BackendChoice::Gpu => {
            let (runner, device) = Runner::gpu(arguments.backends.adapter.as_deref())?;
            (runner, Some(device))
        }
        #[cfg(not(feature = "gpu"))]
        BackendChoice::Gpu => return Err(crate::gpu::NoGpu.into()),
        _ => (Runner::cpu(), None),
    };
    if let Some(folder) = &arguments.models {
        runner = runner.with_subjects(subjects(folder)?);
    }
    runner.samples = arguments.samples;
    runner.matching.clone_from(&arguments.matching);
    Ok((runner, device))
}

/// Runs the cases, prints and writes their verdicts.
pub(crate) fn run(
    arguments: &StabilityArguments,
    out: &mut dyn Write,
) -> Result<(), Box<dyn Error>> {
    let begin = Instant::now();
    let named = named(cases().collect(), |case| case.id, &arguments.only)?;
    let mut output = Output::open("stability", &arguments.output, (), out)?;
    // The verdicts of the first backend.
    let mut judged = BTreeMap::new();
    let (mut differing, mut failed, mut count) = (Vec::new(), 0, 0);
    for backend in arguments.backends.devices()? {
        let (runner, device) = open(arguments, backend)?;
        output.set_backend(backend.name(), device);
        output.start(named.len(), 1);
        thread::scope(|scope| -> Result<(), Box<dyn Error>> {
            let (send, receive) = mpsc::channel();
            let (named, runner) = (&named, &runner);
            scope.spawn(move || {
                runner.each(named, |case| {
                    let begin = Instant::now();
                    let verdicts = case.verdicts(runner);
                    // A receiver that is gone has no use for verdicts.
                    let _ = send.send((verdicts, begin.elapsed().as_secs_f64()));
                })
            });
            for (verdicts, seconds) in receive {
                output.progress.begin(verdicts[0].case.id);
                let times = std::iter::once(seconds).chain(std::iter::repeat(0.0));
                for (found, own_seconds) in verdicts.iter().zip(times) {
                    let Case { id, stress, .. } = found.case;
                    let (passed, invariant) = (found.passed(), found.invariant);
                    let verdict = if passed { "pass" } else { "FAIL" };
                    output.print(format_args!(
                        "{verdict}  {id} ({seconds:.1} s): {stress}; {invariant}"
                    ))?;
                    write(found, own_seconds, arguments.list, &mut output)?;
                    (count, failed) = (count + 1, failed + u32::from(!passed));
                    if *judged.entry((id, stress, invariant)).or_insert(passed) != passed {
                        differing.push(id);
                    }
                }
                output.progress.step();
            }
            Ok(())
        })?;
    }
    output.table()?;
    // Cases run side by side, so that their times add up to more.
    let seconds = begin.elapsed().as_secs_f64();
    output.print(format_args!(
        "Failed: {failed} of {count} verdicts, in {seconds:.0} s."
    ))?;
    if !differing.is_empty() {
        return Err(format!("backends disagree on {}", differing.join(", ")).into());
    }
    match failed {
        0 => Ok(()),
        _ => Err(format!("{failed} of {count} invariants do not hold").into()),
    }
}

/// Writes the row of a verdict, and the runs of the case that `report.py` draws. Prints each run
/// beyond its bound if asked to.
fn write(
    verdict: &Verdict,
    seconds: f64,
    list: bool,
    output: &mut Output<'_, ()>,
) -> Result<(), Box<dyn Error>> {
    let bound = verdict.bound;
    let Case { id, stress, .. } = verdict.case;
    let row = Row {
        passed: verdict.passed(),
        bound,
        worst: verdict.worst.is_finite().then_some(verdict.worst),
        runs: verdict.runs,
        seconds,
        stress,
        invariant: verdict.invariant,
        at: &verdict.at,
    };
    output.row(id, &row)?;
    for (value, at) in &verdict.all {
        let (kind, energy) = ("cell", *value);
        if list && energy > bound {
            output.print(format_args!("      {}  {at}", number(energy)))?;
        }
        if id == MAP {
            let cell = Cell {
                kind,
                at,
                energy,
                bound,
            };
            output.json_row(id, &cell)?;
        }
    }
    Ok(())
}
