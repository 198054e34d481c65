//! What is claimed and whether it holds: stability and skip; and how near motions come to what they should be.

use super::chart::{Chart, Series};
use super::error::PageError;
use super::html::Html;
use super::numbers::brief;
use super::rows::{AccuracyRow, SkipRow, StabilityRow};
use crate::columns::count;
use crate::front::front;
use plotters::chart::SeriesLabelPosition;

fn verdict(passed: bool) -> String {
    if passed { "passed" } else { "failed" }.to_owned()
}

/// How many hold, and the others by name.
fn sum(html: &mut Html, what: &str, passed: impl Iterator<Item = bool>) {
    let all: Vec<bool> = passed.collect();
    let failed = all.iter().filter(|&&passed| !passed).count();
    html.paragraph(&format!(
        "{} of {} fail{}.",
        failed,
        count(all.len(), what),
        if failed == 0 { "" } else { ", marked below" }
    ));
}

/// Laws of stability.
pub(super) fn stability(html: &mut Html, rows: &[StabilityRow]) {
    sum(html, "law", rows.iter().map(|row| row.passed));
    let cells = rows.iter().map(|row| {
        let cells = [
            row.id.clone(),
            row.torture.clone(),
            row.law.clone(),
            row.at.clone(),
            row.backend.clone(),
            brief(row.bound),
            brief(row.worst),
            verdict(row.passed),
        ];
        (cells, !row.passed)
    });
    let names = [
        "case",
        "torture",
        "law",
        "where the worst was",
        "backend",
        "bound",
        "worst",
        "verdict",
    ];
    html.table("", names, &[0, 1, 2, 3, 4, 7], &cells.collect::<Vec<_>>());
}

/// Claims of what costs nothing.
pub(super) fn skip(html: &mut Html, rows: &[SkipRow]) {
    sum(html, "claim", rows.iter().map(|row| row.passed));
    let cells = rows.iter().map(|row| {
        let cells = [
            row.skip.clone(),
            row.claim.clone(),
            row.at.clone(),
            brief(row.bound),
            brief(row.measured),
            verdict(row.passed),
        ];
        (cells, !row.passed)
    });
    let names = [
        "left out", "claim", "found on", "bound", "measured", "verdict",
    ];
    html.table("", names, &[0, 1, 2, 5], &cells.collect::<Vec<_>>());
}

/// Whether a row is of a way of stepping.
type Is = fn(&AccuracyRow) -> bool;

/// Ways of stepping, as the plots of `accuracy` have them.
const WAYS: [(&str, Is); 5] = [
    ("xpbd", |row| row.scheme == "xpbd"),
    ("the paper's (pbd, one substep)", |row| {
        row.scheme == "pbd" && row.substeps == 1
    }),
    ("pbd", |row| row.scheme == "pbd" && row.substeps != 1),
    ("xpbd, half of own weight", |row| row.scheme == "xpbd-half"),
    ("the same, of second order", |row| {
        row.scheme == "xpbd-half-bdf2"
    }),
];

/// A chart for each scene and backend: time against error, and the least error for the time.
pub(super) fn accuracy(html: &mut Html, rows: &[&AccuracyRow]) -> Result<(), PageError> {
    let mut scenes: Vec<[&str; 2]> = Vec::new();
    for row in rows {
        let scene = [row.scene.as_str(), row.backend.as_str()];
        if !scenes.contains(&scene) {
            scenes.push(scene);
        }
    }
    let mut figures = Vec::new();
    for [scene, backend] in scenes {
        let series = WAYS.map(|(name, is)| {
            let of_way = rows
                .iter()
                .filter(|row| row.scene == scene && row.backend == backend && is(row));
            let points: Vec<[f64; 2]> = of_way
                .filter_map(|row| Some([row.ms_per_frame, row.total_error.as_ref()?.position?]))
                .filter(|p| p.iter().all(|x| x.is_finite() && *x > 0.0))
                .collect();
            Series {
                name: name.to_owned(),
                line: front(points.iter().copied()),
                points,
            }
        });
        let mut series = series.to_vec();
        series.retain(|series| !series.points.is_empty());
        if series.is_empty() {
            continue;
        }
        let svg = Chart {
            across: "ms a frame",
            along: "error of positions [mean edges]",
            log_across: true,
            names: SeriesLabelPosition::LowerLeft,
            series,
        }
        .half_svg()?;
        figures.push((svg, format!("{scene}, {backend}")));
    }
    html.beside(|html| {
        for (svg, caption) in &figures {
            html.figure(svg, caption, false);
        }
    });
    Ok(())
}
