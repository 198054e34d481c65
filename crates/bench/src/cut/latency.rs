//! Whether a cut takes longer after many others: tips of a ball are sliced off again and again, and
//! now and then slices that hit about as many triangles are measured and taken back.

use super::outcome::Outcomes;
use super::row::{Latency, Stamp};
use super::specimen::Specimen;
use super::times::Times;
use crate::directions::Directions;
use incise_cut::{CutParams, Sweep};
use incise_mesh::{Vec3, cube_sphere};
use std::error::Error;

/// Squares along an edge of the cube that the ball is blown up from: 49,152 triangles.
const QUADS: u32 = 64;
/// Triangles that a slice is to hit.
const HITS: usize = 120;
/// How far from that it may be, as a part.
const TOLERANCE: f64 = 0.1;
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
    let params = CutParams {
        only_piece: Some(specimen.surface.piece(incise_mesh::TriangleId(0))),
        ..*params
    };
    let mut rows: Vec<Latency> = Vec::new();
    for cut in 1..=cuts {
        let Some((sweep, _)) = slice(&specimen, &params, &mut directions)? else {
            break;
        };
        // A slice that cannot be cut is seen among those that are measured.
        let _ = specimen.cut(&sweep, &params)?;
        if STAGES.contains(&cut) || cut == cuts {
            let outcomes = probe(&mut specimen, &params, &mut directions)?;
            let [ms_median, ms_p99] = Times::summary(&outcomes.times);
            let first = rows.first().map_or(ms_p99, |row| row.ms_p99);
            rows.push(Latency {
                model: "Sphere49152".to_owned(),
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

/// Measures slices and takes each back.
fn probe(
    specimen: &mut Specimen,
    params: &CutParams,
    directions: &mut Directions,
) -> Result<Outcomes, Box<dyn Error>> {
    let mut outcomes = Outcomes::default();
    for _ in 0..PROBES {
        let Some((sweep, plane)) = slice(specimen, params, directions)? else {
            break;
        };
        match specimen.cut(&sweep, params)? {
            Ok(Some(cut)) => {
                outcomes.add(&cut);
                specimen.undo(cut)?;
            }
            Ok(None) => outcomes.missed += 1,
            Err(error) => outcomes.fail(error, plane),
        }
    }
    Ok(outcomes)
}

/// A plane in the next direction that slices off a tip and meets about as many triangles as it should,
/// found by halving; none when no direction has one.
fn slice(
    specimen: &Specimen,
    params: &CutParams,
    directions: &mut Directions,
) -> Result<Option<(Sweep, [f64; 4])>, Box<dyn Error>> {
    let mut found = Vec::new();
    for _ in 0..ATTEMPTS {
        let normal: Vec3 = directions.next_unit();
        let [low, high] = specimen.reach(normal, params.only_piece);
        let (mut inner, mut outer) = ((low + high) / 2.0, high);
        for _ in 0..40 {
            let d = (inner + outer) / 2.0;
            let sweep = Sweep::across_box(normal.into(), d, &specimen.surface.bounds())?;
            found.clear();
            specimen
                .cutter
                .bvh()
                .query(&specimen.surface, &sweep, &mut found);
            found.retain(|&t| Some(specimen.surface.piece(t)) == params.only_piece);
            if (found.len() as f64 / HITS as f64 - 1.0).abs() < TOLERANCE {
                return Ok(Some((sweep, [normal.x, normal.y, normal.z, d])));
            }
            if found.len() > HITS {
                inner = d;
            } else {
                outer = d;
            }
        }
    }
    Ok(None)
}
