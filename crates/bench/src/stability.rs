//! `incise-bench stability`: stress cases, with a verdict on each of their invariants.

use crate::backend::Executor;
use crate::json::Json;
use crate::machine;
use crate::models::files;
use crate::numbers::short;
use crate::options::{ModelArguments, RunArguments};
use crate::skip::row::verdict;
use crate::text_table::{Column, count, paragraphs, table_with_text};
use clap::Args;
use incise_mesh::{RepairParams, read_mesh};
use incise_tests::stability::{Case, Runner, Subject, Verdict, cases};
use serde::{Deserialize, Serialize};
use std::error::Error;
use std::io::{self, Write};
use std::path::Path;
use std::sync::mpsc;
use std::thread;
use std::time::Instant;

/// Runs stress tests of the solver; fails if an invariant does not hold.
#[derive(Args, Clone)]
pub(crate) struct StabilityArguments {
    #[command(flatten)]
    pub(crate) run: RunArguments,
    /// Cases to run, separated by commas, for example T1,T3,volume.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = id)]
    only: Vec<String>,
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
}

/// Parses the name of a case, in any case.
fn id(text: &str) -> Result<String, String> {
    let mut ids: Vec<&str> = cases().map(|case| case.id).collect();
    let is_meant = |id: &&&str| id.eq_ignore_ascii_case(text.trim());
    if let Some(id) = ids.iter().find(is_meant) {
        return Ok((*id).to_owned());
    }
    ids.dedup();
    Err(format!("it is none of {}", ids.join(", ")))
}

/// The verdict on one invariant of a case.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Row {
    id: String,
    /// Older files call it `torture`.
    #[serde(alias = "torture")]
    stress: String,
    /// Older files call it `law`.
    #[serde(alias = "law")]
    invariant: String,
    bound: Option<f64>,
    /// The largest value; none when a run failed.
    worst: Option<f64>,
    /// The run of the largest value, or the error.
    at: String,
    runs: usize,
    pub(crate) passed: bool,
    /// Time of all runs of the case, with its first invariant \[s\].
    seconds: f64,
    pub(crate) backend: String,
    device: String,
    commit: String,
    version: String,
}

/// Columns of the printed table and of the report.
pub(crate) const COLUMNS: &[Column<Row>] = &[
    ("case", |row| row.id.clone()),
    ("backend", |row| row.backend.clone()),
    ("verdict", |row| verdict(row.passed)),
    ("runs", |row| row.runs.to_string()),
    ("bound", |row| short(row.bound)),
    ("worst", |row| short(row.worst)),
];

/// Explains the columns.
const LEGEND: &str = "\
runs: number of runs. worst: the largest value of all runs; a case passes when it is at most the \
bound. -: a run ended in an error or in a position that is not finite. The limits of every motion \
hold where no unknown work is done: ten times the speed that all of the energy would give the \
lightest vertex, a stated distance from the origin, a mean strain of 5% after 5 s, 1.01 of the \
energy.";

impl Row {
    /// Returns the text beside the columns.
    pub(crate) fn text(&self) -> String {
        let Self { stress, at, .. } = self;
        format!("{stress}\ninvariant: {}\nat: {at}", self.invariant)
    }
}

/// Returns the meshes of a folder that can be cut.
fn subjects(folder: &Path) -> Result<Vec<Subject>, Box<dyn Error>> {
    let repairs = RepairParams {
        allow_boundaries: true,
        separate_sheets: true,
    };
    let subject = |path: &std::path::PathBuf| {
        let (surface, _) = read_mesh(path).ok()?.repair(repairs).ok()?;
        let name = path.file_name().unwrap_or_default();
        Subject::new(name.to_string_lossy().into_owned(), surface)
    };
    Ok(files(folder)?.iter().filter_map(subject).collect())
}

/// Opens a backend; also returns its description.
fn open(
    arguments: &StabilityArguments,
    executor: Executor,
) -> Result<(Runner, String), Box<dyn Error>> {
    let subjects = match &arguments.models.models {
        Some(folder) => subjects(folder)?,
        None => Subject::built_in(),
    };
    let (mut runner, device) = match executor {
        Executor::Cpu => (Runner::cpu(subjects), machine::machine()),
        #[cfg(feature = "gpu")]
        Executor::Gpu => Runner::gpu(subjects, arguments.run.gpu.adapter.as_deref())?,
        #[cfg(not(feature = "gpu"))]
        Executor::Gpu => return Err(crate::no_gpu::NoGpu.into()),
    };
    runner.samples = arguments.samples;
    runner.matching.clone_from(&arguments.matching);
    Ok((runner, device))
}

