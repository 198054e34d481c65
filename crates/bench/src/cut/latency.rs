//! Time of a small cut after many others of the same body.
//!
//! Tips of a ball are sliced off repeatedly. At some stages slices that hit about the same number
//! of triangles are measured and undone. The tips are moved away first, because they would lie in
//! the way of the next slices. Caps are uniform.

use super::Parameters;
use super::body::{CutBody, Outcomes, StageTimes};
use incise_cut::Sweep;
use incise_mesh::{TriangleId, Vec3, cube_sphere};
use incise_models::scenes::Directions;
use serde::Serialize;
use std::error::Error;

/// Name of the ball.
pub(super) const MODEL: &str = "Sphere49152";
/// Squares along an edge of the ball's cube.
const QUADS: u32 = 64;
/// Number of triangles that a slice hits.
const HITS: usize = 120;
/// Largest difference from [`HITS`].
const TOLERANCE: usize = 12;
/// Slices per stage.
const PROBES: usize = 100;
/// Directions tried per slice.
const ATTEMPTS: u32 = 100;
/// Numbers of cuts after which slices are measured, besides the last.
const STAGES: [u32; 3] = [1, 100, 1000];

/// Cuts with about equal hits, of a body with many earlier cuts.
#[derive(Debug, Serialize)]
pub(super) struct Row {
    kind: &'static str,
    cuts_before: u32,
    triangles: usize,
    pieces: u32,
    pub(super) probes: usize,
    hits: f64,
    hits_from: f64,
    hits_to: f64,
    pub(super) failures: Vec<String>,
    ms_median: StageTimes,
    ms_p99: StageTimes,
    /// 99th percentile of the total, relative to the first stage.
    p99_ratio: f64,
}

/// Returns a row for every stage up to `cuts`.
///
/// # Errors
/// An error of the solver or of an undo, or a body too small for another slice.
pub(super) fn measure(parameters: &Parameters, cuts: u32) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut body = CutBody::new(cube_sphere(QUADS, 0.5), parameters)?;
    let mut directions = Directions(parameters.seed);
    // The ball keeps its piece number: it has the most triangles.
    let piece = body.surface.piece(TriangleId(0));
    body.only_piece = Some(piece);
    let bounds = body.surface.bounds();
    let mut near = body.surface.piece_bound();
    let mut rows: Vec<Row> = Vec::new();
    for cut in 1..=cuts {
        let Some((normal, d)) = slice(&body, piece, &mut directions) else {
            return Err(format!("after {cut} cuts no slice hits {HITS} triangles").into());
        };
        // A failed cut shows among the measured slices.
        let _ = body.cut(&Sweep::from_plane(normal.into(), d, &bounds)?)?;
        if !STAGES.contains(&cut) && cut != cuts {
            continue;
        }
        body.push_away(near);
        near = body.surface.piece_bound();
        // Found before the first cut: the search reads the whole body and fills the caches.
        let slices: Vec<(Vec3, f64)> = (0..PROBES)
            .map_while(|_| slice(&body, piece, &mut directions))
            .collect();
        let mut outcomes = Outcomes::default();
        for (normal, d) in slices {
            let sweep = Sweep::from_plane(normal.into(), d, &bounds)?;
            body.probe(&sweep, normal, d, &mut outcomes)?;
        }
        let [ms_median, ms_p99] = [50, 99].map(|p| StageTimes::percentile(&outcomes.times, p));
        let first = rows.first().map_or(ms_p99, |row| row.ms_p99);
        rows.push(Row {
            kind: "latency",
            cuts_before: cut,
            triangles: body.surface.topology().triangle_count(),
            pieces: body.surface.piece_bound(),
            probes: outcomes.times.len(),
            hits: outcomes.medians()[0],
            hits_from: outcomes.hits.iter().copied().fold(f64::INFINITY, f64::min),
            hits_to: outcomes.hits.iter().copied().fold(0.0, f64::max),
            failures: outcomes.failures,
            ms_median,
            ms_p99,
            p99_ratio: ms_p99.total() / first.total(),
        });
    }
    Ok(rows)
}

/// Returns normal and distance of a plane that slices off a tip and hits about [`HITS`] triangles,
/// found by bisection; none when no direction has one.
fn slice(body: &CutBody, piece: u32, directions: &mut Directions) -> Option<(Vec3, f64)> {
    let surface = &body.surface;
    for _ in 0..ATTEMPTS {
        let normal = directions.next_unit();
        let triangles = surface.topology().triangles();
        let heights = triangles.filter(|&t| surface.piece(t) == piece).map(|t| {
            let [a, b, c] = surface.triangle_positions(t).map(|p| normal.dot(&p));
            [a.min(b).min(c), a.max(b).max(c)]
        });
        let heights: Vec<[f64; 2]> = heights.collect();
        let low = heights.iter().map(|h| h[0]).fold(f64::INFINITY, f64::min);
        let high = (heights.iter().map(|h| h[1])).fold(f64::NEG_INFINITY, f64::max);
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
