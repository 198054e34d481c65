//! The paper's Algorithm 2: delete the triangles that the blade hits, rebuild the boundary, patch
//! and refine the hole, once for each side.
//!
//! | Listing | Here |
//! |---|---|
//! | lines 4 to 12, hit triangles, edges and intersection points | `bvh`, `crossing`, `strip`; [`points`] |
//! | line 14 and Algorithm A1, constraints | the solver's, from the delta |
//! | lines 15 to 16, the cutting plane | [`Sweep::plane`] |
//! | lines 17 to 19, positive and negative edges | [`lip`] |
//! | lines 20 to 25, points too close | [`points`] |
//! | line 27 and Algorithm 3, the new boundary | [`boundary`] |
//! | lines 28 to 30, triangulate and refine | `incise-refine` |
//! | line 31, the other side | both sides of every strip are lips of the same kind |
//!
//! What the listing leaves open or has wrong, and what was decided:
//!
//! - Lines 17 to 19 put every edge that is not on the positive side on the negative one, also those
//!   that the blade crosses. A crossed edge belongs to neither; an edge is on the side of both its ends.
//! - Line 24 calls the merging distance alpha, which is also the refinement threshold of Formula 2.
//!   They are two numbers here, [`CutParams::min_distance`] and alpha.
//! - The listing has one hole. Every closed strip of hit triangles has two lips with a hole each.
//! - Nothing in the listing keeps the result a manifold. It is checked, and where the paper's form
//!   fails the cut is made again in a strict form: all intersection points, in their order, each
//!   hit triangle cut along the sweep. That is a manifold whenever the input was.

mod apply;
mod boundary;
mod lip;
mod points;

use crate::crossing::Signs;
use crate::cutter::CutOutcome;
use crate::error::CutError;
use crate::params::CutParams;
use crate::strip::Strip;
use crate::sweep::Sweep;
use boundary::Boundary;
use incise_mesh::geometry::area_vector;
use incise_mesh::{Surface, Vec3, VertexId};
use incise_refine::{Patch, fill};
use lip::{Lip, lips};
use points::{PointSet, intersection_points};
use std::time::Instant;

/// A corner of a new triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
enum Corner {
    /// A vertex that the surface has.
    Old(VertexId),
    /// An intersection point, by its number in the [`PointSet`].
    Point(u32),
}

/// One side of one strip, closed: triangles between the old boundary and the rim, and the cap.
struct ClosedLip {
    walls: Vec<[Corner; 3]>,
    rim: Vec<Corner>,
    /// None when the walls close the lip by themselves.
    cap: Option<Patch>,
    piece: u32,
}

/// Cuts `surface` along `strips`. See the module.
pub(crate) fn rebuild(
    surface: &mut Surface,
    strips: &[Strip],
    signs: &Signs,
    sweep: &Sweep,
    params: &CutParams,
    outcome: &mut CutOutcome,
) -> Result<(), CutError> {
    let scale = mean_hit_edge(surface, strips);
    for strict in [false, true] {
        let points = intersection_points(
            surface,
            strips,
            signs,
            if strict {
                0.0
            } else {
                params.min_distance * scale
            },
            strict,
        );
        points.refuse_nested_loops(sweep)?;
        let mut closed = Vec::new();
        for lip in lips(surface, strips, &points) {
            closed.push(close_lip(
                surface, &points, &lip, sweep, params, scale, strict, outcome,
            )?);
        }
        match apply::apply(surface, strips, &points, &closed) {
            Ok(edit) => {
                *surface = edit.surface;
                outcome.delta = edit.delta;
                outcome.cap = edit.cap;
                outcome.report.strict = strict;
                outcome.report.refined = closed
                    .iter()
                    .all(|lip| lip.cap.as_ref().is_none_or(|cap| cap.report.converged));
                return Ok(());
            }
            Err(error) if strict => return Err(error),
            Err(_) => {}
        }
    }
    Ok(())
}

#[expect(
    clippy::too_many_arguments,
    reason = "one step of the algorithm above, apart only to be readable"
)]
fn close_lip(
    surface: &Surface,
    points: &PointSet,
    lip: &Lip,
    sweep: &Sweep,
    params: &CutParams,
    scale: f64,
    strict: bool,
    outcome: &mut CutOutcome,
) -> Result<ClosedLip, CutError> {
    // A lip without edges is a single vertex cut off, of which the paper's method would leave nothing.
    let Boundary { walls, rim } = if strict || lip.is_single_vertex() {
        boundary::strict(lip)
    } else {
        boundary::new_boundary(surface, points, lip, sweep, params, scale)
    };
    let begin = Instant::now();
    let cap = if rim.len() < 3 {
        None
    } else {
        let positions: Vec<Vec3> = rim.iter().map(|&c| points.position(surface, c)).collect();
        let joined = |i: u32, j: u32| match (rim[i as usize], rim[j as usize]) {
            (Corner::Old(a), Corner::Old(b)) => surface.topology().are_adjacent(a, b),
            _ => false,
        };
        let normal = newell(&positions);
        Some(fill(&positions, normal, &params.refine, joined)?)
    };
    outcome.report.refinement += begin.elapsed();
    Ok(ClosedLip {
        walls,
        rim,
        cap,
        piece: lip.piece,
    })
}

/// The mean edge of the hit triangles [m], to which the distances in [`CutParams`] refer.
#[expect(
    clippy::cast_precision_loss,
    reason = "far fewer than 2^53 triangles are hit"
)]
fn mean_hit_edge(surface: &Surface, strips: &[Strip]) -> f64 {
    let hits = strips.iter().flat_map(|s| &s.hits);
    let (sum, count) = hits.fold((0.0, 0usize), |(sum, count), hit| {
        let [a, b, c] = surface.triangle_positions(hit.triangle);
        let perimeter = (b - a).norm() + (c - b).norm() + (a - c).norm();
        (sum + perimeter, count + 3)
    });
    sum / count.max(1) as f64
}

/// The vector along a loop's normal, as long as twice the area that it encloses.
fn newell(points: &[Vec3]) -> Vec3 {
    (1..points.len().saturating_sub(1))
        .map(|i| area_vector([points[0], points[i], points[i + 1]]))
        .sum()
}
