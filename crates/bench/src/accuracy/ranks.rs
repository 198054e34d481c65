//! Times to given errors of the best solver, of sweeps alone and of the paper's scheme.

use super::scenes;
use super::table::backends;
use crate::numbers::{exponent, fixed, ratio};
use crate::output::{OutputError, OutputFile};
use crate::text_table::{Column, paragraphs, text_table};
use crate::work_precision::{Row, TARGETS, error_at, time_to, totals};
use incise_pbd_gpu::SolverParams;
use serde::Serialize;
use std::error::Error;
use std::io::{self, Write};
use std::path::Path;

/// Explains the columns.
const LEGEND: &str = "\
ms to E: shortest time of a frame with a total error of at most E, and the run: scheme, substeps x \
iterations. all: the best of all schemes but pbd and patches; sweeps: without the global step; \
paper: pbd, one substep. default: time and error of the default parameters, and their error over \
the smallest one in the same time.";

/// A set of solvers: its name and its rows.
type Solvers = (&'static str, fn(&Row) -> bool);

/// The rows of a scene that ranks compare.
const SOLVERS: [Solvers; 3] = [
    ("all", Row::is_ours),
    ("sweeps", |row| {
        row.is_ours() && !row.scheme.starts_with("global")
    }),
    ("paper", Row::is_paper),
];

/// The fastest run within an error.
#[derive(Debug, Clone, PartialEq)]
struct Fastest {
    ms: f64,
    /// Scheme, substeps x iterations.
    run: String,
}

/// The default parameters beside the Pareto front.
#[derive(Debug, Clone, Copy, PartialEq)]
struct OfDefaults {
    ms: f64,
    error: f64,
    /// Error over the smallest one in the same time.
    over_front: f64,
}

/// A row: a scene, a backend and a set of solvers.
#[derive(Debug, Clone)]
pub(super) struct Rank {
    scene: &'static str,
    backend: String,
    solvers: &'static str,
    /// Of the first three [`TARGETS`].
    fastest: [Option<Fastest>; 3],
    /// With all solvers only.
    defaults: Option<OfDefaults>,
    machine: String,
    commit: String,
}

/// A rank as a row of CSV. The report reads files with a column `scene` as rows of runs.
#[derive(Serialize)]
struct Record<'a> {
    body: &'a str,
    backend: &'a str,
    solvers: &'a str,
    ms_to_0_1: Option<f64>,
    run_to_0_1: Option<&'a str>,
    ms_to_0_01: Option<f64>,
    run_to_0_01: Option<&'a str>,
    ms_to_0_001: Option<f64>,
    run_to_0_001: Option<&'a str>,
    default_ms: Option<f64>,
    default_error: Option<f64>,
    default_over_front: Option<f64>,
    machine: &'a str,
    commit: &'a str,
}

/// Returns the ranks of all scenes and backends.
pub(super) fn ranks(rows: &[Row]) -> Vec<Rank> {
    let all = backends(rows);
    let both = (scenes::NAMES.into_iter()).flat_map(|name| all.iter().map(move |b| (name, *b)));
    let mut ranks = Vec::new();
    for (name, backend) in both {
        let is = move |row: &&Row| row.scene == name && row.backend == backend;
        let rows = || rows.iter().filter(is);
        let Some(first) = rows().next() else {
            continue;
        };
        for (solvers, is_compared) in SOLVERS {
            let rows = || rows().filter(|row| is_compared(row));
            ranks.push(Rank {
                scene: name,
                backend: backend.to_owned(),
                solvers,
                fastest: [0, 1, 2].map(|k| fastest(rows(), TARGETS[k])),
                defaults: (solvers == "all").then(|| of_defaults(rows())).flatten(),
                machine: first.machine.clone(),
                commit: first.commit.clone(),
            });
        }
    }
    ranks
}

/// Returns the fastest of some runs within an error.
fn fastest<'a>(rows: impl Iterator<Item = &'a Row> + Clone, error: f64) -> Option<Fastest> {
    let ms = time_to(&totals(rows.clone()), error)?;
    let is_it = |row: &&Row| row.ms_per_frame == ms && row.total_position <= Some(error);
    let row = rows
        .filter(|row| row.total_position.is_some())
        .find(is_it)?;
    Some(Fastest {
        ms,
        run: format!("{} {}x{}", row.scheme, row.substeps, row.iterations),
    })
}

/// Compares the default parameters with all runs that are as fast.
fn of_defaults<'a>(rows: impl Iterator<Item = &'a Row> + Clone) -> Option<OfDefaults> {
    let params = SolverParams::default();
    let is_default = |row: &&Row| {
        let counts = (row.substeps, row.iterations) == (params.substeps, params.iterations);
        counts && row.scheme == "xpbd-half"
    };
    let row = rows.clone().find(is_default)?;
    let error = row.total_position?;
    Some(OfDefaults {
        ms: row.ms_per_frame,
        error,
        over_front: error / error_at(&totals(rows), row.ms_per_frame)?,
    })
}

