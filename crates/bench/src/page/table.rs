//! The paper's Table 1 and Figure 11.

use super::chart::{Chart, Series};
use super::error::PageError;
use super::html::Html;
use super::numbers::{digits, factor, measured};
use super::rows::TableRow;
use crate::table::paper::{self, PaperRow};
use incise_mesh::Model;
use plotters::chart::SeriesLabelPosition;

/// What the paper has of a model, if it knows it.
fn paper(name: &str) -> Option<PaperRow> {
    let model = Model::ALL.into_iter().find(|model| model.name() == name);
    model.map(paper::row)
}

/// What bodies have that the paper's have not, as a sentence.
fn beyond(row: &TableRow) -> String {
    let all = [
        (row.volume, "pieces keep their volumes"),
        (row.struts, "struts hold their sides apart"),
        (row.contacts, "pieces touch each other"),
    ];
    let has = all.iter().filter(|(is_on, _)| *is_on);
    let has: Vec<&str> = has.map(|&(_, text)| text).collect();
    if has.is_empty() {
        String::new()
    } else {
        format!(" Unlike the paper's, which costs time: {}.", has.join(", "))
    }
}

/// A table of one run, beside the paper's, and its frame rates over time.
pub(super) fn show(html: &mut Html, rows: &[TableRow]) -> Result<(), PageError> {
    let Some(first) = rows.first() else {
        return Ok(());
    };
    // Before there were two methods there was the paper's.
    let method = first.method.as_deref().unwrap_or("rebuild");
    html.subheading(&format!("{method} on the {}", first.backend));
    html.paragraph(&format!(
        "{} simulated seconds, {} iterations a frame; a slice every second in PBD + CS. x says how many times better than the \
         paper, whose machine is another one.{}",
        first.seconds,
        first.iterations,
        beyond(first)
    ));
    let lines: Vec<_> = rows.iter().map(|row| (rates(row), false)).collect();
    let names = [
        "model",
        "source",
        "vertices",
        "triangles",
        "PBD FPS",
        "paper",
        "x",
        "PBD + CS FPS",
        "paper",
        "x",
        "diff %",
        "paper",
    ];
    html.table("Frames a second", names, &[0, 1], &lines);
    let lines: Vec<_> = rows
        .iter()
        .map(|row| (cuts(row), !row.cuts_refused.is_empty()))
        .collect();
    let names = [
        "model",
        "cut ms",
        "paper",
        "x",
        "p99 ms",
        "cuts",
        "refused",
        "triangles after",
        "stretch %",
        "volume %",
        "cap angle",
    ];
    html.table(
        "Cuts and errors; a row with refused slices is marked",
        names,
        &[0],
        &lines,
    );
    over_time(html, rows)
}

fn rates(row: &TableRow) -> [String; 12] {
    let paper = paper(&row.model);
    let of = |value: fn(&PaperRow) -> f64| paper.as_ref().map(value);
    let (pbd, cs) = (of(|p| p.pbd_fps), of(|p| p.pbd_cs_fps));
    [
        row.model.clone(),
        row.source.clone(),
        row.vertices.to_string(),
        row.triangles.to_string(),
        digits(row.pbd_fps, 1),
        measured(pbd, 1),
        factor(pbd.map(|p| row.pbd_fps / p)),
        digits(row.pbd_cs_fps, 1),
        measured(cs, 1),
        factor(cs.map(|p| row.pbd_cs_fps / p)),
        digits(row.fps_difference_percent, 1),
        measured(of(|p| p.difference_percent), 1),
    ]
}

fn cuts(row: &TableRow) -> [String; 11] {
    let paper = paper(&row.model).map(|p| p.cut_ms);
    [
        row.model.clone(),
        measured(row.cut_ms_mean, 3),
        measured(paper, 2),
        factor(paper.zip(row.cut_ms_mean).map(|(p, ms)| p / ms)),
        measured(row.cut_ms_p99, 3),
        row.cuts.to_string(),
        row.cuts_refused.len().to_string(),
        row.triangles_after.to_string(),
        measured(row.stretch_error_percent, 3),
        measured(row.volume_error_percent, 2),
        measured(row.cap_min_angle_deg, 1),
    ]
}

/// Figure 11: a chart of the solver alone and one with cuts.
fn over_time(html: &mut Html, rows: &[TableRow]) -> Result<(), PageError> {
    if rows.iter().all(|row| row.pbd_fps_by_second.is_empty()) {
        html.missing(
            "Frames a second over time (Figure 11): the rows have none, an earlier version wrote them.",
        );
        return Ok(());
    }
    let chart = |of: fn(&TableRow) -> &[Option<f64>]| {
        let series = rows.iter().map(|row| {
            let seconds = (1..).map(f64::from).zip(of(row));
            let line: Vec<[f64; 2]> = seconds
                .filter_map(|(second, rate)| Some([second, (*rate)?]))
                .collect();
            Series {
                name: row.model.clone(),
                points: line.clone(),
                line,
            }
        });
        Chart {
            across: "simulated time [s]",
            along: "frames a second",
            log_across: false,
            names: SeriesLabelPosition::UpperRight,
            series: series.collect(),
        }
        .half_svg()
    };
    let pbd = chart(|row| &row.pbd_fps_by_second)?;
    let cs = chart(|row| &row.pbd_cs_fps_by_second)?;
    html.beside(|html| {
        html.figure(
            &pbd,
            "Figure 11a: frames a second over time, PBD alone",
            false,
        );
        html.figure(&cs, "Figure 11b: PBD and cuts, one a second", false);
    });
    Ok(())
}
