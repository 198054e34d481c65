//! The section of the paper's table: our numbers beside the paper's, and frame rates over time.

use super::error::ReportError;
use super::html::Html;
use super::sections::{HALF, Sources, WIDE, groups, over_triangles, size, svg};
use super::sources::{Rows, Source};
use super::summary::settings;
use crate::chart::{Chart, Series};
use crate::table;
use crate::table::paper::PaperRow;
use crate::table::row::Row as TableRow;
use plotters::chart::SeriesLabelPosition;

/// Returns the rows of tables that are not duplicates.
fn tables<'a>(sources: &Sources<'a>) -> impl Iterator<Item = (&'a Source, &'a [TableRow])> + Clone {
    let shown: Vec<_> = sources.iter().filter(|source| !source.1).collect();
    let rows = shown
        .into_iter()
        .filter_map(|(source, _)| match &source.rows {
            Rows::Table(rows) => Some((*source, rows.as_slice())),
            _ => None,
        });
    rows.collect::<Vec<_>>().into_iter()
}

/// Appends the paper's table with the paper's numbers beside ours.
///
/// # Errors
/// [`ReportError::Image`].
pub(super) fn paper_table(html: &mut Html, sources: &Sources<'_>) -> Result<(), ReportError> {
    html.paragraph(
        "x is the ratio to the paper's number, above 1 where incise is better. The paper's \
         machine is another one.",
    );
    let beside_paper = |y, ours: &[Ours], theirs: &[Theirs]| {
        let mut series = Vec::new();
        for (source, rows) in tables(sources) {
            for (name, of) in ours {
                let points = rows.iter().map(|row| [size(row.triangles), of(row)]);
                series.push(Series::line(
                    format!("{}{name}", settings(source)),
                    points.collect(),
                ));
            }
        }
        let first = tables(sources).next().map_or(&[][..], |of| of.1);
        for (name, of) in theirs {
            let point = |row: &TableRow| Some([size(row.triangles), row.paper(*of)?]);
            let points = first.iter().filter_map(point).collect();
            series.push(Series::line(format!("the paper{name}"), points));
        }
        svg(WIDE, &over_triangles(y, series))
    };
    let rates = beside_paper(
        "frames per second",
        &[(", PBD+CS", |row| row.pbd_cs_fps)],
        &[(", PBD+CS", |paper| paper.pbd_cs_fps)],
    )?;
    let cuts = beside_paper(
        "time of a cut [ms]",
        &[("", |row| row.cut_ms_mean)],
        &[("", |paper| paper.cut_ms)],
    )?;
    html.figures(|html| {
        html.figure(
            &rates,
            "Frame rate with cuts (PBD+CS) beside the paper's",
            true,
        );
        html.figure(&cuts, "Time of a cut beside the paper's", true);
    });
    over_time(html, sources)?;
    // Two tables: all columns are wider than the page.
    let (rates, errors) = table::row::COLUMNS.split_at(14);
    html.table(
        "Frames per second",
        rates,
        groups(sources, table_rows),
        |_| false,
    );
    let model = table::row::COLUMNS.iter().take(1);
    let columns: Vec<_> = model.chain(errors).copied().collect();
    let caption = "Cuts and errors; rows with failed slices are marked";
    let is_marked = |row: &TableRow| !row.cuts_refused.is_empty();
    html.table(caption, &columns, groups(sources, table_rows), is_marked);
    Ok(())
}

/// The suffix of a legend and a number of our row.
type Ours = (&'static str, fn(&TableRow) -> f64);
/// The suffix of a legend and a number of the paper's row.
type Theirs = (&'static str, fn(&PaperRow) -> f64);

/// Appends Figure 11: frame rates over simulated time, without and with cuts.
fn over_time(html: &mut Html, sources: &Sources<'_>) -> Result<(), ReportError> {
    let mut without = Vec::new();
    for (source, rows) in tables(sources) {
        if rows.iter().all(|row| row.pbd_fps_by_second.is_empty()) {
            without.push(source.file.as_str());
            continue;
        }
        let chart = |of: fn(&TableRow) -> &[Option<f64>]| {
            let series = rows.iter().map(|row| {
                let seconds = (1..).map(f64::from).zip(of(row));
                let points = seconds.filter_map(|(second, rate)| Some([second, (*rate)?]));
                Series::line(row.model.clone(), points.collect())
            });
            let chart = Chart {
                title: String::new(),
                x: "simulated time [s]",
                y: "frames per second",
                log_x: false,
                legend: SeriesLabelPosition::UpperRight,
                series: series.collect(),
                levels: Vec::new(),
            };
            svg(HALF, &chart)
        };
        let pbd = chart(|row| &row.pbd_fps_by_second)?;
        let cs = chart(|row| &row.pbd_cs_fps_by_second)?;
        let settings = settings(source);
        html.figures(|html| {
            html.figure(&pbd, &format!("Figure 11a, PBD: {settings}"), false);
            html.figure(&cs, &format!("Figure 11b, PBD+CS: {settings}"), false);
        });
    }
    if !without.is_empty() {
        let files = without.join(", ");
        html.note(&format!(
            "No frame rates over time (Figure 11) in older files: {files}."
        ));
    }
    Ok(())
}

/// Returns the rows of a source of the `table` bench.
fn table_rows(rows: &Rows) -> Vec<&TableRow> {
    match rows {
        Rows::Table(rows) => rows.iter().collect(),
        _ => Vec::new(),
    }
}
