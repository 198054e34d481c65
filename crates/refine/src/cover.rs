//! A cross-section in, triangles that cover it out.
//!
//! The rule: loops stay as they are, every decision is an exact sign, and whatever the loops do,
//! what comes out is a manifold with exactly them as its boundary. Disjoint loops that wind as they
//! should, nested to any depth, are covered together: their constrained Delaunay triangulation,
//! the core of a triangular lattice in it, and a Delaunay band between. Loops that touch or cross
//! others are covered each on its own, and a loop that crosses itself becomes a disc without inner
//! points.

mod band;
mod cdt;
mod discs;
mod filling;
mod forbidden;
mod improve;
mod lattice;
mod mean;
mod mend;
mod offer;
mod order;
mod paper;
mod quality;
mod section;
mod sheet;
mod size;
mod smooth;
mod spiral;
mod strips;
mod validate;
mod wall;

use crate::patch::{RefineError, RefineMethod, RefineParams};
use band::Band;
use cdt::id;
use filling::Filling;
use improve::Improver;
use lattice::Lattice;
use paper::{Paper, Task};
use section::Rims;
use sheet::{INSIDE, Sheet, Verdict};
use size::Targets;

pub use quality::CoverQuality;
pub use size::CoverSize;
pub use validate::CoverFault;

/// Targets below this much of the largest coordinate are raised to it: the lattice's points could
/// not be told apart.
const FINEST: f64 = 1.0 / (1u64 << 40) as f64;

/// A cross-section: closed loops in a plane, the inside on their left.
#[derive(Debug, Clone, Copy)]
pub struct Section<'a> {
    /// Positions in the plane \[m\].
    pub points: &'a [[f64; 2]],
    /// Loops of at least 3 points each. No point is on two loops or twice on one; two points may
    /// be at the same place.
    pub loops: &'a [Vec<u32>],
    /// Whether edges must follow the line y = 0.
    pub crease: bool,
}

/// How to cover a section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoverParams<'a> {
    /// How triangles come about. [`RefineMethod::Paper`] has one target for each part of the section, the mean of
    /// those along its rim, and knows neither a grading nor an angle to ask for.
    pub method: RefineMethod,
    /// How long edges are to get a good way off the rim. Near a rim whose own edges are shorter, those and what
    /// they grow to with the distance are the target: they stay as they are, and a leap from short to
    /// long makes sharp angles.
    pub size: CoverSize<'a>,
    /// By how much the target grows with every meter off the rim \[m/m\]. 0: not at all, and where
    /// targets are local those of the rim around are mixed. Above, a cover costs what its rim does.
    pub grading: f64,
    /// Triangles with a smaller angle ask for one more point, which they get where that helps \[degrees\].
    pub sharp: f64,
    /// [`RefineMethod::Paper`]: the most rounds of subdividing and swapping, see
    /// [`RefineParams::max_rounds`](crate::RefineParams::max_rounds).
    pub max_rounds: u32,
    /// The most triangles that a cover may get.
    pub max_triangles: usize,
}

impl Default for CoverParams<'_> {
    fn default() -> Self {
        let refine = RefineParams::default();
        Self {
            method: refine.method,
            size: CoverSize::Any,
            grading: refine.grading,
            sharp: 32.0,
            max_rounds: refine.max_rounds,
            max_triangles: refine.max_triangles,
        }
    }
}

/// A vertex that is not on a loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InnerPoint {
    /// Position in the plane \[m\].
    pub at: [f64; 2],
    /// Three points of the section whose weighted mean it is.
    pub parents: [u32; 3],
    /// Their weights: none negative, the sum 1.
    pub weights: [f64; 3],
}

/// What was done to cover a section.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CoverReport {
    /// Corners of no area, duplicates and spikes, or next to none, cut off with a triangle each.
    pub clipped: usize,
    /// Loops covered on their own: they touch or cross others or wind the wrong way.
    pub apart: usize,
    /// Loops closed as discs without inner points: they touch or cross themselves.
    pub discs: usize,
    /// Parts with triangles still too large after the last round that [`RefineMethod::Paper`] was given.
    pub unfinished: usize,
}

