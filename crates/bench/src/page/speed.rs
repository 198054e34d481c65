//! What cuts, caps and frames cost, over the size of a body.

use super::chart::{Chart, Series};
use super::error::PageError;
use super::html::Html;
use super::numbers::{brief, measured};
use super::rows::{CutRow, CutTimes, RefineRow, StepRow};
use plotters::chart::SeriesLabelPosition;

/// A step of a cut by its name.
type Step = (&'static str, fn(&CutTimes) -> f64);

const STEPS: [Step; 5] = [
    ("all", |t| t.total),
    ("detection and split", |t| t.detect + t.split),
    ("caps", |t| t.cap + t.refine),
    ("separation", |t| t.separate),
    ("commit, search tree, constraints", |t| {
        t.commit + t.search_tree + t.constraints
    }),
];

#[expect(clippy::cast_precision_loss, reason = "a place on an axis")]
fn size(triangles: u64) -> f64 {
    triangles as f64
}

/// Points by size, and a line through them.
fn series(name: String, mut points: Vec<[f64; 2]>) -> Series {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    Series {
        name,
        line: points.clone(),
        points,
    }
}

fn chart(along: &str, series: Vec<Series>) -> Result<String, PageError> {
    Chart {
        across: "triangles",
        along,
        log_across: true,
        names: SeriesLabelPosition::UpperLeft,
        series,
    }
    .svg()
}

/// The time of a cut through the middle over the number of triangles, and all rows.
pub(super) fn cuts(html: &mut Html, rows: &[CutRow]) -> Result<(), PageError> {
    let method = rows.first().map_or("", |row| &row.method);
    html.subheading(&format!("method {method}"));
    let middle = |row: &&CutRow| row.kind == "cut" && row.planes.as_deref() == Some("middle");
    let lines = STEPS.map(|(name, of)| {
        let points = rows.iter().filter(middle).filter_map(|row| {
            let ms = of(row.ms_median.as_ref()?);
            Some([size(row.triangles), ms])
        });
        series(name.to_owned(), points.collect())
    });
    let svg = chart("median [ms]", lines.to_vec())?;
    html.figure(
        &svg,
        "A cut through the middle, step by step, over the number of triangles",
        true,
    );
    let cells = rows.iter().filter(|row| row.kind == "cut").map(|row| {
        let median = row.ms_median.as_ref().map(|t| t.total);
        let p99 = row.ms_p99.as_ref().map(|t| t.total);
        let cells = [
            row.model.clone().unwrap_or_default(),
            row.planes.clone().unwrap_or_default(),
            row.triangles.to_string(),
            measured(row.hits, 0),
            measured(row.cap_triangles, 0),
            row.cuts.to_string(),
            row.failures.len().to_string(),
            measured(median, 3),
            measured(p99, 3),
        ];
        (cells, !row.failures.is_empty())
    });
    let names = [
        "model",
        "planes",
        "triangles",
        "hit",
        "cap triangles",
        "cuts",
        "failed",
        "median ms",
        "p99 ms",
    ];
    html.table("Cuts", names, &[0, 1], &cells.collect::<Vec<_>>());
    let slopes = rows.iter().filter_map(|row| {
        let (family, slope) = (row.family.as_ref()?, row.slope?);
        Some(format!("{family}: detection and split grow as the number of triangles to the power of {slope:.2}."))
    });
    let slopes: Vec<String> = slopes.collect();
    if !slopes.is_empty() {
        html.list(&slopes);
    }
    Ok(())
}

/// Time and quality of caps.
pub(super) fn caps(html: &mut Html, rows: &[RefineRow]) {
    let cells = rows.iter().map(|row| {
        let cells = [
            row.model.clone(),
            row.planes.clone(),
            brief(Some(row.level)),
            row.covers.to_string(),
            measured(Some(row.triangles), 0),
            measured(Some(row.triangulation_ms), 3),
            measured(Some(row.refinement_ms), 3),
            measured(row.smallest_angle, 1),
            measured(row.angle_5, 1),
            measured(row.angle_median, 1),
            measured(row.edge_mean, 2),
            measured(row.edge_longest, 2),
        ];
        (cells, !row.failures.is_empty())
    });
    let names = [
        "model",
        "planes",
        "z",
        "covers",
        "triangles",
        "triangulation ms",
        "refinement ms",
        "smallest angle",
        "5% below",
        "median",
        "mean edge",
        "longest edge",
    ];
    let caption = "Caps: angles in degrees, edges over their targets";
    html.table(caption, names, &[0, 1], &cells.collect::<Vec<_>>());
}

/// The time of a frame over the number of triangles, backend by backend.
pub(super) fn frames(html: &mut Html, rows: &[StepRow]) -> Result<(), PageError> {
    let mut lines: Vec<Series> = Vec::new();
    for row in rows {
        let Some(ms) = row.ms_per_frame else { continue };
        let name = format!("{}, {}", row.backend, row.schedule);
        let point = [size(row.triangles), ms];
        match lines.iter_mut().find(|line| line.name == name) {
            Some(line) => line.points.push(point),
            None => lines.push(series(name, vec![point])),
        }
    }
    let lines = lines.into_iter().map(|line| series(line.name, line.points));
    let svg = chart("ms a frame", lines.collect())?;
    html.figure(
        &svg,
        "A frame of the solver over the number of triangles",
        true,
    );
    let cells = rows.iter().map(|row| {
        let cells = [
            row.model.clone(),
            row.triangles.to_string(),
            row.bodies.to_string(),
            row.backend.clone(),
            row.schedule.clone(),
            measured(row.ms_per_frame, 4),
            row.refusal.clone().unwrap_or_else(|| row.device.clone()),
        ];
        (cells, row.refusal.is_some())
    });
    let names = [
        "model",
        "triangles",
        "bodies",
        "backend",
        "schedule",
        "ms a frame",
        "device, or why it was refused",
    ];
    html.table("Frames", names, &[0, 3, 4, 6], &cells.collect::<Vec<_>>());
    Ok(())
}
