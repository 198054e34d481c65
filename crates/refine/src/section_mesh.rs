//! Triangulates a cross-section: closed loops in a plane to a triangle mesh.
//!
//! [`triangulate_section`] keeps the loops as they are and decides by exact signs, so the result is
//! a manifold with exactly the loops as its boundary. The steps:
//!
//! 1. [`loops`]: checks and scales the loops, clips corners without area.
//! 2. [`loop_triangulation`]: the constrained Delaunay triangulation ([`cdt`]) of a group of loops.
//!    [`repair_loops`] separates loops that touch or cross; [`ear_clipping`] fills the rest.
//!    Where that fails, [`nesting`] splits the group into outer loops with their holes.
//! 3. [`interior`]: Steiner points. A core of equilateral triangles ([`lattice`]), the
//!    [`boundary_band`] around it, then Delaunay [`refinement`] with smoothing.
//! 4. [`duplicate_edges`]: removes edges that the surrounding surface already has.

mod barycentric;
mod boundary_band;
mod cdt;
mod duplicate_edges;
mod ear_clipping;
mod interior;
mod lattice;
mod loop_triangulation;
mod loops;
mod nesting;
mod quality;
mod refinement;
mod repair_loops;
mod target_length;
mod validate;

use crate::error::RefineError;
use crate::params::RefineParams;
use boundary_band::BoundaryBand;
use incise_mesh::index_u32;
use interior::Interior;
use lattice::Lattice;
use loop_triangulation::{INSIDE, LoopTriangulation, LoopValidity};
use loops::SectionLoops;
use refinement::Refiner;
use target_length::TargetLengths;

pub use quality::SectionMeshQuality;
pub use target_length::SectionMeshSize;
pub use validate::InvalidSectionMesh;

/// Smallest target length relative to the largest coordinate.
///
/// Lattice points closer than this would coincide.
const MIN_TARGET: f64 = 1.0 / (1u64 << 40) as f64;

/// A cross-section: closed loops in a plane, the interior on their left.
#[derive(Debug, Clone, Copy)]
pub struct Section<'a> {
    /// Positions in the plane \[m\].
    pub points: &'a [[f64; 2]],
    /// Loops of at least 3 points each.
    ///
    /// A point is on at most one loop, once. Two points may have the same position.
    pub loops: &'a [Vec<u32>],
}

/// Parameters of [`triangulate_section`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectionMeshParams<'a> {
    /// Target edge length away from the rim.
    ///
    /// Near shorter rim edges the target starts at their length and grows with the distance.
    pub size: SectionMeshSize<'a>,
    /// Growth of the target length with the distance from the rim \[m/m\].
    ///
    /// 0: constant, local targets are interpolated from the rim. Above 0, the number of triangles
    /// grows with the rim, not with the area.
    pub grading: f64,
    /// Triangles with a smaller angle get a Steiner point where that improves them \[degrees\].
    pub min_angle: f64,
    /// Maximum number of triangles; a section that needs more is an error.
    pub max_triangles: usize,
}

impl Default for SectionMeshParams<'_> {
    fn default() -> Self {
        let refine = RefineParams::default();
        Self {
            size: SectionMeshSize::Any,
            grading: refine.grading,
            min_angle: 31.0,
            max_triangles: refine.max_triangles,
        }
    }
}

/// A vertex that is not on a loop.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SteinerPoint {
    /// Position in the plane \[m\].
    pub position: [f64; 2],
    /// Three points of the section whose weighted mean it is.
    pub parents: [u32; 3],
    /// Their weights: none negative, the sum 1.
    pub weights: [f64; 3],
}

/// Counters of one [`triangulate_section`] call.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct SectionMeshReport {
    /// Corners (nearly) without area, duplicates and spikes, cut off with one triangle each.
    pub clipped_corners: usize,
    /// Loops triangulated separately: they touch or cross others or have the wrong orientation.
    pub separated_loops: usize,
    /// Loops that touch or cross themselves, closed as discs without Steiner points.
    pub self_intersecting_loops: usize,
}

/// The triangles of a section.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SectionMesh {
    /// Interior vertices: vertex `section.points.len() + i` is `steiner_points[i]`.
    pub steiner_points: Vec<SteinerPoint>,
    /// Triangles on the section's points and the Steiner points.
    ///
    /// Each loop edge is a side of one triangle, in the loop's direction; each other edge is a side
    /// of two.
    pub triangles: Vec<[u32; 3]>,
    /// Counters of the triangulation.
    pub report: SectionMeshReport,
}