/// Triangles over a section.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Cover {
    /// Vertices inside: vertex `section.points.len() + i` is `inner[i]`.
    pub inner: Vec<InnerPoint>,
    /// Triangles on the section's points and the inner ones. Each edge of a loop is the side of
    /// one triangle, in the loop's direction; each other edge is shared by two.
    pub triangles: Vec<[u32; 3]>,
    /// What was done.
    pub report: CoverReport,
}

/// Memory that [`cover`] keeps between calls.
#[derive(Debug, Clone, Default)]
pub struct CoverScratch {
    rims: Rims,
    targets: Targets,
    sheet: Sheet,
    lattice: Lattice,
    band: Band,
    improver: Improver,
    paper: Paper,
}

/// Covers a section with triangles.
///
/// `joined(a, b)` says whether the surface outside has an edge between two of the section's points
/// already: the cover makes no second one.
///
/// Loops that neither touch nor cross, and around which the winding number is 0 or 1 everywhere,
/// are covered exactly, whatever their nesting, by triangles of positive area. Of any other
/// loops, those that fit together are covered so, and each of the rest on its own: still a manifold
/// whose boundary is the loops, and whose signed area is theirs.
///
/// # Errors
/// [`RefineError`] on a loop of fewer than 3 points, a point that does not exist or is used twice,
/// a coordinate that is not finite, a length that is not positive, or more triangles than allowed.
pub fn cover(
    section: &Section<'_>,
    params: &CoverParams<'_>,
    joined: impl Fn(u32, u32) -> bool,
    scratch: &mut CoverScratch,
) -> Result<Cover, RefineError> {
    scratch.rims.read(section)?;
    scratch.targets.read(&scratch.rims, params)?;
    let mut cover = Cover::default();
    cover.report.clipped = scratch.rims.clip(&joined, &mut cover.triangles);
    let limit = params.max_triangles;
    let mut groups = vec![((0..id(scratch.rims.rings())).collect::<Vec<u32>>(), false)];
    // Bad rings may cost so much more than good ones.
    let mut work = 16 * scratch.rims.ids.len() + 20_000;
    while let Some((group, mirrored)) = groups.pop() {
        if group.is_empty() {
            continue;
        }
        let CoverScratch {
            rims,
            targets,
            sheet,
            lattice,
            band,
            improver,
            paper,
        } = &mut *scratch;
        let verdict = mend::build(rims, sheet, &group, mirrored, section.crease, &mut work);
        if verdict == Verdict::Clean && params.method == RefineMethod::Paper {
            lattice.clear();
            band.clear(sheet);
            let task = Task {
                rims,
                targets,
                mirrored,
                refine: RefineParams {
                    max_rounds: params.max_rounds,
                    max_triangles: limit,
                    ..RefineParams::default()
                },
            };
            paper.cover(&task, sheet, lattice, band, &joined, &mut cover)?;
        } else if verdict == Verdict::Clean {
            lattice.clear();
            band.clear(sheet);
            if !targets.is_any() {
                let task = Filling {
                    rims,
                    targets,
                    group: &group,
                    mirrored,
                    crease: section.crease,
                    limit,
                };
                task.fill(sheet, lattice, band, improver, &mut cover)?;
            }
            let name = |v: u32| rims.ids[sheet.corner[v as usize] as usize];
            let taken = forbidden::find(sheet, |v, w| joined(name(v), name(w)));
            for edge in taken {
                let name = |v: u32| rims.ids[sheet.corner[v as usize] as usize];
                let may_flip = params.size == CoverSize::Any
                    && forbidden::can_flip(sheet, edge, |v, w| joined(name(v), name(w)));
                forbidden::replace(sheet, lattice, band, edge, may_flip);
            }
            write(rims, sheet, lattice, band, mirrored, &mut cover);
        } else if !sheet.trouble.is_empty() {
            let may_cut = work >= sheet.corner.len();
            work = work.saturating_sub(sheet.corner.len());
            let parts = mend::part(rims, sheet, &group, &joined, may_cut);
            cover.report.apart += parts.apart;
            cover.report.clipped += parts.shaved.len();
            cover.triangles.extend(parts.shaved);
            cover.report.discs += parts.discs.len() + usize::from(!parts.ties.is_empty());
            for corners in &parts.ties {
                close_disc(rims, corners, &joined, &mut cover);
            }
            for ring in parts.discs {
                close_disc(rims, rims.ring(ring as usize), &joined, &mut cover);
            }
            groups.extend(parts.groups.into_iter().map(|group| (group, false)));
        } else if let [ring] = group[..] {
            if mirrored || !sheet.backward[0] {
                cover.report.discs += 1;
                close_disc(rims, rims.ring(ring as usize), &joined, &mut cover);
            } else {
                groups.push((group, true));
            }
        } else {
            let (out, rest): (Vec<_>, Vec<_>) =
                (0..group.len()).partition(|&i| sheet.bad[i] || sheet.backward[i]);
            cover.report.apart += out.len();
            groups.extend(out.into_iter().map(|i| (vec![group[i]], false)));
            groups.push((rest.into_iter().map(|i| group[i]).collect(), false));
        }
        if cover.triangles.len() > limit {
            return Err(RefineError::TooManyTriangles { limit });
        }
    }
    if scratch.rims.moved {
        // The section's own points are what counts.
        for inner in &mut cover.inner {
            inner.at = [0, 1].map(|k| {
                let mean =
                    |i: usize| inner.weights[i] * section.points[inner.parents[i] as usize][k];
                mean(0) + mean(1) + mean(2)
            });
        }
    }
    let (corners, points) = (id(scratch.rims.ids.len()), id(section.points.len()));
    for t in &mut cover.triangles {
        *t = t.map(|v| match scratch.rims.ids.get(v as usize) {
            Some(&point) => point,
            None => v - corners + points,
        });
    }
    Ok(cover)
}

