//! The rows for people.

use super::row::Row;
use crate::columns::measured;
use std::io::{self, Write};

/// What stands in the columns.
pub(super) const LEGEND: &str = "\
Weightless bodies that spin and were squeezed. ms: time of a frame, the median over batches; a device is given a batch of frames at \
once and is waited for at its end. latency: time of one frame that is waited for. M proj/s: projections of stretch and bending constraints. \
KiB up: sent to the device by a frame, and before the first one. GB/s: bytes of the model (stretch 112 a projection on a device, 108 on the \
CPU; bending 216, 212; 128 a vertex and substep) by the time of a frame. share: that by the bandwidth measured in this run, of copies on the \
device and of a triad on the CPU; what stays in caches or workgroup memory makes it more than the memory really gave. \
x colors, x cpu: how many times faster than the schedule colors on the same device, than the CPU. *: the schedule that is taken by itself.";

const WIDTHS: [usize; 15] = [13, 9, 5, 7, 12, 10, 10, 9, 9, 16, 7, 8, 8, 8, 8];
/// Columns that begin at their left edge.
const LEFT: [usize; 4] = [0, 3, 4, 14];

/// The names of the columns.
pub(super) fn header(out: &mut impl Write) -> io::Result<()> {
    let names = [
        "model",
        "triangles",
        "bodies",
        "backend",
        "schedule",
        "dispatches",
        "ms",
        "latency",
        "M proj/s",
        "KiB up",
        "GB/s",
        "share",
        "x colors",
        "x cpu",
        "source",
    ];
    line(out, &names.map(str::to_owned))
}

/// One row, or why there is none.
pub(super) fn row(out: &mut impl Write, row: &Row) -> io::Result<()> {
    let mark = if row.chosen { "*" } else { "" };
    let mut cells = [
        row.model.clone(),
        row.triangles.to_string(),
        row.bodies.to_string(),
        row.backend.to_owned(),
        format!("{}{mark}", row.schedule),
    ]
    .into_iter();
    let Some(m) = &row.measured else {
        let first: Vec<String> = cells.enumerate().map(|(k, cell)| pad(k, &cell)).collect();
        let why = row.refusal.as_deref().unwrap_or("not measured");
        return writeln!(out, "{}  {why}", first.join("  "));
    };
    let rate = m.bytes_modelled as f64 / m.ms_per_frame * 1e-6;
    let share = |share: f64| format!("{:.1} %", share * 100.0);
    let optional = |x: Option<f64>, digits| measured(x.unwrap_or(f64::NAN), digits);
    let mut rest = [
        m.dispatches
            .map_or_else(|| "-".to_owned(), |n| n.to_string()),
        format!("{:.4}", m.ms_per_frame),
        format!("{:.4}", m.ms_latency),
        format!("{:.1}", m.projections_per_second / 1e6),
        format!(
            "{} + {}",
            m.bytes_uploaded.div_ceil(1024),
            m.bytes_uploaded_at_start.div_ceil(1024)
        ),
        format!("{rate:.2}"),
        m.share_of_bandwidth.map_or_else(|| "-".to_owned(), share),
        optional(m.speed_up_over_colors, 2),
        optional(m.speed_up_over_cpu, 2),
        row.source.clone(),
    ]
    .into_iter();
    let cells = std::array::from_fn(|_| cells.next().or_else(|| rest.next()).unwrap_or_default());
    line(out, &cells)
}

fn line(out: &mut impl Write, cells: &[String; WIDTHS.len()]) -> io::Result<()> {
    let padded: Vec<String> = cells
        .iter()
        .enumerate()
        .map(|(k, cell)| pad(k, cell))
        .collect();
    writeln!(out, "{}", padded.join("  ").trim_end())?;
    // A run takes long; what is known is shown.
    out.flush()
}

fn pad(column: usize, cell: &str) -> String {
    let width = WIDTHS[column];
    if LEFT.contains(&column) {
        format!("{cell:width$}")
    } else {
        format!("{cell:>width$}")
    }
}
