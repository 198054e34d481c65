//! Cuts of one model by the plane through its middle and by seeded ones.

use super::body::{CutBody, Outcomes};
use super::times::Times;
use crate::method::Method;
use crate::workload::Workload;
use incise_models::scenes::RelativePlane;
use serde::Serialize;
use std::error::Error;

/// Repetitions of the plane through the middle.
const REPEATS: usize = 15;

/// Cuts of one model along one plane or many.
#[derive(Debug, Serialize)]
pub(super) struct Row {
    kind: &'static str,
    family: Option<&'static str>,
    source: String,
    /// `middle`: the plane through the middle, repeated; `seeded`: seeded planes.
    planes: &'static str,
    triangles: usize,
    /// Hit triangles, median.
    hits: f64,
    /// Triangles of both caps, median.
    cap_triangles: f64,
    pub(super) cuts: usize,
    /// Number of planes without a hit.
    missed: usize,
    /// Errors of cuts, with their planes.
    pub(super) failures: Vec<String>,
    ms_median: Times,
    ms_p99: Times,
}

/// Returns a row for the plane through the middle and one for the seeded planes.
///
/// # Errors
/// An error of the solver or of an undo; errors of cuts are recorded.
pub(super) fn measure(
    workload: &Workload,
    method: &Method,
    planes: u32,
    seed: u64,
) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut body = CutBody::new(workload.surface()?)?;
    let triangles = body.surface.topology().triangle_count();
    let mut run = |planes: &[RelativePlane]| -> Result<Outcomes, Box<dyn Error>> {
        let mut outcomes = Outcomes::default();
        for plane in planes {
            let (sweep, d) = plane.sweep(&body.surface)?;
            let [x, y, z] = plane.normal.into();
            body.probe((&sweep, [x, y, z, d]), method, &mut outcomes)?;
        }
        Ok(outcomes)
    };
    // The first cut grows buffers.
    run(&[RelativePlane::middle()])?;
    let mut all = vec![("middle", run(&[RelativePlane::middle(); REPEATS])?)];
    if planes > 0 {
        all.push(("seeded", run(&RelativePlane::seeded(seed, planes))?));
    }
    let rows = all.into_iter().map(|(planes, outcomes)| {
        let [hits, cap_triangles] = outcomes.medians();
        Row {
            kind: "cut",
            family: workload.family,
            source: workload.source.clone(),
            planes,
            triangles,
            hits,
            cap_triangles,
            cuts: outcomes.times.len(),
            missed: outcomes.missed,
            ms_median: Times::percentile(&outcomes.times, 50),
            ms_p99: Times::percentile(&outcomes.times, 99),
            failures: outcomes.failures,
        }
    });
    Ok(rows.collect())
}
