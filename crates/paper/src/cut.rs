//! The paper's Algorithm 2: deletes the triangles that the sweep crosses, builds a new boundary,
//! patches and refines the hole, once for each side.
//!
//! | Listing | Here |
//! |---|---|
//! | lines 4 to 12, intersection | [`Cutter::intersect`], [`strip`], [`points`] |
//! | line 10, removal of the hit triangles | [`mod@apply`] |
//! | line 14 and Algorithm A1, constraints | the solver's, from the delta |
//! | lines 15 to 16, the cutting plane | [`Sweep::plane`] |
//! | lines 17 to 19, positive and negative edges | [`mod@sides`] |
//! | lines 20 to 25, points too close | [`points`] |
//! | line 27 and Algorithm 3, the new boundary | [`boundary`] |
//! | lines 28 to 29, triangulate and refine | [`mod@crate::patch`] |
//! | lines 26 and 30, new vertices and triangles | [`mod@apply`] |
//! | line 31, the other side | both sides of every strip are [`sides::Side`]s |
//!
//! Gaps and errors of the listing, and the decisions taken:
//!
//! - Lines 17 to 19 put every edge that is not on the positive side on the negative one, also those
//!   that the blade crosses. A crossed edge belongs to neither; an edge is on the side of both its
//!   ends.
//! - Line 24 calls the merging distance alpha, which is also the refinement threshold of Formula 2.
//!   They are two numbers here, [`PaperParams::min_distance`] and alpha.
//! - The listing has one hole. Every closed strip of hit triangles has two sides with a hole each.
//! - Nothing in the listing keeps the result a manifold. It is checked. Where the paper's form
//!   fails, that side is made again in a plainer [`Form`]. The plainest, with all points, gives a
//!   manifold whenever the input was one. A side whose piece would be flat is made again likewise.
//!
//! Intersection curves, the edit, its undo and the numbers of pieces are those of `incise-cut`.

mod apply;
mod boundary;
mod points;
mod sides;
mod strip;

use crate::error::PaperError;
use crate::params::PaperParams;
use crate::patch::{Patch, fill, mean_rim_length};
use apply::{Rebuilt, apply, flat_sides};
use boundary::{Boundary, along_points, new_boundary};
use incise_cut::{CutOutcome, Cutter, EdgeCrossing, Sweep};
use incise_mesh::geometry::area_vector;
use incise_mesh::{Surface, Vec3, VertexId};
use incise_params::Params;
use points::{PointSet, intersection_points};
use sides::{Side, sides};
use std::cell::OnceCell;
use std::time::Duration;
use strip::{Strip, strips};
use web_time::Instant;

/// The outcome of a cut by the paper's method.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
#[must_use = "ask `CutOutcome::is_miss`: a sweep that misses changes nothing"]
pub struct PaperOutcome {
    /// The change, its undo, counts and times.
    pub cut: CutOutcome,
    /// Sides of loops on which the paper's boundary would not be a manifold, so that hit triangles
    /// were cut along the sweep instead.
    pub fallback_sides: usize,
}

/// A corner of a new triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
enum Corner {
    /// A vertex of the surface.
    Old(VertexId),
    /// An intersection point, by its number in the [`PointSet`].
    Point(u32),
}

/// Minimum volume of a piece \[cubes of the mean hit edge\].
///
/// Chords across a body of few triangles may leave nothing between them. Below this volume a side
/// is made in a plainer form.
const MIN_VOLUME: f64 = 1e-3;

/// How the boundary of a side is made. Each form is tried where the one before did not give a
/// manifold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    /// Algorithm 3.
    Even,
    /// Every hit triangle cut along the merged intersection points.
    Merged,
    /// Every hit triangle cut along all intersection points, none closer to a vertex than a margin.
    AllPoints,
}

/// One side of one strip, closed: walls between the old boundary and the rim, and the cap.
struct ClosedSide<'a> {
    points: &'a PointSet,
    walls: Vec<[Corner; 3]>,
    rim: Vec<Corner>,
    /// None when the walls close the side by themselves.
    cap: Option<Patch>,
    piece: u32,
}