/// Closes one ring of corners as a disc.
fn close_disc(rims: &Rims, corners: &[u32], joined: &impl Fn(u32, u32) -> bool, cover: &mut Cover) {
    let ids = |corner: u32| rims.ids[corner as usize];
    let open = discs::clip_ears(
        &rims.points,
        corners,
        |a, b| joined(ids(a), ids(b)),
        &mut cover.triangles,
    );
    let Some(open) = open else { return };
    let n = open.len();
    let center = id(rims.ids.len() + cover.inner.len());
    let parents = [open[0], open[n / 3], open[2 * n / 3]];
    let at = [0, 1].map(|k| {
        let sum: f64 = parents.iter().map(|&c| rims.points[c as usize][k]).sum();
        sum / 3.0 / rims.scale
    });
    cover.inner.push(InnerPoint {
        at,
        parents: parents.map(ids),
        weights: [1.0 / 3.0; 3],
    });
    cover
        .triangles
        .extend((0..n).map(|i| [open[i], open[(i + 1) % n], center]));
}

/// Writes a sheet's inner points and its band. In a mirrored sheet triangles that turn left follow
/// rings that turn right in the section.
fn write(
    rims: &Rims,
    sheet: &Sheet,
    lattice: &Lattice,
    band: &Band,
    mirrored: bool,
    cover: &mut Cover,
) {
    let offset = id(rims.ids.len() + cover.inner.len());
    let side = if mirrored { -1.0 } else { 1.0 };
    let ids = |v: u32| rims.ids[sheet.corner[v as usize] as usize];
    cover
        .inner
        .extend((0..lattice.points.len()).map(|i| InnerPoint {
            at: [
                side * lattice.points[i][0] / rims.scale,
                lattice.points[i][1] / rims.scale,
            ],
            parents: lattice.parents[i].map(ids),
            weights: lattice.weights[i],
        }));
    let name = |v: u32| match sheet.corner.get(v as usize) {
        Some(&corner) => corner,
        None => offset + band.lattice[(v - band.first) as usize],
    };
    cover.triangles.extend(
        (0..sheet.cdt.triangles())
            .filter(|&t| sheet.cdt.region[t as usize] == INSIDE)
            .map(|t| sheet.cdt.corners(t).map(name)),
    );
}
