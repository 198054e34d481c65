//! Fills holes of a surface with patches of the surrounding triangle size.
//!
//! 1. [`rim`]: finds the rims, their neighborhood and the target lengths.
//! 2. [`planar`] triangulates a planar rim with [`crate::section_mesh`]. Any other rim gets the
//!    triangulation that bends least ([`minimal_triangulation`]), which is refined in the plane
//!    into which it unfolds ([`unfolding`]), or in space if it overlaps there ([`subdivision`]).
//! 3. [`fairing`], if requested, moves new vertices to the smoothest shape.
//! 4. [`stitching`] adds all patches in one [`incise_mesh::Edit`], so an error changes nothing.

mod envelope;
mod fairing;
mod minimal_triangulation;
mod patch;
mod planar;
mod report;
mod rim;
mod self_intersection;
mod smoothing;
mod stitching;
mod subdivision;
mod unfolding;

use crate::error::HoleError;
use incise_mesh::{HalfEdge, Surface, Topology, VertexId};
use patch::{HolePatch, NewVertex};
use planar::Plane;
pub use report::{FillReport, HoleParams, HoleReport};
use rim::{Rim, RimNeighborhood};

/// Cosine of the mean angle, 60 degrees, between a planar patch and the surface around it.
///
/// At a steeper angle the hole is the end of a tube, and the patch stays planar when faired.
const STEEP: f64 = 0.5;

/// Maximum number of new vertices of a faired patch; the time of fairing grows with its square.
const MAX_FAIRED: usize = 10_000;

/// Fills every hole of a surface, which includes the outer boundary of an open sheet.
///
/// Each patch meets the surface edge to edge with a consistent orientation. It adds no second edge
/// between two vertices and no second triangle on three. Its edges are as long as those of the
/// surface around the hole times z. A patch may intersect other parts of the surface.
///
/// Existing vertices and triangles keep their ids and bits. Time is O(n) for the surface, O(k^3)
/// for a rim of k edges that is not planar and has up to 256 edges, and O(k) such parts for longer
/// rims.
///
/// # Errors
/// [`HoleError`]; the surface is then bit for bit unchanged.
///
/// ```
/// use incise_mesh::icosphere;
/// use incise_refine::{HoleParams, fill_holes};
///
/// let mut body = icosphere(3, 0.5);
/// let is_cap = |t: &_| body.triangle_positions(*t).iter().all(|p| p.z > 0.3);
/// let hole: Vec<_> = body.topology().triangles().filter(is_cap).collect();
/// let unused = body.remove_triangles(&hole);
/// body.remove_vertices(&unused);
/// assert!(!body.topology().is_closed());
///
/// let report = fill_holes(&mut body, &HoleParams::default())?;
/// assert_eq!(report.holes.len(), 1);
/// assert!(body.topology().is_closed());
/// # Ok::<(), incise_refine::HoleError>(())
/// ```
pub fn fill_holes(surface: &mut Surface, params: &HoleParams) -> Result<FillReport, HoleError> {
    params.check()?;
    let loops = surface.topology().boundary_loops();
    fill(surface, &loops, params)
}

/// Fills one hole, given its rim, in the same way as [`fill_holes`].
///
/// `rim` is a closed chain of boundary half-edges, as in [`Topology::boundary_loops`].
///
/// # Errors
/// [`HoleError`]; the surface is then bit for bit unchanged.
pub fn fill_hole(
    surface: &mut Surface,
    rim: &[HalfEdge],
    params: &HoleParams,
) -> Result<FillReport, HoleError> {
    params.check()?;
    fill(surface, &[rim.to_vec()], params)
}

fn fill(
    surface: &mut Surface,
    loops: &[Vec<HalfEdge>],
    params: &HoleParams,
) -> Result<FillReport, HoleError> {
    let topology = surface.topology();
    let (small, large): (Vec<_>, Vec<_>) =
        (loops.iter()).partition(|boundary| boundary.len() <= params.max_rim_edges);
    let mut report = FillReport {
        left_open: large.len(),
        ..FillReport::default()
    };
    let rims = (small.iter())
        .map(|boundary| Rim::new(topology, boundary))
        .collect::<Result<Vec<Rim>, HoleError>>()?;
    if rims.is_empty() {
        return Ok(report);
    }
    let mut around = RimNeighborhood::new(topology, &rims);
    around.check_finite(surface)?;
    around.check_fans(topology, &rims)?;
    let mut left = params.max_triangles;
    let mut patches = Vec::with_capacity(rims.len());
    for rim in &rims {
        let made =
            triangulate(surface, rim, &mut around, params, left).map_err(|error| match error {
                HoleError::TooManyTriangles { .. } => HoleError::TooManyTriangles {
                    limit: params.max_triangles,
                },
                error => error,
            })?;
        left -= made.0.triangles.len();
        patches.push(made);
    }
    let mut edit = surface.edit();
    for (rim, (patch, mut hole)) in rims.iter().zip(patches) {
        if patch.triangles.is_empty() {
            edit.set_twins(rim.across[0], rim.across[1]);
        } else {
            hole.triangles =
                stitching::stitch(&mut edit, rim, &patch, params.material, hole.faired);
            hole.count_slivers(edit.surface());
        }
        report.holes.push(hole);
    }
    let (delta, undo) = edit.finish();
    report.delta = delta;
    report.undo = Some(undo);
    Ok(report)
}

