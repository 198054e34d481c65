//! One model, a plane through its middle and many at random.

use super::outcome::Outcomes;
use super::row::{Row, Stamp};
use super::specimen::Specimen;
use super::times::Times;
use crate::directions::{Directions, GENERIC, SPREAD};
use crate::subject::Subject;
use incise_cut::{CutParams, Sweep};
use incise_mesh::Vec3;
use std::error::Error;

/// How often the plane through the middle is measured.
const REPEATS: u32 = 15;

/// The plane through the middle and the seeded ones, a row each.
pub(super) fn measure(
    subject: &Subject,
    params: &CutParams,
    planes: u32,
    stamp: &Stamp,
) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut specimen = Specimen::new(subject.surface()?)?;
    let mut directions = Directions(stamp.seed);
    let generic = Vec3::from(GENERIC).normalize();
    // The first cut has arrays grow.
    run(&mut specimen, params, [(generic, 0.0)])?;
    let repeated = (0..REPEATS).map(|_| (generic, 0.0));
    let middle = run(&mut specimen, params, repeated)?;
    let seeded = (0..planes).map(|_| (directions.next_unit(), SPREAD * directions.next()));
    let seeded = run(&mut specimen, params, seeded)?;
    let triangles = specimen.surface.topology().triangle_count();
    let rows = [("middle", middle), ("seeded", seeded)].into_iter();
    let rows = rows.filter(|(name, _)| planes > 0 || *name == "middle");
    Ok(rows
        .map(|(planes, outcomes)| {
            let [ms_median, ms_p99] = Times::summary(&outcomes.times);
            let [hits, cap_triangles] = outcomes.medians();
            Row {
                model: subject.name.clone(),
                family: subject.family,
                source: subject.source.clone(),
                planes,
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
        })
        .collect())
}

/// Cuts along planes, each a direction and where between the body's ends (-1 and 1) it lies, always
/// the whole body.
fn run(
    specimen: &mut Specimen,
    params: &CutParams,
    planes: impl IntoIterator<Item = (Vec3, f64)>,
) -> Result<Outcomes, Box<dyn Error>> {
    let mut outcomes = Outcomes::default();
    for (normal, part) in planes {
        let [low, high] = specimen.reach(normal);
        let d = (low + high) / 2.0 + part * (high - low) / 2.0;
        let sweep = Sweep::across_box(normal.into(), d, &specimen.surface.bounds())?;
        match specimen.cut(&sweep, params)? {
            Ok(Some(cut)) => {
                outcomes.add(&cut);
                specimen.undo(cut)?;
            }
            Ok(None) => outcomes.missed += 1,
            Err(error) => outcomes.fail(error, [normal.x, normal.y, normal.z, d]),
        }
    }
    Ok(outcomes)
}
