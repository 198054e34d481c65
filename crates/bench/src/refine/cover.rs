//! Sections covered again and again, timed and judged.

use super::rims::Rims;
use super::row::{Row, Stamp};
use crate::statistics::{mean, median};
use crate::subject::Subject;
use incise_refine::{
    Cover, CoverParams, CoverScratch, CoverSize, RefineError, RefinementLevel, cover,
};
use std::time::Instant;

/// How often each section is covered; the fastest counts.
pub(super) const REPEATS: u32 = 5;

/// One row.
pub(super) fn measure(
    subject: &Subject,
    planes: &'static str,
    level: RefinementLevel,
    rims: &[Rims],
    mut failures: Vec<String>,
    stamp: &Stamp,
) -> Result<Row, RefineError> {
    let mut scratch = CoverScratch::default();
    let (mut triangulation, mut both) = (Vec::new(), Vec::new());
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    let (mut angles, mut edges, mut worst) = (Vec::new(), Vec::new(), f64::INFINITY);
    let (mut long_edges, mut rim_angle, mut lowest) = (0, f64::INFINITY, f64::INFINITY);
    for rims in rims {
        let size = rims.size();
        let params = |size| CoverParams {
            size,
            grading: stamp.grading,
            ..CoverParams::default()
        };
        let (bare, _) = fastest(rims, &params(CoverSize::Any), &mut scratch)?;
        let (whole, cover) = fastest(rims, &params(size), &mut scratch)?;
        if let Err(fault) = cover.validate(&rims.section(), 1e-6) {
            failures.push(fault.to_string());
            continue;
        }
        let quality = cover.quality(&rims.section(), &params(size));
        triangulation.push(bare);
        both.push(whole);
        points.push(rims.points() as f64);
        triangles.push(cover.triangles.len() as f64);
        long_edges += quality.long_edges.len();
        rim_angle = rim_angle.min(quality.rim_angle);
        // What the rim's own angle rules out is no fault of the cover.
        if quality.rim_angle >= 40.0 {
            lowest = lowest.min(quality.angles[0]);
        }
        worst = worst.min(percentile(&quality.angles, 5));
        angles.extend(quality.angles);
        edges.extend(quality.edges);
    }
    angles.sort_unstable_by(f64::total_cmp);
    edges.sort_unstable_by(f64::total_cmp);
    let seconds = both.iter().sum::<f64>() / 1e3;
    let refinement: Vec<f64> = both
        .iter()
        .zip(&triangulation)
        .map(|(a, b)| a - b)
        .collect();
    Ok(Row {
        model: subject.name.clone(),
        source: subject.source.clone(),
        planes,
        level: level.z(),
        covers: both.len(),
        rim_points: middle(points),
        triangles: middle(triangles.clone()),
        triangulation_ms: middle(triangulation),
        refinement_ms: middle(refinement),
        million_triangles_a_second: triangles.iter().sum::<f64>() / seconds / 1e6,
        smallest_angle: angles.first().copied().unwrap_or(f64::NAN),
        smallest_angle_free: lowest,
        rim_angle,
        angle_5: percentile(&angles, 5),
        angle_5_worst: worst,
        angle_median: median(&angles),
        edge_mean: mean(&edges),
        edge_longest: edges.last().copied().unwrap_or(f64::NAN),
        long_edges,
        failures,
        stamp: stamp.clone(),
    })
}

/// The fastest time \[ms\] of several, and the cover.
pub(super) fn fastest(
    rims: &Rims,
    params: &CoverParams<'_>,
    scratch: &mut CoverScratch,
) -> Result<(f64, Cover), RefineError> {
    let mut best = f64::INFINITY;
    let mut result = Cover::default();
    for _ in 0..REPEATS {
        let begin = Instant::now();
        result = cover(&rims.section(), params, |_, _| false, scratch)?;
        best = best.min(begin.elapsed().as_secs_f64() * 1e3);
    }
    Ok((best, result))
}

fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    median(&values)
}

/// The value that so many percent of the sorted values do not exceed.
pub(super) fn percentile(sorted: &[f64], percent: usize) -> f64 {
    let rank = (sorted.len() * percent).div_ceil(100);
    sorted
        .get(rank.saturating_sub(1))
        .copied()
        .unwrap_or(f64::NAN)
}
