//! The summary of the report: the settings and the main result of each source.

use super::sections::Sources;
use super::sources::{Rows, Source};
use crate::cut::row::Record;
use crate::numbers::{fixed, ratio};
use crate::table::row::Row as TableRow;
use crate::text_table::count;
use crate::work_precision::{least_gain, totals};

/// Returns the settings of a source: two of the same are runs of the same measurement.
pub(super) fn settings(source: &Source) -> String {
    match &source.rows {
        Rows::Table(rows) => rows.first().map_or(String::new(), |row| {
            let origin = if row.source == "built-in" {
                "built-in models"
            } else {
                "model files"
            };
            let features = [
                (row.volume, ", volumes"),
                (row.interior_springs, ", interior springs"),
                (row.contacts, ", contacts"),
            ];
            let features = features.iter().filter(|(is_on, _)| *is_on).map(|of| of.1);
            let (method, backend) = (method(row), backend_name(&row.backend));
            let base = format!("{method} method on the {backend}, {origin}");
            base + &features.collect::<String>()
        }),
        Rows::Cut(records) => match records.first() {
            Some(Record::Cut(row)) => format!("{} method", row.stamp.method),
            Some(Record::Progressive(_)) => "progressive cuts".to_owned(),
            _ => String::new(),
        },
        // The scenes of the accuracy bench are in separate files.
        Rows::Accuracy(_) => source.file.clone(),
        Rows::Stability(rows) => rows
            .first()
            .map_or(String::new(), |row| row.backend.clone()),
        Rows::Refine(_) | Rows::Step(_) | Rows::Skip(_) => String::new(),
    }
}

/// Returns the cut method; older files name none, or `rebuild` for the paper's.
pub(super) fn method(row: &TableRow) -> &str {
    match row.method.as_str() {
        "" | "rebuild" => "paper",
        method => method,
    }
}

/// Returns the main results of the sources of one machine.
pub(super) fn summary(sources: &Sources<'_>) -> Option<String> {
    let shown = sources.iter().filter(|(_, is_duplicate)| !is_duplicate);
    let texts: Vec<String> = shown.filter_map(|(source, _)| result(source)).collect();
    let text = match sources.first().map(|(source, _)| &source.rows) {
        Some(Rows::Accuracy(_)) => {
            let gains = texts.join(", ");
            format!("gain in error over the paper's scheme at equal time, 1 to 16 ms: {gains}")
        }
        _ => texts.join("; "),
    };
    (!texts.is_empty()).then_some(text)
}

/// Returns the main result of a source.
fn result(source: &Source) -> Option<String> {
    let failing = |passed: &[bool], name: &str| {
        let failed = passed.iter().filter(|&&passed| !passed).count();
        let verb = if failed == 1 { "fails" } else { "fail" };
        format!("{failed} of {} {verb}", count(passed.len(), name))
    };
    let text = match &source.rows {
        Rows::Table(rows) => {
            let range = |of: fn(&TableRow) -> Option<f64>| {
                let all = rows.iter().filter_map(of);
                let all: Vec<f64> = all.filter(|x| x.is_finite()).collect();
                let least = all.iter().copied().reduce(f64::min);
                format!(
                    "{} to {}",
                    ratio(least),
                    ratio(all.into_iter().reduce(f64::max))
                )
            };
            format!(
                "{}: {} times the paper's frame rate with cuts, cuts {} times as fast",
                settings(source),
                range(|row| Some(row.pbd_cs_fps / row.paper(|p| p.pbd_cs_fps)?)),
                range(|row| Some(row.paper(|p| p.cut_ms)? / row.cut_ms_mean))
            )
        }
        Rows::Accuracy(rows) => {
            let ours = totals(rows.iter().filter(|row| row.is_ours()));
            let theirs = totals(rows.iter().filter(|row| row.is_paper()));
            let gain = least_gain(&ours, &theirs)?;
            let scene = rows.first().map_or("", |row| &row.scene);
            format!("{scene} {}", ratio(gain))
        }
        Rows::Cut(records) => {
            let middle = records.iter().filter_map(Record::row);
            let middle = middle.filter(|row| row.planes == "middle");
            let largest = middle.max_by_key(|row| row.triangles)?;
            let (triangles, ms) = (largest.triangles, fixed(largest.ms_median.total, 1));
            format!(
                "{ms} ms for a cut of {triangles} triangles ({})",
                settings(source)
            )
        }
        Rows::Refine(rows) => {
            let failed: usize = rows.iter().map(|row| row.failures.len()).sum();
            let meshes: usize = rows.iter().map(|row| row.covers).sum();
            format!("{failed} of {} sections fail", meshes + failed)
        }
        Rows::Step(rows) => {
            let timed = rows.iter().filter(|row| row.measured.is_some());
            let largest = timed.max_by_key(|row| row.triangles)?;
            let ms = largest.measured.as_ref().map(|m| m.ms_per_frame);
            let (name, ms) = (&largest.model, fixed(ms, 1));
            format!(
                "{ms} ms for a frame of {name} on the {}",
                backend_name(&largest.backend)
            )
        }
        Rows::Stability(rows) => failing(
            &rows.iter().map(|row| row.passed).collect::<Vec<_>>(),
            "invariant",
        ),
        Rows::Skip(rows) => failing(
            &rows.iter().map(|row| row.passed).collect::<Vec<_>>(),
            "claim",
        ),
    };
    Some(text)
}

/// Returns the name of a backend for readers; a device keeps its own.
fn backend_name(backend: &str) -> &str {
    match backend {
        "cpu" => "CPU",
        "gpu" => "GPU",
        device => device,
    }
}
