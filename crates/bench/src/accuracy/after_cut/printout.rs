//! Table and charts of the frames after a cut.

use super::{FrameRow, RECOVERED, SCHEMES};
use crate::chart::{Chart, Series};
use crate::numbers::{exponent, fixed};
use crate::statistics::median;
use crate::text_table::{Column, paragraphs, text_table};
use plotters::chart::SeriesLabelPosition;
use std::io::{self, Write};

/// Explains the columns.
const LEGEND: &str = "\
step: error of the frame, to a converged step from the state before it. fresh: the same with a \
factor made in this frame. drift: error to converged steps since the cut. age: frames since the \
constraints of the factor in use were copied. Errors are root mean squares over vertices, weighted \
by mass, over the mean rest length. ms: shortest of several runs; that of frame 1 includes the \
update of the solver after the cut.";

/// Columns of the table.
const COLUMNS: &[Column<FrameRow>] = &[
    ("solver", |row| {
        format!("{} x{}", row.solver, row.iterations)
    }),
    ("frame", |row| row.frame.to_string()),
    ("ms", |row| fixed(row.ms, 2)),
    ("motion", |row| exponent(row.motion)),
    ("step", |row| exponent(row.step_error)),
    ("fresh", |row| exponent(row.fresh_error)),
    ("drift", |row| exponent(row.drift)),
    ("age", |row| {
        row.factor_age
            .map_or_else(|| "-".to_owned(), |age| age.to_string())
    }),
];

/// Returns the rows of a solver.
fn of<'a>(rows: &'a [FrameRow], solver: &str) -> Vec<&'a FrameRow> {
    rows.iter().filter(|row| row.solver == solver).collect()
}

/// Prints the rows of a scene, and how long a cut has an effect.
pub(super) fn scene(out: &mut impl Write, rows: &[FrameRow]) -> io::Result<()> {
    if let Some(row) = rows.first() {
        writeln!(out, "\n{}: {} triangles, cut", row.body, row.triangles)?;
    }
    write!(out, "{}", text_table(COLUMNS, rows))?;
    write!(out, "{}", paragraphs(LEGEND))?;
    let sweeps = blocked(&of(rows, "sweeps"));
    for (solver, _, _) in SCHEMES {
        let rows = of(rows, solver);
        let more = blocked(&rows);
        write!(
            out,
            "  {solver}: a cut takes {more:.2} ms more than a frame"
        )?;
        if solver == "sweeps" {
            writeln!(out)?;
            continue;
        }
        let frames = match recovery(&rows) {
            Some(frames) => format!("{frames} frames"),
            None => "no frame".to_owned(),
        };
        writeln!(
            out,
            ", {:.2} ms more than with sweeps; as accurate as with its own factor after {frames}",
            more - sweeps
        )?;
    }
    Ok(())
}

/// Returns the time by which the frame of the cut exceeds the median \[ms\].
pub(super) fn blocked(rows: &[&FrameRow]) -> f64 {
    let of_cut = rows.first().map_or(0.0, |row| row.ms);
    of_cut - median(rows.iter().map(|row| row.ms).collect())
}

/// Returns the number of frames after which all are as accurate as with a factor of their own;
/// none if the last frame is not.
pub(super) fn recovery(rows: &[&FrameRow]) -> Option<usize> {
    let is_recovered = |row: &&FrameRow| match (row.step_error, row.fresh_error) {
        (Some(error), Some(fresh)) => error <= RECOVERED * fresh,
        _ => false,
    };
    let recovered = rows.iter().rev().take_while(|row| is_recovered(row));
    let frames = rows.len() - recovered.count();
    (frames < rows.len()).then_some(frames)
}

/// Returns the charts of errors per frame, and since the cut.
pub(super) fn charts(rows: &[FrameRow]) -> [Chart<'static>; 2] {
    let name = rows.first().map_or("", |row| row.body);
    let chart = |y: &'static str, series: Vec<Series>| Chart {
        title: format!("{name} after a cut"),
        x: "frame",
        y,
        log_x: false,
        legend: SeriesLabelPosition::UpperRight,
        series: (series.into_iter())
            .filter(|series| !series.points.is_empty())
            .collect(),
        levels: Vec::new(),
    };
    let series = |solver: &str, name: &str, error: fn(&FrameRow) -> Option<f64>| {
        #[expect(clippy::cast_precision_loss, reason = "a small number")]
        let point = |row: &&FrameRow| Some([row.frame as f64, error(row)?]);
        let points = of(rows, solver).iter().filter_map(point).collect();
        Series::line(format!("{solver}{name}"), points)
    };
    let mut steps: Vec<Series> = (SCHEMES.iter())
        .map(|(solver, ..)| series(solver, "", |row| row.step_error))
        .collect();
    steps.push(series("global", ", own factor", |row| row.fresh_error));
    steps.push(series("global", ", motion", |row| row.motion));
    let drifts = (SCHEMES.iter()).map(|(solver, ..)| series(solver, "", |row| row.drift));
    [
        chart("error of a frame [mean edges]", steps),
        chart("error since the cut [mean edges]", drifts.collect()),
    ]
}
