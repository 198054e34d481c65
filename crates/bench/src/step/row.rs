//! What is known of a model on a backend.

use serde::Serialize;

/// A row of the table, and an object of the JSON.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Row {
    pub(super) model: String,
    pub(super) source: String,
    /// Of one body, like vertices and constraints.
    pub(super) triangles: usize,
    pub(super) vertices: usize,
    pub(super) constraints: usize,
    /// Bodies stepped together.
    pub(super) bodies: u32,
    pub(super) backend: &'static str,
    pub(super) device: String,
    /// The device's; none on the CPU.
    pub(super) driver: Option<String>,
    /// What the device was asked for; `colors` on the CPU, which knows no other.
    pub(super) schedule: &'static str,
    /// Whether the backend takes this schedule by itself.
    pub(super) chosen: bool,
    pub(super) iterations: u32,
    pub(super) substeps: u32,
    /// Left out where there is a refusal.
    #[serde(flatten)]
    pub(super) measured: Option<Measured>,
    /// Why nothing was measured.
    pub(super) refusal: Option<String>,
    pub(super) machine: String,
    pub(super) commit: String,
    pub(super) version: &'static str,
}

/// What was measured; everything of all bodies together.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Measured {
    /// Of a frame; none on the CPU.
    pub(super) dispatches: Option<u32>,
    /// Frames that were timed, in batches.
    pub(super) frames: u32,
    pub(super) ms_per_frame: f64,
    pub(super) ms_latency: f64,
    pub(super) frames_per_second: f64,
    pub(super) projections_per_second: f64,
    /// By a frame when nothing is edited.
    pub(super) bytes_uploaded: u64,
    /// Before the first frame: the bodies and what steps them.
    pub(super) bytes_uploaded_at_start: u64,
    /// By a frame, see the byte model.
    pub(super) bytes_modelled: u64,
    /// Of the memory that the bodies lie in, measured in this run.
    pub(super) bandwidth_bytes_per_second: Option<f64>,
    pub(super) share_of_bandwidth: Option<f64>,
    /// Time of the schedule `colors` on the same device by this one's.
    pub(super) speed_up_over_colors: Option<f64>,
    /// Time of the CPU by this one's.
    pub(super) speed_up_over_cpu: Option<f64>,
}

/// Compares the rows of one model with each other.
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
pub(super) mod tests {
    use super::*;

    pub(in super::super) fn row(backend: &'static str, schedule: &'static str, ms: f64) -> Row {
        Row {
            model: "Sphere20".to_owned(),
            source: "built-in".to_owned(),
            triangles: 20,
            vertices: 12,
            constraints: 60,
            bodies: 1,
            backend,
            device: "D".to_owned(),
            driver: (backend != "cpu").then(|| "1.0".to_owned()),
            schedule,
            chosen: true,
            iterations: 10,
            substeps: 1,
            measured: Some(Measured {
                dispatches: Some(1),
                frames: 7,
                ms_per_frame: ms,
                ms_latency: ms,
                frames_per_second: 1e3 / ms,
                projections_per_second: 1e6,
                bytes_uploaded: 0,
                bytes_uploaded_at_start: 100,
                bytes_modelled: 1000,
                bandwidth_bytes_per_second: Some(1e9),
                share_of_bandwidth: Some(0.5),
                speed_up_over_colors: None,
                speed_up_over_cpu: None,
            }),
            refusal: None,
            machine: "M".to_owned(),
            commit: "c".to_owned(),
            version: "0",
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
        let ups = rows.map(|row| {
            let m = row.measured.unwrap();
            (m.speed_up_over_colors, m.speed_up_over_cpu)
        });
        assert_eq!(
            ups,
            [
                (None, None),
                (Some(4.0), Some(3.0)),
                (Some(1.0), Some(0.75))
            ]
        );
    }

    #[test]
    fn json_has_the_fields_that_are_asked_for() {
        let json = serde_json::to_value(row("gpu", "colors", 2.0)).unwrap();
        for name in [
            "model",
            "triangles",
            "backend",
            "device",
            "schedule",
            "dispatches",
            "ms_per_frame",
            "projections_per_second",
            "bytes_uploaded",
            "share_of_bandwidth",
        ] {
            assert!(!json[name].is_null(), "{name}");
        }
        assert_eq!(json["ms_per_frame"], 2.0);
        let refused = Row {
            measured: None,
            refusal: Some("too large".to_owned()),
            ..row("gpu", "colors", 2.0)
        };
        let json = serde_json::to_value(refused).unwrap();
        assert_eq!(json["refusal"], "too large");
        assert!(json.get("ms_per_frame").is_none(), "nothing was measured");
    }
}
