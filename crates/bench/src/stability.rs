//! Torture: what breaks a solver, each with the law that must hold under it and the worst number found.

mod alike;
mod audit;
mod case;
mod contacts;
mod cuts;
#[cfg(feature = "gpu")]
mod device;
#[cfg(not(feature = "gpu"))]
#[path = "stability/no_device.rs"]
mod device;
mod devices;
mod failure;
mod fuzz;
mod impacts;
mod islands;
mod jerks;
mod long;
mod map;
mod masses;
mod pins;
mod places;
mod plot;
mod refusals;
mod resolution;
mod row;
mod scenes;
mod shapes;
mod sleep;
mod sound;
mod stage;
mod starts;
mod steps;
mod volumes;

use crate::backend::Executor;
use crate::columns::{self, count};
use crate::json::Json;
use crate::machine;
use crate::options::RunArguments;
use crate::output::OutputError;
use crate::picture::PictureFile;
use case::Case;
use clap::Args;
use device::Device;
use incise_progress::Progress;
use map::Cell;
use plot::Map;
use row::{Row, Stamp};
use stage::{Effort, Stage};
use std::error::Error;
use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

/// What is tortured, on what.
#[derive(Args, Clone)]
pub(crate) struct StabilityArguments {
    #[command(flatten)]
    pub(crate) run: RunArguments,
    /// Cases to run, separated by commas: T1 to T20, or the names of those beside them.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,
    /// A part of every case: seconds instead of minutes.
    #[arg(long)]
    quick: bool,
    /// Also draw what the case map finds, as SVG and as PNG beside it: time steps by compliances, a panel for each load.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

impl StabilityArguments {
    /// Whether the run is for more files than that of its rows.
    pub(crate) fn writes_more(&self) -> bool {
        self.plot.is_some()
    }
}

/// All cases of the processor, or those of a device, as they are printed.
fn cases(on_device: bool) -> impl Iterator<Item = Case> {
    let parts: [&[Case]; 20] = [
        &steps::CASES,
        &masses::CASES,
        &resolution::CASES,
        &starts::CASES,
        &shapes::CASES,
        &places::CASES,
        &pins::CASES,
        &jerks::CASES,
        &cuts::CASES,
        &islands::CASES,
        &volumes::CASES,
        &contacts::CASES,
        &impacts::CASES,
        &sleep::CASES,
        &long::CASES,
        &refusals::CASES,
        // The processor beside itself would say nothing.
        if on_device { &devices::CASES } else { &[] },
        &alike::CASES,
        &fuzz::CASES,
        &map::CASES,
    ];
    parts.into_iter().flatten().copied()
}

/// The cases that are named, all if none is: those of the processor, or of a device.
fn chosen(only: &[String], on_device: bool) -> Result<Vec<Case>, String> {
    let is = |case: &Case, name: &str| case.id.eq_ignore_ascii_case(name.trim());
    if let Some(name) = (only.iter()).find(|name| !cases(true).any(|case| is(&case, name))) {
        let mut ids: Vec<&str> = Vec::new();
        for case in cases(true) {
            if !ids.contains(&case.id) {
                ids.push(case.id);
            }
        }
        return Err(format!("'{name}' is none of {}", ids.join(", ")));
    }
    let wanted = |case: &Case| only.is_empty() || only.iter().any(|name| is(case, name));
    Ok(cases(on_device).filter(wanted).collect())
}

/// The pictures of `--plot`, one a backend; with several, their names end with the backend's.
///
/// # Errors
/// Where a file cannot be written, or the map is none of the cases that are run.
fn plots(
    arguments: &StabilityArguments,
    cases: &[Case],
) -> Result<Vec<PictureFile>, Box<dyn Error>> {
    let Some(path) = &arguments.plot else {
        return Ok(Vec::new());
    };
    if !cases.iter().any(|case| case.id == map::CASES[0].id) {
        return Err(
            "--plot draws what the case map finds: add map to --only, or leave --plot out".into(),
        );
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

/// Runs cases on one backend; `tick` is told every verdict.
fn verdicts(
    cases: &[Case],
    stage: &mut Stage,
    stamp: &Stamp,
    progress: &Progress,
    mut tick: impl FnMut(&Row),
) -> Vec<Row> {
    let mut rows = Vec::new();
    for case in cases {
        progress.begin(case.id);
        let begin = Instant::now();
        let mut found = (case.run)(stage);
        let rule = found.as_mut().ok().and_then(|worst| worst.rule.take());
        let row = Row::of(case, found, begin.elapsed().as_secs_f64(), stamp);
        tick(&row);
        rows.push(row);
        if let Some(rule) = rule {
            let row = Row::of(&audit::rule_of(case), Ok(*rule), 0.0, stamp);
            tick(&row);
            rows.push(row);
        }
        progress.step();
    }
    rows
}

/// Tortures and prints.
pub(crate) fn run(
    arguments: &StabilityArguments,
    out: &mut impl Write,
) -> Result<(), Box<dyn Error>> {
    let named = chosen(&arguments.only, true)?;
    let mut json = Json::open(arguments.run.rows.json.as_deref())?;
    let mut plots = plots(arguments, &named)?.into_iter();
    let mut drawn: Vec<(PictureFile, Vec<Cell>)> = Vec::new();
    let commit = machine::commit();
    let mut rows: Vec<Row> = Vec::new();
    let mut written = Ok(());
    for executor in arguments.run.backends() {
        let device = match executor {
            Executor::Cpu => None,
            Executor::Gpu => Some(Device::open(arguments.run.gpu.adapter.as_deref())?),
        };
        let stamp = Stamp {
            backend: executor.name(),
            device: device
                .as_ref()
                .map_or_else(machine::machine, Device::describe),
            commit: commit.clone(),
        };
        writeln!(out, "{}: {}, commit {commit}", stamp.backend, stamp.device)?;
        let effort = if arguments.quick {
            Effort::Quick
        } else {
            Effort::Full
        };
        if arguments.quick {
            writeln!(out, "A part of what the cases say.")?;
        }
        let cases = chosen(&arguments.only, device.is_some())?;
        let mut stage = Stage::new(effort, device);
        let progress = arguments.run.rows.progress(cases.len(), 1);
        let mut told = Ok(());
        rows.extend(verdicts(&cases, &mut stage, &stamp, &progress, |row| {
            let verdict = if row.passed { "pass" } else { "FAIL" };
            // A run takes minutes; what is known is shown.
            told = progress.aside(|| {
                writeln!(
                    out,
                    "{verdict}  {} ({:.1} s): {}; {}",
                    row.id, row.seconds, row.torture, row.law
                )?;
                out.flush()
            });
        }));
        progress.end();
        told?;
        drawn.extend(plots.next().zip(stage.map.take()));
        written = json.write(&rows);
    }
    let cells: Vec<_> = [(Row::NAMES.map(str::to_owned), vec![row::TEXTS.to_owned()])]
        .into_iter()
        .chain(rows.iter().map(|row| (row.cells(), row.texts())))
        .collect();
    write!(out, "{}", columns::with_texts(&cells, 3))?;
    write!(out, "{}", columns::paragraphs(row::LEGEND))?;
    let failed = rows.iter().filter(|row| !row.passed).count();
    let seconds: f64 = rows.iter().map(|row| row.seconds).sum();
    writeln!(
        out,
        "Failed: {failed} of {}, in {seconds:.0} s.",
        count(rows.len(), "verdict")
    )?;
    for (mut file, cells) in drawn {
        let (cells, bound) = (cells.as_slice(), map::CASES[0].bound);
        file.draw(&Map { cells, bound })?;
    }
    written?;
    let apart = disagreements(&rows);
    if !apart.is_empty() {
        return Err(format!("backends disagree on {}", apart.join(", ")).into());
    }
    if failed > 0 {
        let verb = if failed == 1 { "does" } else { "do" };
        return Err(format!("{} {verb} not hold", count(failed, "law")).into());
    }
    Ok(())
}

/// The cases on which not all backends have the same verdict.
fn disagreements(rows: &[Row]) -> Vec<String> {
    let first = |row: &Row| {
        let of = |row: &Row| (row.id, row.torture, row.law);
        let same = |other: &&Row| of(other) == of(row);
        rows.iter().find(same).is_some_and(|r| r.passed)
    };
    let apart = rows.iter().filter(|row| row.passed != first(row));
    apart.map(|row| row.id.to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use incise_progress::Shown;

    fn stamp() -> Stamp {
        Stamp {
            backend: "cpu",
            device: String::new(),
            commit: String::new(),
        }
    }

    /// What does not hold today: the results say by how much. One that is mended leaves this list.
    ///
    /// T12's cuts of who sleeps hold here and not in full: after the eighth, a piece of a ball in the paper's constraints
    /// creeps along the ground for 60 s at the speed that sleep allows, 8e-4 m/s. It has edges of 3 mm, 12% too long, with ends
    /// that weigh 1e-4 of the body's heaviest vertex. Its fastest vertex is at 0.6 of that speed 4 s later.
    ///
    /// So do the armadillo's two cuts with its volume kept: in full its pieces lose up to 97% of it. A cut leaves vertices that weigh
    /// a hundredth of the others and less, whose part of the gradient over the mass is a thousand times theirs: they are given the
    /// volume that is missing, as far as one projection may move a vertex, and their edges take it away again. The default's 16
    /// substeps leave 0.13%. And its mean strain at rest, 19% of compliance 1e-5 after ten iterations, 7% without volume.
    const OPEN: [(&str, &str); 7] = [
        // A single iteration of the paper's constraints in steps of 1/15 s leaves a ball crushed.
        ("T1", "time step 1/15 to 1/60000 s"),
        // Ten iterations do not hold a million times the weight on springs: it is next to free in its fall.
        ("T3", "load on a swinging ribbon, 1 to 1e6 times a vertex"),
        // Small ones fall by an edge of theirs and more in a step, and stay crushed.
        ("T8", "bodies of 1 mm to 1 km"),
        ("T8", "the same at 1e4 and 1e6 m"),
        (
            "contradiction",
            "two pins 10 times as far apart as the sheet is wide, then one let go",
        ),
        // What nothing else holds collapses to a point by pressure 0, and its vertices fly through each other and apart: they
        // are free. By the second time they are 300 m away, where 32 bits know a volume to 150 of those at rest.
        (
            "T10",
            "the same without weight in a ball that nothing else holds",
        ),
        (
            "T20",
            "a sheet at rest, its constraints in any order of colors",
        ),
    ];

    #[test]
    fn a_part_of_every_case_has_the_verdict_of_the_whole() {
        let mut stage = Stage::new(Effort::Quick, None);
        let all: Vec<Case> = cases(false).collect();
        let rows = verdicts(
            &all,
            &mut stage,
            &stamp(),
            &Progress::new(1, 1, Shown::Never),
            |_| {},
        );
        let failed: Vec<_> = (rows.iter().filter(|row| !row.passed))
            .map(|row| (row.id, row.torture))
            .collect();
        assert_eq!(failed, OPEN, "{rows:#?}");
    }

    #[test]
    fn cases_are_found_by_their_names() {
        let only = |names: &[&str]| {
            let names: Vec<String> = names.iter().map(|&s| s.to_owned()).collect();
            chosen(&names, true)
        };
        assert_eq!(only(&[]).unwrap().len(), cases(true).count());
        assert!(only(&["t1", "T2"]).unwrap().len() >= 2);
        let told = only(&["T99"]).unwrap_err();
        for id in ["contradiction", "T13", "map"] {
            assert_eq!(told.matches(id).count(), 1, "{told}");
        }
    }

    #[test]
    fn a_map_that_is_not_made_is_not_drawn() {
        #[derive(clap::Parser)]
        struct Line {
            #[command(flatten)]
            arguments: StabilityArguments,
        }
        let place = tempfile::tempdir().unwrap();
        let files = |line: &str| {
            let path = place.path().join("m.svg").display().to_string();
            let words = ["b", "--plot", &path].into_iter();
            let line = <Line as clap::Parser>::parse_from(words.chain(line.split_whitespace()));
            let opened = plots(
                &line.arguments,
                &chosen(&line.arguments.only, true).unwrap(),
            )?;
            let names = std::fs::read_dir(place.path()).unwrap();
            let mut names: Vec<_> = names.map(|f| f.unwrap().file_name()).collect();
            names.sort_unstable();
            drop(opened);
            Ok::<_, Box<dyn Error>>(names)
        };
        assert!(files("--only T1").is_err(), "nothing to draw");
        assert!(files("--only map").unwrap().contains(&"m.svg".into()));
        let both = files("--backend cpu,gpu").unwrap();
        assert!(both.contains(&"m-cpu.svg".into()) && both.contains(&"m-gpu.svg".into()));
    }

    #[test]
    fn backends_agree_when_every_verdict_is_the_same() {
        let row = |backend, passed| {
            let worst = case::Worst {
                value: if passed { 0.0 } else { f64::INFINITY },
                at: String::new(),
                runs: 1,
                rule: None,
            };
            let case = cases(true).next().unwrap();
            Row {
                backend,
                ..Row::of(&case, Ok(worst), 0.0, &stamp())
            }
        };
        assert!(disagreements(&[row("cpu", false), row("gpu", false)]).is_empty());
        assert_eq!(
            disagreements(&[row("cpu", true), row("gpu", false)]),
            ["T1"]
        );
    }
}