impl ClosedSide<'_> {
    fn corners(&self) -> impl Iterator<Item = Corner> {
        self.walls.iter().flatten().chain(&self.rim).copied()
    }
}

/// The cutting plane and the parameters of a cut.
struct Listing<'a> {
    sweep: &'a Sweep,
    params: &'a PaperParams,
    /// Mean edge length of the hit triangles \[m\], the unit of distances in [`PaperParams`].
    mean_edge: f64,
}

/// Cuts `surface` along `sweep`, which passes through closed bodies as a whole.
///
/// A sweep that misses changes nothing, see [`CutOutcome::is_miss`]. The cutter's BVH must fit the
/// surface, as for [`Cutter::cut`], and follows the cut unless the cutter defers it.
///
/// # Errors
/// [`PaperError`]; the surface is then bit for bit what it was.
pub fn cut(
    cutter: &mut Cutter,
    surface: &mut Surface,
    sweep: &Sweep,
    params: &PaperParams,
) -> Result<PaperOutcome, PaperError> {
    params.check_ranges()?;
    let begin = Instant::now();
    let curves = cutter.intersect(surface, sweep, params.only_piece)?;
    if let Some(triangle) = curves.end(surface) {
        return Err(PaperError::PartialCut { triangle });
    }
    if let Some(triangle) = curves.sheet(surface) {
        return Err(PaperError::OpenSurface { triangle });
    }
    let points = curves.iter().flat_map(|curve| curve.points());
    let crossings: Vec<EdgeCrossing> = points.filter_map(|point| point.crossing).collect();
    let mut outcome = PaperOutcome::default();
    outcome.cut.report.candidates = curves.candidates();
    let strips = strips(surface, &crossings)?;
    outcome.cut.report.loops = strips.len();
    outcome.cut.report.hits = strips.iter().map(|s| s.hits.len()).sum();
    outcome.cut.report.detection = begin.elapsed();
    if strips.is_empty() {
        return Ok(outcome);
    }
    replace(cutter, surface, sweep, params, &strips, &mut outcome)?;
    if !cutter.defers_bvh() {
        let begin = Instant::now();
        cutter.update_bvh(surface, &outcome.cut.delta);
        outcome.cut.report.bvh_update = begin.elapsed();
    }
    Ok(outcome)
}

