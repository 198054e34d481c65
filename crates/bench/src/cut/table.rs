//! The rows for people.

use super::row::{Latency, Record, Row, Slope};
use super::times::Times;
use crate::columns::measured;
use std::io::{self, Write};

/// What stands in the columns.
pub(super) const LEGEND: &str = "\
n: triangles. k: triangles hit, caps: triangles of both caps; medians. Times in ms, medians, each step for itself; p99: of the sum. \
detect: search and intersection. split: mesh edit along the sweep. separate: pieces. commit: the delta and the undo. tree: the search tree that follows. solver: constraints \
and masses that follow. middle: one plane through the middle, 15 times; seeded: planes at random. Every cut is taken back before the next.";

const WIDTHS: [usize; 18] = [15, 6, 8, 5, 7, 5, 6, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8];
/// Columns that begin at their left edge.
const LEFT: [usize; 3] = [0, 1, 17];

/// The names of the columns.
pub(super) fn header(out: &mut impl Write) -> io::Result<()> {
    let names = [
        "model", "planes", "n", "k", "caps", "cuts", "failed", "detect", "split", "cap", "refine",
        "separate", "commit", "tree", "solver", "sum", "p99", "source",
    ];
    line(out, &names.map(str::to_owned))
}

/// One row.
pub(super) fn row(out: &mut impl Write, row: &Row) -> io::Result<()> {
    let [a, b, c, d, e, f, g, h, i] = steps(&row.ms_median);
    let cells = [
        row.model.clone(),
        row.planes.to_owned(),
        row.triangles.to_string(),
        measured(row.hits, 0),
        measured(row.cap_triangles, 0),
        row.cuts.to_string(),
        row.failures.len().to_string(),
        a,
        b,
        c,
        d,
        e,
        f,
        g,
        h,
        i,
        measured(row.ms_p99.total, 3),
        row.source.clone(),
    ];
    line(out, &cells)
}

fn steps(t: &Times) -> [String; 9] {
    [
        t.detect,
        t.split,
        t.cap,
        t.refine,
        t.separate,
        t.commit,
        t.search_tree,
        t.constraints,
        t.total,
    ]
    .map(|ms| measured(ms, 3))
}

/// How times grow in a family.
pub(super) fn slope(out: &mut impl Write, slope: &Slope) -> io::Result<()> {
    writeln!(
        out,
        "{}: detect and split together grow as n to the power of {:.2} ({} sizes from {} to {}).",
        slope.family, slope.slope, slope.sizes, slope.triangles_from, slope.triangles_to
    )
}

/// A stage of the comparison of latencies.
pub(super) fn latency(out: &mut impl Write, row: &Latency) -> io::Result<()> {
    writeln!(
        out,
        "After {} cuts of {} ({} triangles, {} pieces): {} cuts that hit {} to {} triangles, median {} ms, p99 {} ms, \
         {} times that of the first; search tree {} ms.",
        row.cuts_before,
        row.model,
        row.triangles,
        row.pieces,
        row.probes,
        measured(row.hits_from, 0),
        measured(row.hits_to, 0),
        measured(row.ms_median.total, 3),
        measured(row.ms_p99.total, 3),
        measured(row.p99_ratio, 2),
        measured(row.ms_median.search_tree, 3),
    )
}

/// Every cut that could not be done, and the share of those.
pub(super) fn failures(out: &mut impl Write, records: &[Record]) -> io::Result<()> {
    let (mut done, mut failed) = (0, 0);
    for record in records {
        let (model, cuts, failures) = match record {
            Record::Cut(row) => (&row.model, row.cuts, &row.failures),
            Record::Latency(row) => (&row.model, row.probes, &row.failures),
            Record::Slope(_) => continue,
        };
        for failure in failures {
            writeln!(out, "Failed cut of {model}: {failure}.")?;
        }
        done += cuts;
        failed += failures.len();
    }
    writeln!(out, "Failed: {failed} of {} cuts.", done + failed)
}

fn line(out: &mut impl Write, cells: &[String; WIDTHS.len()]) -> io::Result<()> {
    let mut text = String::new();
    for (k, (cell, width)) in cells.iter().zip(WIDTHS).enumerate() {
        if k > 0 {
            text.push_str("  ");
        }
        if LEFT.contains(&k) {
            text.push_str(&format!("{cell:width$}"));
        } else {
            text.push_str(&format!("{cell:>width$}"));
        }
    }
    writeln!(out, "{}", text.trim_end())
}

#[cfg(test)]
mod tests {
    use super::super::row::tests as rows;
    use super::*;

    fn text(write: impl FnOnce(&mut Vec<u8>) -> io::Result<()>) -> String {
        let mut out = Vec::new();
        write(&mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn numbers_stand_below_their_names() {
        let head = text(header);
        let line = text(|out| row(out, &rows::row(1234, 8.0)));
        for (name, value) in [(" n ", "1234"), ("split", "6.000"), ("p99", "8.000")] {
            let end = |s: &str, part: &str| s.rfind(part).map(|at| at + part.trim_end().len());
            assert_eq!(end(&head, name), end(&line, value), "{head}{line}");
        }
    }

    #[test]
    fn failures_are_printed_and_counted() {
        let mut row = rows::row(20, 1.0);
        row.failures.push("no (plane 1,0,0,0)".to_owned());
        let text = text(|out| failures(out, &[Record::Cut(Box::new(row.clone()))]));
        assert!(
            text.contains("Failed cut of Sphere: no (plane 1,0,0,0)."),
            "{text}"
        );
        assert!(text.ends_with("Failed: 1 of 16 cuts.\n"), "{text}");
    }
}