fn cell(fastest: Option<&Fastest>) -> String {
    fastest.map_or_else(
        || "-".to_owned(),
        |fastest| format!("{} {}", fixed(fastest.ms, 2), fastest.run),
    )
}

const COLUMNS: &[Column<Rank>] = &[
    ("scene", |rank| match rank.solvers {
        "all" => format!("{}, {}", rank.scene, rank.backend),
        _ => String::new(),
    }),
    ("solvers", |rank| rank.solvers.to_owned()),
    ("ms to 1e-1", |rank| cell(rank.fastest[0].as_ref())),
    ("ms to 1e-2", |rank| cell(rank.fastest[1].as_ref())),
    ("ms to 1e-3", |rank| cell(rank.fastest[2].as_ref())),
    ("default ms", |rank| match &rank.defaults {
        Some(of) => fixed(of.ms, 2),
        None => String::new(),
    }),
    ("error", |rank| match &rank.defaults {
        Some(of) => exponent(Some(of.error)),
        None => String::new(),
    }),
    ("over front", |rank| match &rank.defaults {
        Some(of) => ratio(of.over_front),
        None => String::new(),
    }),
];

/// Prints ranks.
pub(super) fn print(out: &mut impl Write, ranks: &[Rank]) -> io::Result<()> {
    writeln!(out)?;
    write!(out, "{}", text_table(COLUMNS, ranks))?;
    write!(out, "{}", paragraphs(LEGEND))
}

/// The file `ranks.csv`.
pub(super) struct RanksFile(OutputFile);

impl RanksFile {
    /// Opens the file in a folder before the run.
    ///
    /// # Errors
    /// As [`OutputFile::open`].
    pub(super) fn open(folder: &Path) -> Result<Self, OutputError> {
        Ok(Self(OutputFile::open(&folder.join("ranks.csv"))?))
    }

    /// Writes ranks; they replace those written before.
    ///
    /// # Errors
    /// An error of the file or of the CSV writer.
    pub(super) fn write(&mut self, ranks: &[Rank]) -> Result<(), Box<dyn Error>> {
        let mut csv = csv::Writer::from_writer(Vec::new());
        for rank in ranks {
            csv.serialize(record(rank))?;
        }
        Ok(self.0.write(csv.into_inner()?)?)
    }
}

fn record(rank: &Rank) -> Record<'_> {
    let ms = |k: usize| rank.fastest[k].as_ref().map(|fastest| fastest.ms);
    let run = |k: usize| rank.fastest[k].as_ref().map(|fastest| fastest.run.as_str());
    Record {
        body: rank.scene,
        backend: &rank.backend,
        solvers: rank.solvers,
        ms_to_0_1: ms(0),
        run_to_0_1: run(0),
        ms_to_0_01: ms(1),
        run_to_0_01: run(1),
        ms_to_0_001: ms(2),
        run_to_0_001: run(2),
        default_ms: rank.defaults.map(|of| of.ms),
        default_error: rank.defaults.map(|of| of.error),
        default_over_front: rank.defaults.map(|of| of.over_front),
        machine: &rank.machine,
        commit: &rank.commit,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fastest_run_within_an_error_has_a_name() {
        let row = |scheme: &str, substeps, iterations, ms_per_frame, position| Row {
            scene: "bar".to_owned(),
            backend: "cpu".to_owned(),
            scheme: scheme.to_owned(),
            substeps,
            iterations,
            ms_per_frame,
            total_position: Some(position),
            ..Row::default()
        };
        let rows = [
            row("pbd", 1, 8, 0.5, 0.2),
            row("pbd", 2, 8, 0.1, 0.001),
            row("xpbd-half", 16, 1, 1.0, 0.09),
            row("xpbd", 8, 2, 3.0, 0.008),
            row("global", 1, 4, 0.9, 0.03),
            row("global", 2, 4, 2.0, 0.01),
        ];
        let ranks = ranks(&rows);
        let [all, sweeps, paper] = &ranks[..] else {
            panic!("three sets of solvers: {ranks:?}");
        };
        let fastest = |ms, run: &str| {
            let run = run.to_owned();
            Some(Fastest { ms, run })
        };
        let best = [fastest(0.9, "global 1x4"), fastest(2.0, "global 2x4"), None];
        assert_eq!(all.fastest, best);
        let best = [
            fastest(1.0, "xpbd-half 16x1"),
            fastest(3.0, "xpbd 8x2"),
            None,
        ];
        assert_eq!(sweeps.fastest, best, "without the global step");
        assert_eq!(
            paper.fastest,
            [None, None, None],
            "two substeps are not its own"
        );
        let of = all.defaults.expect("16 substeps of one iteration ran");
        assert_eq!((of.ms, of.error), (1.0, 0.09));
        assert!((of.over_front - 3.0).abs() < 1e-12, "global 1x4 has 0.03");
        assert_eq!((sweeps.defaults, paper.defaults), (None, None));
    }
}
