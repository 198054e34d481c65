//! A row of the table, as JSON.

use serde::Serialize;

/// A row of the table.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Row {
    pub(crate) model: &'static str,
    pub(crate) source: String,
    pub(crate) vertices: usize,
    pub(crate) particles: usize,
    pub(crate) triangles: usize,
    /// Triangles after the last cut of PBD + CS.
    pub(crate) triangles_after: usize,
    /// What was asked for.
    pub(crate) backend: &'static str,
    /// What moved the body: the machine, or the device's name.
    pub(crate) device: String,
    /// How the device steps the body at the start; none on the CPU.
    pub(crate) schedule: Option<&'static str>,
    /// Sent to the device by the frame of a cut, the mean; none on the CPU.
    pub(crate) bytes_uploaded_a_cut: Option<f64>,
    /// Brought from the device by the frame of a cut, the mean; none on the CPU.
    pub(crate) bytes_read_a_cut: Option<f64>,
    /// Whether sweeps that miss the body's box were skipped.
    pub(crate) skips_far_sweeps: bool,
    pub(crate) pbd_fps: f64,
    pub(crate) pbd_cs_fps: f64,
    /// The same of every simulated second; none of one without a frame that was timed.
    pub(crate) pbd_fps_by_second: Vec<Option<f64>>,
    pub(crate) pbd_cs_fps_by_second: Vec<Option<f64>>,
    pub(crate) fps_difference_percent: f64,
    pub(crate) cut_ms_mean: f64,
    pub(crate) cut_ms_p99: f64,
    pub(crate) cuts: usize,
    pub(crate) cuts_refused: Vec<String>,
    pub(crate) stretch_error_percent: f64,
    pub(crate) volume_error_percent: f64,
    pub(crate) cap_min_angle_deg: f64,
    /// Heap allocations in all frames without a cut together, the first of a run left out.
    pub(crate) allocations: usize,
    pub(crate) machine: String,
    pub(crate) commit: String,
    pub(crate) version: &'static str,
    pub(crate) dt: f64,
    pub(crate) iterations: u32,
    pub(crate) seconds: f64,
    pub(crate) method: &'static str,
    pub(crate) level: f64,
    pub(crate) seed: u64,
    /// Whether pieces keep their volumes.
    pub(crate) volume: bool,
    /// Whether struts hold bodies from inside.
    pub(crate) struts: bool,
    /// Whether pieces touch each other.
    pub(crate) contacts: bool,
}
