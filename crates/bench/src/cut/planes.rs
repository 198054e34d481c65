//! Cuts of one model by the plane through its middle and by seeded ones.

use super::body::{CutBody, Outcomes};
use super::row::{Row, Stamp};
use super::times::Times;
use crate::workload::Workload;
use incise_cut::CutParams;
use incise_models::scenes::RelativePlane;
use std::error::Error;

/// Repetitions of the plane through the middle.
const REPEATS: usize = 15;

/// Returns a row for the plane through the middle and one for the seeded planes.
///
/// # Errors
/// An error of the solver or of an undo; errors of cuts are recorded.
pub(super) fn measure(
    workload: &Workload,
    params: &CutParams,
    planes: u32,
    stamp: &Stamp,
) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut body = CutBody::new(workload.surface()?)?;
    let triangles = body.surface.topology().triangle_count();
    let mut run = |planes: &[RelativePlane]| -> Result<Outcomes, Box<dyn Error>> {
        let mut outcomes = Outcomes::default();
        for plane in planes {
            let (sweep, d) = plane.sweep(&body.surface)?;
            let [x, y, z] = plane.normal.into();
            body.probe((&sweep, [x, y, z, d]), params, &mut outcomes)?;
        }
        Ok(outcomes)
    };
    // The first cut grows buffers.
    run(&[RelativePlane::middle()])?;
    let mut all = vec![("middle", run(&[RelativePlane::middle(); REPEATS])?)];
    if planes > 0 {
        all.push(("seeded", run(&RelativePlane::seeded(stamp.seed, planes))?));
    }
    let rows = all.into_iter().map(|(planes, outcomes)| {
        let [ms_median, ms_p99] = Times::summary(&outcomes.times);
        let [hits, cap_triangles] = outcomes.medians();
        Row {
            model: workload.name.clone(),
            family: workload.family.map(str::to_owned),
            source: workload.source.clone(),
            planes: planes.to_owned(),
            triangles,
            hits,
            cap_triangles,
            cuts: outcomes.times.len(),
            missed: outcomes.missed,
            failures: outcomes.failures,
            ms_median,
            ms_p99,
            stamp: stamp.clone(),
        }
    });
    Ok(rows.collect())
}
