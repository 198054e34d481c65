//! The row of `step`: frames of a model on one backend and schedule.

use crate::numbers::fixed;
use crate::text_table::Column;
use serde::{Deserialize, Serialize};

/// Explains the columns.
pub(crate) const LEGEND: &str = "\
Weightless bodies that spin and are squeezed. ms: time of a frame, median over batches; a GPU gets \
a batch of frames and is waited for at its end. latency: time of a frame that is waited for. M \
proj/s: projections of stretch and bending constraints. KiB up: upload of a frame. x colors, x \
cpu: speed relative to the schedule colors on the same GPU, and to the CPU. *: the schedule that \
the backend chooses.";

/// A row of the table and of the JSON.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Row {
    pub(crate) model: String,
    pub(crate) source: String,
    /// Of one body, like vertices and constraints.
    pub(crate) triangles: usize,
    pub(crate) vertices: usize,
    pub(crate) constraints: usize,
    /// Number of bodies stepped together.
    pub(crate) bodies: u32,
    pub(crate) backend: String,
    pub(crate) device: String,
    /// Driver of the GPU; none on the CPU.
    pub(crate) driver: Option<String>,
    /// GPU schedule; `colors` on the CPU.
    pub(crate) schedule: String,
    /// Whether the backend chooses this schedule.
    pub(crate) chosen: bool,
    pub(crate) iterations: u32,
    pub(crate) substeps: u32,
    /// None for a refusal.
    #[serde(flatten)]
    pub(crate) measured: Option<Measured>,
    /// The error of a measurement.
    pub(crate) refusal: Option<String>,
    pub(crate) machine: String,
    pub(crate) commit: String,
    pub(crate) version: String,
}

/// Measurements of all bodies together.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Measured {
    /// Dispatches of a frame; none on the CPU.
    pub(crate) dispatches: Option<u32>,
    /// Number of timed frames, in batches.
    pub(crate) frames: u32,
    pub(crate) ms_per_frame: f64,
    pub(crate) ms_latency: f64,
    pub(crate) frames_per_second: f64,
    pub(crate) projections_per_second: f64,
    /// Upload of a frame without edits.
    pub(crate) bytes_uploaded: u64,
    /// Upload before the first frame.
    pub(crate) bytes_uploaded_at_start: u64,
    /// Time of the schedule `colors` on the same GPU over this time.
    pub(crate) speed_up_over_colors: Option<f64>,
    /// Time of the CPU over this time.
    pub(crate) speed_up_over_cpu: Option<f64>,
}

/// Columns of the printed table and of the report; a refusal is in the last.
pub(crate) const COLUMNS: &[Column<Row>] = &[
    ("model", |row| row.model.clone()),
    ("triangles", |row| row.triangles.to_string()),
    ("bodies", |row| row.bodies.to_string()),
    ("backend", |row| row.backend.clone()),
    ("schedule", |row| {
        format!("{}{}", row.schedule, if row.chosen { "*" } else { "" })
    }),
    ("dispatches", |row| {
        fixed(row.value(|m| m.dispatches.map(f64::from)), 0)
    }),
    ("ms", |row| fixed(row.value(|m| Some(m.ms_per_frame)), 4)),
    ("latency", |row| fixed(row.value(|m| Some(m.ms_latency)), 4)),
    ("M proj/s", |row| {
        fixed(row.value(|m| Some(m.projections_per_second / 1e6)), 1)
    }),
    ("KiB up", |row| {
        fixed(row.value(|m| Some(m.bytes_uploaded as f64 / 1024.0)), 1)
    }),
    ("x colors", |row| {
        fixed(row.value(|m| m.speed_up_over_colors), 2)
    }),
    ("x cpu", |row| fixed(row.value(|m| m.speed_up_over_cpu), 2)),
    ("source", |row| {
        row.refusal.clone().unwrap_or_else(|| row.source.clone())
    }),
];

impl Row {
    /// Returns a measured value; none for a refusal.
    fn value(&self, of: fn(&Measured) -> Option<f64>) -> Option<f64> {
        self.measured.as_ref().and_then(of)
    }
}

/// Sets the speed-ups of one model's rows.
pub(super) fn compare(rows: &mut [Row]) {
    let time = |backend: &str, schedule: &str| {
        let row = (rows.iter()).find(|row| row.backend == backend && row.schedule == schedule)?;
        row.measured.as_ref().map(|m| m.ms_per_frame)
    };
    let cpu = time("cpu", "colors");
    let colors = time("gpu", "colors");
    for row in rows.iter_mut().filter(|row| row.driver.is_some()) {
        if let Some(measured) = &mut row.measured {
            measured.speed_up_over_cpu = cpu.map(|ms| ms / measured.ms_per_frame);
            measured.speed_up_over_colors = colors.map(|ms| ms / measured.ms_per_frame);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(backend: &str, schedule: &str, ms: f64) -> Row {
        Row {
            backend: backend.to_owned(),
            driver: (backend != "cpu").then(|| "1.0".to_owned()),
            schedule: schedule.to_owned(),
            measured: Some(Measured {
                dispatches: Some(1),
                frames: 7,
                ms_per_frame: ms,
                ms_latency: ms,
                frames_per_second: 1e3 / ms,
                projections_per_second: 1e6,
                bytes_uploaded: 0,
                bytes_uploaded_at_start: 100,
                speed_up_over_colors: None,
                speed_up_over_cpu: None,
            }),
            ..Row::default()
        }
    }

    #[test]
    fn rows_are_compared_with_colors_and_with_the_cpu() {
        let mut rows = [
            row("cpu", "colors", 6.0),
            row("gpu", "whole-body", 2.0),
            row("gpu", "colors", 8.0),
        ];
        compare(&mut rows);
        let speed_ups = rows.map(|row| {
            let m = row.measured.unwrap();
            [m.speed_up_over_colors, m.speed_up_over_cpu]
        });
        let expected = [[None; 2], [Some(4.0), Some(3.0)], [Some(1.0), Some(0.75)]];
        assert_eq!(speed_ups, expected);
    }

    #[test]
    fn a_refusal_has_no_times() {
        let json = serde_json::to_value(row("gpu", "colors", 2.0)).unwrap();
        assert_eq!(json["ms_per_frame"], 2.0);
        let refused = Row {
            measured: None,
            refusal: Some("too large".to_owned()),
            ..row("gpu", "colors", 2.0)
        };
        assert_eq!(COLUMNS[12].1(&refused), "too large");
        let json = serde_json::to_value(refused).unwrap();
        assert_eq!(json["refusal"], "too large");
        assert!(json.get("ms_per_frame").is_none(), "nothing was measured");
    }
}