/// Runs the cases, prints and writes their verdicts.
pub(crate) fn run(
    arguments: &StabilityArguments,
    out: &mut impl Write,
) -> Result<(), Box<dyn Error>> {
    let begin = Instant::now();
    let only = &arguments.only;
    let is_meant = |case: &&Case| only.is_empty() || only.iter().any(|id| id == case.id);
    let named: Vec<(usize, &Case)> = cases().filter(is_meant).enumerate().collect();
    let mut json = Json::open(arguments.run.rows.json.as_deref())?;
    let commit = machine::commit();
    let mut rows: Vec<Row> = Vec::new();
    let mut written = Ok(());
    for executor in arguments.run.backends() {
        let (runner, device) = open(arguments, executor)?;
        let backend = executor.name();
        writeln!(out, "{backend}: {device}, commit {commit}")?;
        let progress = arguments.run.rows.progress(named.len(), 1);
        let mut told = Ok(());
        let mut all = Vec::new();
        thread::scope(|scope| {
            let (send, receive) = mpsc::channel();
            let (named, runner) = (&named, &runner);
            scope.spawn(move || {
                runner.each(named, |&(number, case)| {
                    let begin = Instant::now();
                    let verdicts = case.verdicts(runner);
                    let sent = send.send((number, verdicts, begin.elapsed().as_secs_f64()));
                    sent.expect("the receiver waits for all");
                })
            });
            for (number, verdicts, seconds) in receive {
                progress.begin(verdicts[0].case.id);
                told = progress.suspend(|| print(&verdicts, seconds, arguments.list, out));
                progress.step();
                all.push((number, verdicts, seconds));
            }
        });
        progress.end();
        told?;
        all.sort_by_key(|&(number, ..)| number);
        for (_, verdicts, seconds) in all {
            let times = std::iter::once(seconds).chain(std::iter::repeat(0.0));
            rows.extend(
                verdicts
                    .into_iter()
                    .zip(times)
                    .map(|(verdict, seconds)| Row {
                        id: verdict.case.id.to_owned(),
                        stress: verdict.case.stress.to_owned(),
                        invariant: verdict.invariant.to_owned(),
                        bound: Some(verdict.bound),
                        worst: verdict.worst.is_finite().then_some(verdict.worst),
                        passed: verdict.passed(),
                        runs: verdict.runs,
                        at: verdict.at,
                        seconds,
                        backend: backend.to_owned(),
                        device: device.clone(),
                        commit: commit.clone(),
                        version: env!("CARGO_PKG_VERSION").to_owned(),
                    }),
            );
        }
        written = json.write(&rows);
    }
    let heading = "stress, invariant, and the worst run";
    let table = table_with_text(COLUMNS, &rows, heading, Row::text);
    write!(out, "{table}{}", paragraphs(LEGEND))?;
    let failed = rows.iter().filter(|row| !row.passed).count();
    // Cases run side by side, so that their times add up to more.
    let seconds = begin.elapsed().as_secs_f64();
    let all = count(rows.len(), "verdict");
    writeln!(out, "Failed: {failed} of {all}, in {seconds:.0} s.")?;
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

/// Prints a line for each verdict of a case, and for each run beyond its bound if asked to.
fn print(verdicts: &[Verdict], seconds: f64, list: bool, out: &mut impl Write) -> io::Result<()> {
    for found in verdicts {
        let Case { id, stress, .. } = found.case;
        let (verdict, invariant) = (verdict(found.passed()), found.invariant);
        writeln!(
            out,
            "{verdict}  {id} ({seconds:.1} s): {stress}; {invariant}"
        )?;
        for (value, at) in found.beyond.iter().filter(|_| list) {
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
        rows.iter().find(same).is_some_and(|row| row.passed)
    };
    let differing = rows.iter().filter(|row| row.passed != first(row));
    differing.map(|row| row.id.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_are_found_by_their_names() {
        assert_eq!(id("t1").as_deref(), Ok("T1"));
        let told = id("T99").unwrap_err();
        for id in ["contradiction", "T10", "map"] {
            assert_eq!(told.matches(id).count(), 1, "{told}");
        }
    }

    #[test]
    fn backends_agree_when_every_verdict_is_the_same() {
        let row = |passed| Row {
            id: "T1".to_owned(),
            passed,
            ..Row::default()
        };
        assert!(disagreements(&[row(false), row(false)]).is_empty());
        assert_eq!(disagreements(&[row(true), row(false)]), ["T1"]);
    }
}
