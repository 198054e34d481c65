//! `incise-bench stability`: stress tests that take minutes or fail today.
//!
//! Each has an invariant and the worst value found. Short ones that hold are tests of the crates.

mod bars;
mod case;
mod closing;
mod constraint_order;
mod contacts;
mod cuts;
#[cfg(feature = "gpu")]
mod device;
#[cfg(not(feature = "gpu"))]
mod device {
    use super::error::StressError;
    use incise_mesh::Surface;
    use incise_pbd_gpu::{Solver, SolverParams};
    use incise_scene::BackendRequest;

    crate::no_gpu::absent_device! {
        backend() -> BackendRequest;
        describe() -> String;
        add(&Surface, &mut Solver) -> Result<Place, StressError>;
        remove(Place) -> ();
        step(Place, &mut Solver, f32, &SolverParams) -> Result<(), StressError>;
        update(Place, &Surface, &mut Solver) -> Result<(), StressError>;
        read(Place, &mut Surface, &mut Solver) -> Result<(), StressError>;
    }

    /// A body on the GPU; this build has none.
    #[derive(Debug, Clone, Copy)]
    pub(super) enum Place {}
}
mod drape;
mod drop;
mod energy;
mod error;
mod group;
mod heaps;
mod knot;
mod map;
mod masses;
mod measured;
mod pins;
mod plates;
mod plot;
pub(crate) mod row;
mod runner;
mod scales;
mod scenes;
mod sleep;
mod slivers;
mod solids;
mod steps;
mod subjects;
#[cfg(test)]
mod tests;
mod verdicts;
mod volumes;
mod walls;
mod workers;

use crate::backend::Executor;
use crate::json::Json;
use crate::machine;
use crate::numbers::short;
use crate::options::{ModelArguments, RunArguments};
use crate::output::OutputError;
use crate::picture::PictureFile;
use crate::text_table::{count, paragraphs, table_with_text};
use case::Case;
use clap::Args;
use device::Device;
use map::Cell;
use measured::groups;
use plot::Map;
use row::Row;
use runner::{Effort, Runner, Setting};
use std::error::Error;
use std::io::{self, Write};
use std::path::PathBuf;
use std::time::Instant;
use verdicts::verdicts;

/// Runs stress tests of the solver; fails if an invariant does not hold.
#[derive(Args, Clone)]
pub(crate) struct StabilityArguments {
    #[command(flatten)]
    pub(crate) run: RunArguments,
    /// Cases to run, separated by commas, for example T1,T3,volume.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,
    /// Run a part of every case: seconds instead of minutes.
    #[arg(long)]
    quick: bool,
    #[command(flatten)]
    models: ModelArguments,
    /// Drops of each model in the case `drop`, at most 800; large models have fewer by default.
    #[arg(long, value_name = "N")]
    samples: Option<u32>,
    /// Only drops whose description, as printed by --list, contains a text.
    #[arg(long, value_name = "TEXT")]
    matching: Option<String>,
    /// Print every run beyond its bound, the worst first.
    #[arg(long)]
    list: bool,
    /// Also draw the stability map of the case `map` as SVG and PNG: time steps by compliances,
    /// one panel per load.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

impl StabilityArguments {
    /// Returns whether the run writes more files than its rows.
    pub(crate) fn writes_more(&self) -> bool {
        self.plot.is_some()
    }

