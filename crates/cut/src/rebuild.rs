//! The paper's Algorithm 2: delete the triangles that the blade hits, rebuild the boundary, patch
//! and refine the hole, once for each side.
//!
//! | Listing | Here |
//! |---|---|
//! | lines 4 to 12, hit triangles, edges and intersection points | `bvh`; [`crossing`], [`strip`], [`points`] |
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
//!   fails, that lip is made again in a plainer form: the intersection points in their order, each
//!   hit triangle cut along the sweep. With all points that is a manifold whenever the input was.
//!   A lip whose piece would be flat is made again likewise.

mod apply;
mod boundary;
mod crossing;
mod lip;
mod points;
mod separate;
mod strip;

use crate::cutter::CutOutcome;
use crate::error::CutError;
use crate::params::CutParams;
use crate::sweep::Sweep;
use apply::apply;
use boundary::Boundary;
use crossing::Signs;
use incise_mesh::geometry::area_vector;
use incise_mesh::{Surface, TriangleId, Undo, Vec3, VertexId};
use incise_refine::{Patch, RefineParams, fill, mean_rim_length};
use lip::{Lip, lips};
use points::{PointSet, intersection_points};
use separate::separate;
use std::time::{Duration, Instant};
use strip::{Strip, trace};

/// A corner of a new triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
enum Corner {
    /// A vertex that the surface has.
    Old(VertexId),
    /// An intersection point, by its number in the [`PointSet`].
    Point(u32),
}

/// A piece below this volume, in cubes of the mean hit edge, is made in a plainer form: chords
/// across a body of few triangles may leave nothing between them.
const FLAT: f64 = 1e-3;

/// How the boundary of a lip is made, the paper's way first. Each form is tried where the one
/// before did not give a manifold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    /// Algorithm 3.
    Even,
    /// Every hit triangle cut along the merged intersection points.
    Merged,
    /// Every hit triangle cut along all intersection points, none closer to a vertex than a margin.
    Strict,
}

/// One side of one strip, closed: triangles between the old boundary and the rim, and the cap.
struct ClosedLip<'a> {
    points: &'a PointSet,
    walls: Vec<[Corner; 3]>,
    rim: Vec<Corner>,
    /// None when the walls close the lip by themselves.
    cap: Option<Patch>,
    piece: u32,
}

/// The surface before the cut and how to cut it.
struct Job<'a> {
    surface: &'a Surface,
    sweep: &'a Sweep,
    params: &'a CutParams,
    /// The mean edge of the hit triangles \[m\].
    scale: f64,
}

/// Cuts `surface` along `sweep`. See the module.
///
/// # Errors
/// [`CutError`]; the surface is then bit for bit what it was.
pub(crate) fn rebuild(
    surface: &mut Surface,
    sweep: &Sweep,
    params: &CutParams,
    candidates: &mut Vec<TriangleId>,
    outcome: &mut CutOutcome,
) -> Result<(), CutError> {
    let begin = Instant::now();
    let signs = Signs::new(sweep);
    let strips = trace(surface, &signs, candidates)?;
    outcome.report.detection += begin.elapsed();
    if strips.is_empty() {
        return Ok(());
    }
    outcome.report.loops = strips.len();
    outcome.report.hits = strips.iter().map(|s| s.hits.len()).sum();
    let begin = Instant::now();
    // Asked before the edit: a piece of which nothing is left must be told, too.
    let mut pieces: Vec<u32> = strips
        .iter()
        .map(|strip| surface.piece(strip.hits[0].triangle))
        .collect();
    pieces.sort_unstable();
    pieces.dedup();
    let before = open_and_close(surface, &strips, &signs, sweep, params, outcome)?;
    for &t in &outcome.cap {
        surface.set_material(t, params.cap_material);
    }
    outcome.report.split = begin.elapsed() - outcome.report.refinement;
    let begin = Instant::now();
    separate(surface, &pieces, &mut outcome.delta);
    outcome.undo = Undo::between(&before, surface, &outcome.delta);
    outcome.report.separation = begin.elapsed();
    Ok(())
}