/// Scratch memory that [`triangulate_section`] reuses between calls.
#[derive(Debug, Clone, Default)]
pub struct SectionMeshScratch {
    loops: SectionLoops,
    targets: TargetLengths,
    triangulation: LoopTriangulation,
    lattice: Lattice,
    band: BoundaryBand,
    refiner: Refiner,
}

/// Triangulates a section, with Steiner points that meet the target edge lengths.
///
/// `has_edge(a, b)` returns whether the surrounding surface already has an edge between two of the
/// section's points; the mesh adds no second one.
///
/// Disjoint simple loops whose winding number is 0 or 1 everywhere are covered exactly once by
/// triangles of positive area, nested to any depth. Of any other loops, those that fit together are
/// triangulated so and each of the rest separately. The result is still a manifold whose boundary
/// is the loops and whose signed area is theirs.
///
/// # Errors
/// [`RefineError`] on a loop of fewer than 3 points, a point that does not exist or is used twice,
/// a coordinate that is not finite, a length that is not positive, or more triangles than allowed.
pub fn triangulate_section(
    section: &Section<'_>,
    params: &SectionMeshParams<'_>,
    has_edge: impl Fn(u32, u32) -> bool,
    scratch: &mut SectionMeshScratch,
) -> Result<SectionMesh, RefineError> {
    scratch.loops.read(section)?;
    scratch.targets.read(&scratch.loops, params)?;
    let mut mesh = SectionMesh::default();
    mesh.report.clipped_corners = scratch.loops.clip(&has_edge, &mut mesh.triangles);
    let limit = params.max_triangles;
    let mut groups = vec![(
        (0..index_u32(scratch.loops.loop_count())).collect::<Vec<u32>>(),
        false,
    )];
    // Once, as later groups are made from parts of loops.
    let mut may_nest = true;
    // Bounds the time spent on the repair of invalid loops.
    let mut repair_budget = 16 * scratch.loops.point_ids.len() + 20_000;
    while let Some((group, mirrored)) = groups.pop() {
        if group.is_empty() {
            continue;
        }
        let SectionMeshScratch {
            loops,
            targets,
            triangulation,
            lattice,
            band,
            refiner,
        } = &mut *scratch;
        let validity =
            repair_loops::triangulate(loops, triangulation, &group, mirrored, &mut repair_budget);
        if validity == LoopValidity::Valid {
            lattice.clear();
            band.clear(triangulation);
            if !targets.is_any() {
                let task = Interior {
                    loops,
                    targets,
                    group: &group,
                    mirrored,
                    limit,
                };
                task.fill(triangulation, lattice, band, refiner, &mut mesh)?;
            }
            let point_of = |v: u32| loops.point_ids[triangulation.corner_of[v as usize] as usize];
            let duplicates =
                duplicate_edges::find(triangulation, |v, w| has_edge(point_of(v), point_of(w)));
            for edge in duplicates {
                let point_of =
                    |v: u32| loops.point_ids[triangulation.corner_of[v as usize] as usize];
                let may_flip = params.size == SectionMeshSize::Any
                    && duplicate_edges::can_flip(triangulation, edge, |v, w| {
                        has_edge(point_of(v), point_of(w))
                    });
                duplicate_edges::replace(triangulation, lattice, band, edge, may_flip);
            }
            write(loops, triangulation, lattice, band, mirrored, &mut mesh);
        } else if may_nest && group.len() > 1 && !triangulation.intersections.is_empty() {
            loops.restore();
            groups.extend((nesting::split(loops, &group).into_iter()).map(|group| (group, false)));
            may_nest = false;
        } else if !triangulation.intersections.is_empty() {
            let may_split = repair_budget >= triangulation.corner_of.len();
            repair_budget = repair_budget.saturating_sub(triangulation.corner_of.len());
            let parts =
                repair_loops::split_group(loops, triangulation, &group, &has_edge, may_split);
            mesh.report.separated_loops += parts.separated_loops;
            mesh.report.clipped_corners += parts.clipped.len();
            mesh.triangles.extend(parts.clipped);
            mesh.report.self_intersecting_loops +=
                parts.self_intersecting.len() + usize::from(!parts.bow_ties.is_empty());
            for corners in &parts.bow_ties {
                fill_loop(loops, corners, &has_edge, &mut mesh);
            }
            for index in parts.self_intersecting {
                fill_loop(loops, loops.corners(index as usize), &has_edge, &mut mesh);
            }
            groups.extend(parts.groups.into_iter().map(|group| (group, false)));
        } else if let [index] = group[..] {
            if mirrored || !triangulation.misoriented[0] {
                mesh.report.self_intersecting_loops += 1;
                fill_loop(loops, loops.corners(index as usize), &has_edge, &mut mesh);
            } else {
                groups.push((group, true));
            }
        } else {
            let (out, rest): (Vec<_>, Vec<_>) = (0..group.len())
                .partition(|&i| triangulation.intersecting[i] || triangulation.misoriented[i]);
            mesh.report.separated_loops += out.len();
            groups.extend(out.into_iter().map(|i| (vec![group[i]], false)));
            groups.push((rest.into_iter().map(|i| group[i]).collect(), false));
        }
        if mesh.triangles.len() > limit {
            return Err(RefineError::TooManyTriangles { limit });
        }
    }
    if scratch.loops.moved {
        // Triangles were found on displaced corners; positions follow from the section's points.
        for inner in &mut mesh.steiner_points {
            inner.position = [0, 1].map(|k| {
                let mean =
                    |i: usize| inner.weights[i] * section.points[inner.parents[i] as usize][k];
                mean(0) + mean(1) + mean(2)
            });
        }
    }
    let (corners, points) = (
        index_u32(scratch.loops.point_ids.len()),
        index_u32(section.points.len()),
    );
    for t in &mut mesh.triangles {
        *t = t.map(|v| match scratch.loops.point_ids.get(v as usize) {
            Some(&point) => point,
            None => v - corners + points,
        });
    }
    Ok(mesh)
}