/// Returns the patch of one rim and adds its edges between rim vertices to `around`.
fn triangulate(
    surface: &Surface,
    rim: &Rim,
    around: &mut RimNeighborhood,
    params: &HoleParams,
    limit: usize,
) -> Result<(HolePatch, HoleReport), HoleError> {
    let mut sizes = around.sizes(surface, rim, params.level.z());
    let mut patch = HolePatch::new(surface, rim);
    let mut hole = HoleReport::new(&rim.vertices, &sizes);
    if rim.len() < 3 {
        return Ok((patch, hole));
    }
    if rim.len() - 2 > limit {
        return Err(HoleError::TooManyTriangles { limit });
    }
    let normals = rim.normals(surface);
    let has_edge = |a: u32, b: u32| {
        let [a, b] = [a, b].map(|v| rim.vertices[v as usize]);
        around.has_edge(a, b)
    };
    let plane = Plane::fit(&patch.points, rim.mean_edge(surface));
    let cos = |plane: &Plane| normals.iter().map(|n| n.dot(&plane.normal)).sum::<f64>();
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 vertices")]
    let is_steep = |plane: &Plane| cos(plane) < STEEP * normals.len() as f64;
    let is_faired = params.fair && !plane.as_ref().is_some_and(is_steep);
    // Stop refinement early if the patch is too fine for fairing.
    let most = if is_faired {
        limit.min(rim.len() - 2 + 2 * MAX_FAIRED)
    } else {
        limit
    };
    let too_many = |error| match error {
        HoleError::TooManyTriangles { .. } if most < limit => HoleError::TooFineToFair {
            vertex: rim.vertices[0],
            limit: MAX_FAIRED,
        },
        error => error,
    };
    if is_doubled(surface.topology(), rim, around) {
        patch.fan(&[0, 1, 2]);
    } else if let Some(plane) = &plane {
        let made = planar::fill(&mut patch, plane, &sizes, most, &has_edge);
        hole.planar = made.map_err(too_many)?;
        hole.self_intersecting = !hole.planar;
    }
    if !hole.planar {
        if patch.triangles.is_empty() {
            let minimal =
                minimal_triangulation::triangulate_minimal(&patch.points, &normals, &has_edge);
            patch.triangles = minimal.triangles;
            minimal.open.iter().for_each(|part| patch.fan(part));
        }
        hole.self_intersecting |=
            self_intersection::is_self_intersecting(&patch.points, &patch.triangles);
        let made = unfolding::refine(&mut patch, &sizes, most, &has_edge).map_err(too_many)?;
        if made {
            subdivision::flip_and_smooth(&mut patch, &has_edge);
        } else {
            subdivision::refine(&mut patch, &mut sizes, most, &has_edge).map_err(too_many)?;
        }
    }
    if patch.triangles.len() > most {
        return Err(too_many(HoleError::TooManyTriangles { limit }));
    }
    if is_faired && !patch.inner.is_empty() {
        hole.faired = fairing::fair(&mut patch, surface, rim, around, &has_edge);
    }
    for &[a, b, c] in &patch.triangles {
        for [a, b] in [[a, b], [b, c], [c, a]].map(|side| side.map(|v| v as usize)) {
            if let (Some(&a), Some(&b)) = (rim.vertices.get(a), rim.vertices.get(b)) {
                around.add_edge(a, b);
            }
        }
    }
    hole.measure(&patch);
    Ok((patch, hole))
}

/// Returns whether a rim of three edges already has a triangle, on its other side.
fn is_doubled(topology: &Topology, rim: &Rim, around: &RimNeighborhood) -> bool {
    let corners = <[VertexId; 3]>::try_from(rim.vertices.as_slice());
    corners.is_ok_and(|corners| around.has_triangle(topology, corners))
}