/// Returns the surface as it was before.
fn open_and_close(
    surface: &mut Surface,
    strips: &[Strip],
    signs: &Signs,
    sweep: &Sweep,
    params: &CutParams,
    outcome: &mut CutOutcome,
) -> Result<Surface, CutError> {
    let job = Job {
        surface,
        sweep,
        params,
        scale: mean_hit_edge(surface, strips),
    };
    let merged = intersection_points(surface, strips, signs, params.min_distance * job.scale);
    merged.refuse_nested_loops(surface, sweep)?;
    let strict = intersection_points(surface, strips, signs, 0.0);
    let [merged_lips, strict_lips] = [&merged, &strict].map(|set| lips(surface, strips, set));
    let mut forms = vec![Form::Even; merged_lips.len()];
    let close = |i: usize, form: Form, time: &mut Duration| {
        let mut refine = params.refine;
        if form != Form::Strict {
            return job.close(&merged, &merged_lips[i], form, &refine, time);
        }
        // All points make a rim of tiny edges, which is no reason for a cap of tiny triangles.
        let length = mean_rim_length(&merged.outline(&merged_lips[i].points));
        refine.rim_length = refine.rim_length.or((length > 0.0).then_some(length));
        job.close(&strict, &strict_lips[i], form, &refine, time)
    };
    let time = &mut outcome.report.refinement;
    let mut closed = (0..forms.len())
        .map(|i| close(i, Form::Even, time))
        .collect::<Result<Vec<_>, _>>()?;
    let flat = FLAT * job.scale.powi(3);
    let edit = loop {
        let (edit, lips) = match apply(surface, strips, &closed) {
            Ok(edit) => {
                let lips = edit.flat_lips(flat);
                (Ok(edit), lips)
            }
            Err(failure) => (Err(failure.error), failure.lips),
        };
        let mut changed = false;
        for i in lips {
            forms[i] = match forms[i] {
                Form::Even => Form::Merged,
                Form::Merged => Form::Strict,
                Form::Strict => continue,
            };
            closed[i] = close(i, forms[i], time)?;
            changed = true;
        }
        if !changed {
            break edit?;
        }
    };
    outcome.delta = edit.delta;
    outcome.cap = edit.cap;
    outcome.report.strict_lips = forms.iter().filter(|&&f| f != Form::Even).count();
    outcome.report.refined = closed
        .iter()
        .all(|lip| lip.cap.as_ref().is_none_or(|cap| cap.report.converged));
    Ok(std::mem::replace(surface, edit.surface))
}

impl Job<'_> {
    fn close<'p>(
        &self,
        points: &'p PointSet,
        lip: &Lip,
        form: Form,
        refine: &RefineParams,
        time: &mut Duration,
    ) -> Result<ClosedLip<'p>, CutError> {
        // Algorithm 3 starts from edges; of a lip that is a single vertex it would leave nothing.
        let Boundary { walls, rim } = if form == Form::Even && !lip.is_single_vertex() {
            boundary::new_boundary(self, points, lip)
        } else {
            boundary::along_points(lip)
        };
        let begin = Instant::now();
        let cap = if rim.len() < 3 {
            None
        } else {
            let positions: Vec<Vec3> = rim
                .iter()
                .map(|&c| points.position(self.surface, c))
                .collect();
            let joined = |i: u32, j: u32| self.joined(rim[i as usize], rim[j as usize]);
            let normal = newell(&positions);
            Some(fill(&positions, normal, refine, joined)?)
        };
        *time += begin.elapsed();
        Ok(ClosedLip {
            points,
            walls,
            rim,
            cap,
            piece: lip.piece,
        })
    }

    /// Whether the surface has an edge between two corners.
    fn joined(&self, a: Corner, b: Corner) -> bool {
        match (a, b) {
            (Corner::Old(a), Corner::Old(b)) => self.surface.topology().are_adjacent(a, b),
            _ => false,
        }
    }
}

/// The mean edge of the hit triangles \[m\], to which the distances in [`CutParams`] refer.
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