/// Fills one loop by ear clipping, with a fan around a new vertex where no ear is allowed.
fn fill_loop(
    loops: &SectionLoops,
    corners: &[u32],
    has_edge: &impl Fn(u32, u32) -> bool,
    mesh: &mut SectionMesh,
) {
    let ids = |corner: u32| loops.point_ids[corner as usize];
    let open = ear_clipping::clip_ears(
        &loops.points,
        corners,
        |a, b| has_edge(ids(a), ids(b)),
        &mut mesh.triangles,
    );
    let Some(open) = open else { return };
    let n = open.len();
    let center = index_u32(loops.point_ids.len() + mesh.steiner_points.len());
    let parents = [open[0], open[n / 3], open[2 * n / 3]];
    let at = [0, 1].map(|k| {
        let sum: f64 = parents.iter().map(|&c| loops.points[c as usize][k]).sum();
        sum / 3.0 / loops.scale
    });
    mesh.steiner_points.push(SteinerPoint {
        position: at,
        parents: parents.map(ids),
        weights: [1.0 / 3.0; 3],
    });
    mesh.triangles
        .extend((0..n).map(|i| [open[i], open[(i + 1) % n], center]));
}

/// Appends the Steiner points and triangles of one group of loops to the mesh.
///
/// In a mirrored group, counterclockwise triangles follow clockwise loops of the section.
fn write(
    loops: &SectionLoops,
    triangulation: &LoopTriangulation,
    lattice: &Lattice,
    band: &BoundaryBand,
    mirrored: bool,
    mesh: &mut SectionMesh,
) {
    let offset = index_u32(loops.point_ids.len() + mesh.steiner_points.len());
    let side = if mirrored { -1.0 } else { 1.0 };
    let ids = |v: u32| loops.point_ids[triangulation.corner_of[v as usize] as usize];
    mesh.steiner_points
        .extend((0..lattice.points.len()).map(|i| SteinerPoint {
            position: [
                side * lattice.points[i][0] / loops.scale,
                lattice.points[i][1] / loops.scale,
            ],
            parents: lattice.parents[i].map(ids),
            weights: lattice.weights[i],
        }));
    let name = |v: u32| match triangulation.corner_of.get(v as usize) {
        Some(&corner) => corner,
        None => offset + band.lattice[(v - band.first) as usize],
    };
    mesh.triangles.extend(
        (0..triangulation.cdt.triangles())
            .filter(|&t| triangulation.cdt.region[t as usize] == INSIDE)
            .map(|t| triangulation.cdt.corners(t).map(name)),
    );
}
