//! What it costs to cover the sections that cuts leave, and how good the covers are.

mod comparison;
mod cover;
mod ours;
mod peers;
mod plot;
mod rim_files;
mod rims;
mod row;
mod tradeoff;

use crate::json::Json;
use crate::options::{ModelArguments, OutputArguments};
use crate::output::{OutputError, OutputFile};
use crate::picture::PictureFile;
use crate::{columns, machine, subject};
use clap::Args;
use incise_refine::RefinementLevel;
use row::{Row, Stamp};
use std::error::Error;
use std::io::Write;
use std::path::PathBuf;

/// The level that other programs are compared at: targets are then edges of the surface itself.
const COMPARED: RefinementLevel = RefinementLevel::Original;

/// Whose sections are covered, and how.
#[derive(Args, Clone)]
pub(crate) struct RefineArguments {
    #[command(flatten)]
    from: ModelArguments,
    /// Models to cut, separated by commas: those of the table, finer armadillos as Armadillo120000,
    /// and spheres as Sphere3072.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,
    /// Seeded planes for each model, besides the one through the middle.
    #[arg(long, value_name = "N", default_value_t = 100)]
    planes: u32,
    /// Leave out larger models.
    #[arg(long, value_name = "N", default_value_t = 200_000)]
    max_triangles: usize,
    /// Refinement levels, separated by commas: the five names, or z.
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "2x-coarser,1.5x-coarser,original,1.5x-finer,2x-finer"
    )]
    levels: Vec<RefinementLevel>,
    /// By how much the target length grows with every meter off the rim.
    #[arg(long, default_value_t = 0.0)]
    grading: f64,
    /// Shortest edges along the rim, in local edge lengths.
    #[arg(long, default_value_t = 0.1)]
    snap: f64,
    /// Where the directions of the planes start.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Run time against quality instead: the paper's method with 1 to 8 rounds, the default with several bounds
    /// on angles.
    #[arg(long)]
    tradeoff: bool,
    /// Also draw run time against quality, as SVG and as PNG beside it.
    #[arg(long, value_name = "FILE", requires = "tradeoff")]
    plot: Option<PathBuf>,
    /// Also write the rows of all models together as CSV: what is drawn.
    #[arg(long, value_name = "FILE", requires = "tradeoff")]
    csv: Option<PathBuf>,
    /// Write the sections at level original as files for other programs instead, into a new folder.
    #[arg(long, value_name = "DIR", conflicts_with = "tradeoff")]
    rims: Option<PathBuf>,
    /// Compare with what other programs made of these sections instead: their results, one file or more.
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with_all = ["tradeoff", "rims"])]
    peers: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) rows: OutputArguments,
}

impl RefineArguments {
    /// Whether the run is for more files than that of its rows.
    pub(crate) fn writes_more(&self) -> bool {
        self.csv.is_some() || self.plot.is_some() || self.rims.is_some()
    }
}

/// What is written besides the table.
struct Files {
    json: Json,
    csv: Option<OutputFile>,
    plot: Option<PictureFile>,
}

impl Files {
    fn open(arguments: &RefineArguments) -> Result<Self, OutputError> {
        let RefineArguments {
            rows, csv, plot, ..
        } = arguments;
        Ok(Self {
            json: Json::open(rows.json.as_deref())?,
            csv: csv.as_deref().map(OutputFile::open).transpose()?,
            plot: plot.as_deref().map(PictureFile::open).transpose()?,
        })
    }
}

/// Measures and prints.
pub(crate) fn run(arguments: &RefineArguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let folder = arguments.from.models.as_deref();
    let subjects = subject::list(folder, &arguments.only, arguments.max_triangles)?;
    let stamp = Stamp {
        grading: arguments.grading,
        snap: arguments.snap,
        seed: arguments.seed,
        machine: machine::machine(),
        commit: machine::commit(),
        version: env!("CARGO_PKG_VERSION"),
    };
    let mut files = Files::open(arguments)?;
    writeln!(
        out,
        "{}, commit {}; grading {}, snap {}, seed {}",
        stamp.machine, stamp.commit, stamp.grading, stamp.snap, stamp.seed
    )?;
    if arguments.tradeoff {
        return tradeoff::run(arguments, &subjects, &stamp, files, out);
    }
    if let Some(rims) = &arguments.rims {
        return rim_files::run(rims, arguments, &subjects, &stamp, out);
    }
    if !arguments.peers.is_empty() {
        return peers::run(arguments, &subjects, &stamp, &mut files.json, out);
    }
    let mut rows: Vec<Row> = Vec::new();
    let mut written = Ok(());
    let progress = arguments.rows.progress(subjects.len(), 1);
    for subject in &subjects {
        progress.begin(&subject.name);
        let rims = rims::of(subject, &arguments.levels, arguments.planes, &stamp)?;
        for (planes, level, rims, failures) in rims {
            rows.push(cover::measure(
                subject, planes, level, &rims, failures, &stamp,
            )?);
        }
        progress.step();
        written = files.json.write(&rows);
    }
    progress.end();
    let cells: Vec<_> = [Row::NAMES.map(str::to_owned)]
        .into_iter()
        .chain(rows.iter().map(Row::cells))
        .collect();
    write!(out, "{}", columns::folded(&cells, 3))?;
    write!(out, "{}", columns::paragraphs(row::LEGEND))?;
    let failed: usize = rows.iter().map(|row| row.failures.len()).sum();
    let covers: usize = rows.iter().map(|row| row.covers).sum();
    writeln!(out, "Failed: {failed} of {} covers.", covers + failed)?;
    for failure in rows.iter().flat_map(|row| &row.failures) {
        writeln!(out, "  {failure}")?;
    }
    written?;
    if failed > 0 {
        return Err(format!("{failed} sections could not be cut or covered").into());
    }
    Ok(())
}
