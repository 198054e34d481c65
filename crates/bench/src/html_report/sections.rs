//! Sections of the report: figures and tables of one bench, grouped by machine.

use super::error::ReportError;
use super::html::{self, Group, Html};
use super::paper_table::paper_table;
use super::sources::{Rows, Source};
use super::summary::settings;
use crate::chart::{Chart, Series};
use crate::cut::progressive::row as progressive;
use crate::cut::row::Record;
use crate::cut::times::Times;
use crate::picture;
use crate::text_table::Column;
use crate::work_precision;
use crate::{cut, refine, skip, stability, step};
use plotters::chart::SeriesLabelPosition;

/// Size of a chart over the whole width, and of one beside another \[px\].
pub(super) const WIDE: (u32, u32) = (900, 480);
pub(super) const HALF: (u32, u32) = (500, 400);

/// The sources of one machine; the second value is whether an earlier source has the same settings.
pub(super) type Sources<'a> = Vec<(&'a Source, bool)>;

/// Returns the title of a bench's section.
pub(super) fn title(bench: &str) -> &'static str {
    match bench {
        "table" => "The seven models beside the paper's Table 1",
        "accuracy" => "Accuracy: error against time of a frame",
        "cut" => "Time of a cut",
        "refine" => "Section meshes: time and quality",
        "step" => "Time of a frame of the solver",
        "stability" => "Stability",
        "skip" => "Cost of unused features",
        _ => "The paper's figures",
    }
}

/// Groups sources by machine.
pub(super) fn by_machine<'a>(
    sources: impl Iterator<Item = &'a Source>,
) -> Vec<(&'a str, Sources<'a>)> {
    let mut machines: Vec<(&str, Sources<'_>)> = Vec::new();
    for source in sources {
        let i = match machines.iter().position(|of| of.0 == source.machine) {
            Some(i) => i,
            None => {
                machines.push((&source.machine, Vec::new()));
                machines.len() - 1
            }
        };
        let is_duplicate = (machines[i].1.iter()).any(|(s, _)| settings(s) == settings(source));
        machines[i].1.push((source, is_duplicate));
    }
    machines
}

/// Appends the figures and tables of one bench on one machine.
///
/// # Errors
/// [`ReportError::Image`].
pub(super) fn show(html: &mut Html, sources: &Sources<'_>) -> Result<(), ReportError> {
    match sources.first().map(|(source, _)| &source.rows) {
        Some(Rows::Table(_)) => paper_table(html, sources),
        Some(Rows::Accuracy(_)) => accuracy(html, sources),
        Some(Rows::Cut(_)) => cuts(html, sources),
        Some(Rows::Refine(_)) => {
            section_meshes(html, sources);
            Ok(())
        }
        Some(Rows::Step(_)) => frames(html, sources),
        Some(Rows::Stability(_)) => {
            invariants(html, sources);
            Ok(())
        }
        Some(Rows::Skip(_)) => {
            claims(html, sources);
            Ok(())
        }
        None => Ok(()),
    }
}

/// Draws a chart.
pub(super) fn svg(size: (u32, u32), chart: &Chart<'_>) -> Result<String, ReportError> {
    Ok(html::svg(&picture::svg(size, chart)?))
}

/// Returns a chart over the number of triangles.
pub(super) fn over_triangles(y: &str, series: Vec<Series>) -> Chart<'_> {
    let falls = y == "frames per second";
    Chart {
        title: String::new(),
        x: "triangles",
        y,
        log_x: true,
        legend: match falls {
            true => SeriesLabelPosition::UpperRight,
            false => SeriesLabelPosition::UpperLeft,
        },
        series,
        levels: Vec::new(),
    }
}

#[expect(clippy::cast_precision_loss, reason = "a position on an axis")]
pub(super) fn size(triangles: usize) -> f64 {
    triangles as f64
}

/// Returns groups of rows, one per source.
pub(super) fn groups<'a, T>(
    sources: &Sources<'a>,
    rows: impl Fn(&'a Rows) -> Vec<&'a T>,
) -> Vec<Group<'a, T>> {
    let group = |&(source, is_folded): &(&'a Source, bool)| Group {
        title: source.title(&settings(source)),
        rows: rows(&source.rows),
        is_folded,
    };
    sources.iter().map(group).collect()
}

/// Appends a chart per scene and backend: time against error, with the Pareto fronts.
fn accuracy(html: &mut Html, sources: &Sources<'_>) -> Result<(), ReportError> {
    html.paragraph(
        "Every point is a number of substeps and iterations. Lines are Pareto fronts: runs that \
         no other run beats in both time and error.",
    );
    let rows = sources.iter().flat_map(|(source, _)| match &source.rows {
        Rows::Accuracy(rows) => rows.as_slice(),
        _ => &[],
    });
    let rows: Vec<&work_precision::Row> = rows.collect();
    let mut scenes: Vec<[&str; 2]> = Vec::new();
    for row in &rows {
        let scene = [row.scene.as_str(), row.backend.as_str()];
        if !scenes.contains(&scene) {
            scenes.push(scene);
        }
    }
    let mut figures = Vec::new();
    for [scene, backend] in scenes {
        let rows = rows.iter().copied();
        let rows = rows.filter(|row| row.scene == scene && row.backend == backend);
        let chart = Chart {
            title: String::new(),
            x: "ms per frame",
            y: "error of positions [mean edges]",
            log_x: true,
            legend: SeriesLabelPosition::LowerLeft,
            levels: work_precision::floors(rows.clone()),
            series: work_precision::series(rows, |row| row.total_position, false),
        };
        if !chart.series.is_empty() {
            figures.push((svg(HALF, &chart)?, format!("{scene}, {backend}")));
        }
    }
    html.figures(|html| {
        for (svg, caption) in &figures {
            html.figure(svg, caption, false);
        }
    });
    Ok(())
}

