//! Whether a cut takes longer after many others: tips of a ball are sliced off again and again, and
//! now and then slices that hit about as many triangles are measured and taken back. Before that the tips
//! are moved away: where they were they would lie in the way of the next slices.

use super::outcome::Outcomes;
use super::row::{Latency, Stamp};
use super::specimen::Specimen;
use super::times::Times;
use crate::directions::Directions;
use incise_cut::{CutParams, Sweep};
use incise_mesh::{Aabb, TriangleId, Vec3, cube_sphere};
use std::error::Error;

/// The ball's name.
pub(super) const MODEL: &str = "Sphere49152";
/// Squares along an edge of the cube that the ball is blown up from: 49,152 triangles.
const QUADS: u32 = 64;
/// Triangles that a slice is to hit.
const HITS: usize = 120;
/// How far from that it may be.
const TOLERANCE: usize = 12;
/// Slices measured at a time.
const PROBES: usize = 100;
/// Directions that are tried for a slice before the body counts as used up.
const ATTEMPTS: u32 = 100;
/// The cuts after which slices are measured, besides the last.
const STAGES: [u32; 3] = [1, 100, 1000];

/// Rows for the stages up to `cuts`.
pub(super) fn measure(
    params: &CutParams,
    cuts: u32,
    stamp: &Stamp,
) -> Result<Vec<Latency>, Box<dyn Error>> {
    let mut specimen = Specimen::new(cube_sphere(QUADS, 0.5))?;
    let mut directions = Directions(stamp.seed);
    // What slices leave of the ball keeps its number: it has the most triangles.
    let piece = specimen.surface.piece(TriangleId(0));
    let params = CutParams {
        only_piece: Some(piece),
        ..*params
    };
    let ball = specimen.surface.bounds();
    let mut near = specimen.surface.piece_bound();
    let mut rows: Vec<Latency> = Vec::new();
    for cut in 1..=cuts {
        let Some((normal, d)) = slice(&specimen, piece, &mut directions) else {
            return Err(format!("after {cut} cuts no slice hits {HITS} triangles").into());
        };
        let sweep = Sweep::across_box(normal.into(), d, &ball)?;
        // A slice that cannot be cut is seen among those that are measured.
        let _ = specimen.cut(&sweep, &params)?;
        if STAGES.contains(&cut) || cut == cuts {
            specimen.push_away(near);
            near = specimen.surface.piece_bound();
            let outcomes = probe(&mut specimen, piece, &ball, &params, &mut directions)?;
            let [ms_median, ms_p99] = Times::summary(&outcomes.times);
            let first = rows.first().map_or(ms_p99, |row| row.ms_p99);
            rows.push(Latency {
                model: MODEL.to_owned(),
                cuts_before: cut,
                triangles: specimen.surface.topology().triangle_count(),
                pieces: specimen.surface.piece_bound(),
                probes: outcomes.times.len(),
                hits: outcomes.medians()[0],
                hits_from: outcomes.hits.iter().copied().fold(f64::INFINITY, f64::min),
                hits_to: outcomes.hits.iter().copied().fold(0.0, f64::max),
                failures: outcomes.failures,
                ms_median,
                ms_p99,
                p99_ratio: ms_p99.total / first.total,
                stamp: stamp.clone(),
            });
        }
    }
    Ok(rows)
}

/// Measures slices and takes each back, so that all of them fit the same body. They are found before the
/// first: the search reads the whole body, and what it leaves in the caches is no matter of cuts.
fn probe(
    specimen: &mut Specimen,
    piece: u32,
    ball: &Aabb,
    params: &CutParams,
    directions: &mut Directions,
) -> Result<Outcomes, Box<dyn Error>> {
    let mut outcomes = Outcomes::default();
    let slices: Vec<(Vec3, f64)> = (0..PROBES)
        .map_while(|_| slice(specimen, piece, directions))
        .collect();
    for (normal, d) in slices {
        let sweep = Sweep::across_box(normal.into(), d, ball)?;
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

/// A plane in the next direction that slices off a tip and hits about as many triangles as it should,
/// found by halving, as direction and distance; none when no direction has one.
fn slice(specimen: &Specimen, piece: u32, directions: &mut Directions) -> Option<(Vec3, f64)> {
    let surface = &specimen.surface;
    for _ in 0..ATTEMPTS {
        let normal = directions.next_unit();
        // The heights of every triangle, once for all halvings.
        let triangles = surface.topology().triangles();
        let heights = triangles.filter(|&t| surface.piece(t) == piece).map(|t| {
            let [a, b, c] = surface.triangle_positions(t).map(|p| normal.dot(&p));
            [a.min(b).min(c), a.max(b).max(c)]
        });
        let heights: Vec<[f64; 2]> = heights.collect();
        let low = heights.iter().map(|h| h[0]).fold(f64::INFINITY, f64::min);
        let high = heights
            .iter()
            .map(|h| h[1])
            .fold(f64::NEG_INFINITY, f64::max);
        let (mut inner, mut outer) = ((low + high) / 2.0, high);
        for _ in 0..30 {
            let d = (inner + outer) / 2.0;
            let hits = heights.iter().filter(|h| h[0] < d && d < h[1]).count();
            if hits.abs_diff(HITS) <= TOLERANCE {
                return Some((normal, d));
            }
            if hits > HITS {
                inner = d;
            } else {
                outer = d;
            }
        }
    }
    None
}