    fn setting(&self) -> Result<Setting, Box<dyn Error>> {
        Ok(Setting {
            effort: match self.quick {
                true => Effort::Quick,
                false => Effort::Full,
            },
            subjects: subjects::load(self.models.models.as_deref())?.into(),
            samples: self.samples,
            matching: self.matching.clone(),
        })
    }
}

/// Returns all cases in the order of the table.
fn cases() -> impl Iterator<Item = Case> {
    let parts: [&[Case]; 18] = [
        &steps::CASES,
        &masses::CASES,
        &scales::CASES,
        &pins::CASES,
        &volumes::CASES,
        &contacts::CASES,
        &walls::CASES,
        &sleep::CASES,
        &constraint_order::CASES,
        &map::CASES,
        &heaps::CASES,
        &closing::CASES,
        &knot::CASES,
        &drape::CASES,
        &bars::CASES,
        &plates::CASES,
        &slivers::CASES,
        &drop::CASES,
    ];
    parts.into_iter().flatten().copied()
}

/// Returns the named cases, or all if none is named.
fn chosen(only: &[String]) -> Result<Vec<Case>, String> {
    let is = |case: &Case, name: &str| case.id.eq_ignore_ascii_case(name.trim());
    if let Some(name) = (only.iter()).find(|name| !cases().any(|case| is(&case, name))) {
        let mut ids: Vec<&str> = Vec::new();
        for case in cases() {
            if !ids.contains(&case.id) {
                ids.push(case.id);
            }
        }
        return Err(format!("'{name}' is none of {}", ids.join(", ")));
    }
    let wanted = |case: &Case| only.is_empty() || only.iter().any(|name| is(case, name));
    Ok(cases().filter(wanted).collect())
}

/// Opens the pictures of `--plot`, one per backend; with several, the backend ends the name.
///
/// # Errors
/// An error when a file cannot be written or the case `map` does not run.
fn plots(
    arguments: &StabilityArguments,
    cases: &[Case],
) -> Result<Vec<PictureFile>, Box<dyn Error>> {
    let Some(path) = &arguments.plot else {
        return Ok(Vec::new());
    };
    if !cases.iter().any(|case| case.id == map::CASES[0].id) {
        return Err("--plot draws the case map: add map to --only, or omit --plot".into());
    }
    let backends = arguments.run.backends();
    let open = |executor: &Executor| match backends.len() {
        1 => PictureFile::open(path),
        _ => {
            let mut name = path.file_stem().unwrap_or_default().to_owned();
            name.push("-");
            name.push(executor.name());
            PictureFile::open(&path.with_file_name(name))
        }
    };
    let opened: Result<Vec<_>, OutputError> = backends.iter().map(open).collect();
    Ok(opened?)
}

/// Runs the cases, prints and writes their verdicts.
pub(crate) fn run(
    arguments: &StabilityArguments,
    out: &mut impl Write,
) -> Result<(), Box<dyn Error>> {
    let begin = Instant::now();
    let named = chosen(&arguments.only)?;
    let mut json = Json::open(arguments.run.rows.json.as_deref())?;
    let mut plots = plots(arguments, &named)?.into_iter();
    let mut drawn: Vec<(PictureFile, Vec<Cell>)> = Vec::new();
    let commit = machine::commit();
    let setting = arguments.setting()?;
    let mut rows: Vec<Row> = Vec::new();
    let mut written = Ok(());
    for executor in arguments.run.backends() {
        let device = match executor {
            Executor::Cpu => None,
            Executor::Gpu => Some(Device::open(arguments.run.gpu.adapter.as_deref())?),
        };
        let described = (device.as_ref()).map_or_else(machine::machine, Device::describe);
        let backend = executor.name();
        writeln!(out, "{backend}: {described}, commit {commit}")?;
        if arguments.quick {
            writeln!(out, "Quick: a part of every case.")?;
        }
        let runner = Runner::new(setting.clone(), device);
        let progress = arguments.run.rows.progress(groups(&named).len(), 1);
        let mut told = Ok(());
        let (verdicts, map) = verdicts(&named, runner, |rows| {
            progress.begin(&rows[0].id);
            told = progress.suspend(|| print(rows, arguments.list, out));
            progress.step();
        });
        progress.end();
        told?;
        rows.extend(verdicts.into_iter().map(|row| Row {
            backend: backend.to_owned(),
            device: described.clone(),
            commit: commit.clone(),
            ..row
        }));
        drawn.extend(plots.next().zip(map));
        written = json.write(&rows);
    }
    let heading = "stress, invariant, and the worst run";
    write!(
        out,
        "{}",
        table_with_text(row::COLUMNS, &rows, heading, Row::text)
    )?;
    write!(out, "{}", paragraphs(row::LEGEND))?;
    let failed = rows.iter().filter(|row| !row.passed).count();
    // Cases run side by side, so that their times add up to more.
    let seconds = begin.elapsed().as_secs_f64();
    writeln!(
        out,
        "Failed: {failed} of {}, in {seconds:.0} s.",
        count(rows.len(), "verdict")
    )?;
    for (mut file, cells) in drawn {
        let (cells, bound) = (cells.as_slice(), map::CASES[0].bound);
        file.draw(plot::SIZE, &Map { cells, bound })?;
    }
    written?;
    let names = disagreements(&rows);
    if !names.is_empty() {
        return Err(format!("backends disagree on {}", names.join(", ")).into());
    }
    if failed > 0 {
        let verb = if failed == 1 { "does" } else { "do" };
        return Err(format!("{} {verb} not hold", count(failed, "invariant")).into());
    }
    Ok(())
}

/// Prints a line for each verdict of a group, and for each run beyond its bound if asked to.
fn print(rows: &[Row], list: bool, out: &mut impl Write) -> io::Result<()> {
    for row in rows {
        let verdict = if row.passed { "pass" } else { "FAIL" };
        writeln!(
            out,
            "{verdict}  {} ({:.1} s): {}; {}",
            row.id, row.seconds, row.stress, row.invariant
        )?;
        for (value, at) in row.beyond.iter().filter(|_| list) {
            writeln!(out, "      {}  {at}", short(Some(*value)))?;
        }
    }
    out.flush()
}

/// Returns the cases with different verdicts on different backends.
fn disagreements(rows: &[Row]) -> Vec<String> {
    let first = |row: &Row| {
        let same = |other: &&Row| {
            (&other.id, &other.stress, &other.invariant) == (&row.id, &row.stress, &row.invariant)
        };
        rows.iter().find(same).is_some_and(|r| r.passed)
    };
    let differing = rows.iter().filter(|row| row.passed != first(row));
    differing.map(|row| row.id.clone()).collect()
}