/// Replaces the triangles of the strips by closed sides, in one edit.
fn replace(
    cutter: &mut Cutter,
    surface: &mut Surface,
    sweep: &Sweep,
    params: &PaperParams,
    strips: &[Strip],
    outcome: &mut PaperOutcome,
) -> Result<(), PaperError> {
    let begin = Instant::now();
    let hits = strips.iter().flat_map(|strip| &strip.hits);
    let hits = hits.map(|hit| hit.triangle);
    let listing = Listing {
        sweep,
        params,
        mean_edge: surface.mean_edge_length_of(hits),
    };
    let min_distance = params.min_distance * listing.mean_edge;
    let merged = intersection_points(surface, strips, min_distance);
    merged.refuse_nested_loops(surface, sweep)?;
    let merged_sides = sides(surface, strips, &merged);
    let all_points = OnceCell::new();
    let close = |surface: &Surface, i: usize, form: Form, time: &mut Duration| {
        if form != Form::AllPoints {
            return listing.close(surface, &merged, &merged_sides[i], form, None, time);
        }
        let (all, all_sides) = all_points.get_or_init(|| {
            let all = intersection_points(surface, strips, 0.0);
            let sides = sides(surface, strips, &all);
            (all, sides)
        });
        // All points make a rim of tiny edges, which is no reason for a cap of tiny triangles.
        let length = mean_rim_length(&merged.outline(&merged_sides[i].points));
        let length = (length > 0.0).then_some(length);
        listing.close(surface, all, &all_sides[i], form, length, time)
    };
    let mut forms = vec![Form::Even; merged_sides.len()];
    let report = &mut outcome.cut.report;
    let refinement = &mut report.refinement;
    let mut closed = (0..forms.len())
        .map(|i| close(surface, i, Form::Even, refinement))
        .collect::<Result<Vec<_>, _>>()?;
    let min_volume = MIN_VOLUME * listing.mean_edge.powi(3);
    let (mut edit, rebuilt) = loop {
        let mut edit = surface.edit();
        let (result, failed) = match apply(&mut edit, strips, &closed, params.cap_material) {
            Ok(rebuilt) => {
                let flat = flat_sides(edit.surface(), &rebuilt, min_volume);
                (Ok(rebuilt), flat)
            }
            Err(failure) => (Err(failure.error), failure.sides),
        };
        let plainer = |form: Form| match form {
            Form::Even => Some(Form::Merged),
            Form::Merged => Some(Form::AllPoints),
            Form::AllPoints => None,
        };
        let again: Vec<(usize, Form)> = failed
            .into_iter()
            .filter_map(|i| Some((i, plainer(forms[i])?)))
            .collect();
        if again.is_empty() {
            break (edit, result?);
        }
        drop(edit);
        for (i, form) in again {
            forms[i] = form;
            closed[i] = close(surface, i, form, refinement)?;
        }
    };
    let Rebuilt { cap, seeds } = rebuilt;
    outcome.cut.cap = cap;
    outcome.fallback_sides = forms.iter().filter(|&&f| f != Form::Even).count();
    report.refined = closed
        .iter()
        .all(|side| side.cap.as_ref().is_none_or(|cap| cap.report.converged));
    report.split = begin.elapsed() - report.refinement;
    let begin = Instant::now();
    let seeds: Vec<_> = seeds.into_iter().flatten().collect();
    cutter.number_parts(&mut edit, sweep, &seeds);
    report.separation = begin.elapsed();
    let begin = Instant::now();
    let (delta, undo) = edit.finish();
    outcome.cut.delta = delta;
    outcome.cut.undo = Some(undo);
    report.commit = begin.elapsed();
    Ok(())
}

impl Listing<'_> {
    /// Lines 27 to 29 for one side; `rim_length` \[m\] overrides the one of the refinement if that
    /// has none. Adds the time of the cap to `time`.
    fn close<'p>(
        &self,
        surface: &Surface,
        points: &'p PointSet,
        side: &Side,
        form: Form,
        rim_length: Option<f64>,
        time: &mut Duration,
    ) -> Result<ClosedSide<'p>, PaperError> {
        // Algorithm 3 starts from edges; of a side that is a single vertex it would leave nothing.
        let Boundary { walls, rim } = if form == Form::Even && !side.is_single_vertex() {
            new_boundary(surface, self, points, side)
        } else {
            along_points(side)
        };
        let begin = Instant::now();
        let cap = if rim.len() < 3 {
            None
        } else {
            let mut params = *self.params;
            params.rim_length = params.rim_length.or(rim_length);
            let positions: Vec<Vec3> = rim.iter().map(|&c| points.position(surface, c)).collect();
            let joined = |i: u32, j: u32| is_edge(surface, rim[i as usize], rim[j as usize]);
            let normal = newell(&positions);
            Some(fill(&positions, normal, &params, joined)?)
        };
        *time += begin.elapsed();
        Ok(ClosedSide {
            points,
            walls,
            rim,
            cap,
            piece: side.piece,
        })
    }
}

/// Returns whether the surface has an edge between two corners.
fn is_edge(surface: &Surface, a: Corner, b: Corner) -> bool {
    match (a, b) {
        (Corner::Old(a), Corner::Old(b)) => surface.topology().are_adjacent(a, b),
        _ => false,
    }
}

/// Returns the normal of a loop, as long as twice the enclosed area (Newell's method).
fn newell(points: &[Vec3]) -> Vec3 {
    (1..points.len().saturating_sub(1))
        .map(|i| area_vector([points[0], points[i], points[i + 1]]))
        .sum()
}