/// A stage of a cut by its name.
type Stage = (&'static str, fn(&Times) -> f64);

const STAGES: [Stage; 5] = [
    ("all", |t| t.total),
    ("detection and split", |t| t.detect + t.split),
    ("caps", |t| t.cap + t.refine),
    ("separation", |t| t.separate),
    ("commit, BVH, constraints", |t| {
        t.commit + t.bvh_update + t.constraints
    }),
];

fn cuts(html: &mut Html, sources: &Sources<'_>) -> Result<(), ReportError> {
    for (source, is_duplicate) in sources {
        let (Rows::Cut(records), false) = (&source.rows, is_duplicate) else {
            continue;
        };
        if !records.iter().any(|record| record.row().is_some()) {
            continue;
        }
        let series = STAGES.map(|(name, of)| {
            let middle = records.iter().filter_map(Record::row);
            let middle = middle.filter(|row| row.planes == "middle");
            let points = middle.map(|row| [size(row.triangles), of(&row.ms_median)]);
            Series::line(name.to_owned(), points.collect())
        });
        let svg = svg(WIDE, &over_triangles("median [ms]", series.to_vec()))?;
        let caption = format!(
            "A cut through the middle, stage by stage: {}",
            settings(source)
        );
        html.figure(&svg, &caption, true);
        for sentence in records.iter().filter_map(Record::sentence) {
            html.paragraph(&sentence);
        }
    }
    let rows = groups(sources, |rows| match rows {
        Rows::Cut(records) => records.iter().filter_map(Record::row).collect(),
        _ => Vec::new(),
    });
    html.table("Cuts", cut::row::COLUMNS, rows, |row| {
        !row.failures.is_empty()
    });
    html.paragraph(cut::row::LEGEND);
    let rows = groups(sources, |rows| match rows {
        Rows::Cut(records) => records.iter().filter_map(Record::progressive).collect(),
        _ => Vec::new(),
    });
    if rows.iter().any(|group| !group.rows.is_empty()) {
        html.table("Progressive cuts", progressive::COLUMNS, rows, |row| {
            !row.failures.is_empty()
        });
        html.paragraph(progressive::LEGEND);
    }
    Ok(())
}

fn section_meshes(html: &mut Html, sources: &Sources<'_>) {
    let rows = groups(sources, |rows| match rows {
        Rows::Refine(rows) => rows.iter().collect(),
        _ => Vec::new(),
    });
    let is_marked = |row: &refine::row::Row| !row.failures.is_empty();
    html.table("Section meshes", refine::row::COLUMNS, rows, is_marked);
    html.paragraph(refine::row::LEGEND);
}

fn frames(html: &mut Html, sources: &Sources<'_>) -> Result<(), ReportError> {
    let mut lines: Vec<Series> = Vec::new();
    let shown = groups(sources, step_rows)
        .into_iter()
        .filter(|group| !group.is_folded);
    for row in shown.flat_map(|group: Group<'_, step::row::Row>| group.rows) {
        let Some(ms) = row.measured.as_ref().map(|m| m.ms_per_frame) else {
            continue;
        };
        let name = format!("{}, {}", row.backend, row.schedule);
        let point = [size(row.triangles), ms];
        match lines.iter_mut().find(|line| line.name == name) {
            Some(line) => line.points.push(point),
            None => lines.push(Series::line(name, vec![point])),
        }
    }
    let series = lines.into_iter().map(|of| Series::line(of.name, of.points));
    let svg = svg(WIDE, &over_triangles("ms per frame", series.collect()))?;
    html.figure(
        &svg,
        "A frame of the solver over the number of triangles",
        true,
    );
    let is_marked = |row: &step::row::Row| row.refusal.is_some();
    html.table(
        "Frames",
        step::row::COLUMNS,
        groups(sources, step_rows),
        is_marked,
    );
    html.paragraph(step::row::LEGEND);
    Ok(())
}

/// Appends invariants of `stability`; failing ones are marked.
fn invariants(html: &mut Html, sources: &Sources<'_>) {
    let rows = groups(sources, |rows| match rows {
        Rows::Stability(rows) => rows.iter().collect(),
        _ => Vec::new(),
    });
    let text: Column<stability::Row> = ("stress, invariant, worst run", |row| row.text());
    let columns: Vec<_> = stability::COLUMNS
        .iter()
        .copied()
        .chain([text])
        .collect();
    html.table("Invariants", &columns, rows, |row| !row.passed);
}

/// Appends claims of `skip`; failing ones are marked.
fn claims(html: &mut Html, sources: &Sources<'_>) {
    let rows = groups(sources, |rows| match rows {
        Rows::Skip(rows) => rows.iter().collect(),
        _ => Vec::new(),
    });
    let text: Column<skip::row::Row> = ("claim and body", |row| row.text());
    let columns: Vec<_> = skip::row::COLUMNS.iter().copied().chain([text]).collect();
    html.table("Claims", &columns, rows, |row| !row.passed);
}

/// Returns the rows of a source of the `step` bench.
fn step_rows(rows: &Rows) -> Vec<&step::row::Row> {
    match rows {
        Rows::Step(rows) => rows.iter().collect(),
        _ => Vec::new(),
    }
}
