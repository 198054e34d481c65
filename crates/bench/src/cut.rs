//! What a cut costs, step by step, on models from 20 triangles to a million.

mod latency;
mod outcome;
mod planes;
mod row;
mod specimen;
mod table;
mod times;

use crate::json::Json;
use crate::method::MethodChoice;
use crate::options::{ModelArguments, OutputArguments};
use crate::{columns, machine, subject};
use clap::Args;
use incise_refine::RefinementLevel;
use row::{Record, Slope, Stamp};
use std::error::Error;
use std::io::Write;

/// What is cut, how and how often.
#[derive(Args, Clone)]
pub(crate) struct CutArguments {
    #[command(flatten)]
    from: ModelArguments,
    /// Models to cut, separated by commas: those of the table, finer armadillos as Armadillo120000,
    /// and spheres as Sphere3072.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,
    /// How surfaces are opened.
    #[arg(long, value_enum, default_value_t = MethodChoice::Exact)]
    method: MethodChoice,
    /// Seeded planes for each model, besides the one through the middle.
    #[arg(long, value_name = "N", default_value_t = 100)]
    planes: u32,
    /// Leave out larger models.
    #[arg(long, value_name = "N", default_value_t = 1_400_000)]
    max_triangles: usize,
    /// Cuts that a body has behind it at last when latencies are compared; 0 compares none. The body is Sphere49152,
    /// so that --only has to name it, or nothing.
    #[arg(long, value_name = "N", default_value_t = 1000)]
    cuts: u32,
    /// Refinement level of the caps: one of the five names, or z.
    #[arg(long, default_value = "1")]
    level: RefinementLevel,
    /// By how much the length of the caps' edges grows with every meter off the rim.
    #[arg(long, default_value_t = 0.0)]
    grading: f64,
    /// Where the directions of the planes start.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    pub(crate) rows: OutputArguments,
}

/// Measures and prints.
pub(crate) fn run(arguments: &CutArguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let folder = arguments.from.models.as_deref();
    let subjects = subject::list(folder, &arguments.only, arguments.max_triangles)?;
    let mut params = arguments.method.params(arguments.level);
    params.refine.grading = arguments.grading;
    let stamp = Stamp {
        method: arguments.method.name(),
        level: arguments.level.z(),
        grading: arguments.grading,
        seed: arguments.seed,
        machine: machine::machine(),
        commit: machine::commit(),
        version: env!("CARGO_PKG_VERSION"),
    };
    writeln!(
        out,
        "{}, commit {}; method {}, level {}, grading {}, seed {}",
        stamp.machine, stamp.commit, stamp.method, arguments.level, stamp.grading, stamp.seed
    )?;
    let mut json = Json::open(arguments.rows.json.as_deref())?;
    table::header(out)?;
    let mut records = Vec::new();
    let progress = arguments.rows.progress(subjects.len(), 1);
    for subject in &subjects {
        progress.begin(&subject.name);
        let rows = planes::measure(subject, &params, arguments.planes, &stamp)?;
        progress.aside(|| rows.iter().try_for_each(|row| table::row(out, row)))?;
        records.extend(rows.into_iter().map(|row| Record::Cut(Box::new(row))));
        progress.step();
        // After every model: what a long run has measured is not lost with it. What cannot be written now may be at the end.
        let _ = json.write(&records);
    }
    progress.end();
    write!(out, "{}", columns::paragraphs(table::LEGEND))?;
    for slope in Slope::of_families(&records, &stamp) {
        table::slope(out, &slope)?;
        records.push(Record::Slope(slope));
    }
    if arguments.cuts > 0 && is_wanted(&arguments.only, latency::MODEL) {
        for latency in latency::measure(&params, arguments.cuts, &stamp)? {
            table::latency(out, &latency)?;
            records.push(Record::Latency(Box::new(latency)));
        }
    }
    table::failures(out, &records)?;
    Ok(json.write(&records)?)
}

/// Whether `only` names a model, or nothing.
fn is_wanted(only: &[String], model: &str) -> bool {
    only.is_empty()
        || only
            .iter()
            .any(|name| name.trim().eq_ignore_ascii_case(model))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn latencies_are_compared_where_their_body_is_asked_for() {
        let wanted = |only: &[&str]| {
            let only: Vec<String> = only.iter().map(|&s| s.to_owned()).collect();
            is_wanted(&only, latency::MODEL)
        };
        assert!(
            wanted(&[]) && wanted(&["bunny", " sphere49152"]),
            "named, or all"
        );
        assert!(
            !wanted(&["Bunny"]) && !wanted(&["Sphere4915"]),
            "another one"
        );
        // The name is that of a model which can be asked for.
        let only = [latency::MODEL.to_owned()];
        let subjects = subject::list(None, &only, 100_000).unwrap();
        assert_eq!(
            subjects[0].surface().unwrap().topology().triangle_count(),
            49_152
        );
    }
}
