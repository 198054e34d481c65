//! Liepa's refinement of a patch in space, for patches that cannot be unfolded.
//!
//! A triangle is split at its center if all three corners are farther from it than their target
//! sizes require. Edges are flipped toward Delaunay, and vertices smoothed. Lengths and angles are
//! measured in space, so the patch need not be planar, and flips never fold it.

use super::smoothing::smooth;
use super::{HolePatch, NewVertex};
use crate::edge_dictionary::{EdgeDictionary, Flip};
use crate::error::HoleError;
use incise_mesh::geometry::area_vector;
use incise_mesh::{Vec3, index_u32};

/// Liepa's alpha, the square root of 3: an equilateral triangle above the target size is split.
///
/// Liepa takes the square root of 2, which gives a mean edge a quarter above the target.
const ALPHA: f64 = 1.732_050_807_568_877_2;

/// Minimum height, in target sizes, of a triangle to split.
///
/// A long edge of the rim is not split, so its triangle always has corners far from its center.
/// Repeated splits there would make needles.
const MIN_HEIGHT: f64 = 0.4;

/// Edge length, in largest sizes, of equilateral triangles that bound the count from below.
const BOUND_EDGE: f64 = 2.0;

/// Maximum number of rounds; a round divides lengths by about the square root of 3.
const MAX_ROUNDS: usize = 40;

/// Maximum number of passes of flips after a round; in space, flips need not terminate.
const MAX_PASSES: usize = 6;

/// Number of smoothing passes after the last split.
const FINAL_PASSES: usize = 6;

/// Cosine of the maximum dihedral angle, 45 degrees, that a flip may cause.
const MIN_FOLD_COS: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Refines until triangles have the target sizes \[m\] of the rim's vertices.
///
/// `has_edge` returns whether the surface already has an edge between two rim vertices. `limit` is
/// the maximum number of triangles.
///
/// # Errors
/// [`HoleError::TooManyTriangles`], whose limit the caller sets.
pub(super) fn refine(
    patch: &mut HolePatch,
    sizes: &mut Vec<f64>,
    limit: usize,
    has_edge: &impl Fn(u32, u32) -> bool,
) -> Result<(), HoleError> {
    if is_too_fine(patch, sizes, limit) {
        return Err(HoleError::TooManyTriangles { limit });
    }
    for inner in &patch.inner[sizes.len() - patch.rim..] {
        sizes.push(
            inner
                .parents
                .iter()
                .map(|&p| sizes[p as usize])
                .sum::<f64>()
                / 3.0,
        );
    }
    let mut dictionary = EdgeDictionary::from_triangles(&patch.triangles);
    flip_to_delaunay(patch, &mut dictionary, has_edge);
    for _ in 0..MAX_ROUNDS {
        let mut grew = false;
        for i in 0..patch.triangles.len() {
            if is_too_large(patch, sizes, i) {
                if patch.triangles.len() + 2 > limit {
                    return Err(HoleError::TooManyTriangles { limit });
                }
                split(patch, sizes, &mut dictionary, i);
                grew = true;
            }
        }
        let passes = if grew { 1 } else { FINAL_PASSES };
        for _ in 0..passes {
            flip_to_delaunay(patch, &mut dictionary, has_edge);
            smooth(patch);
        }
        if !grew {
            break;
        }
    }
    flip_to_delaunay(patch, &mut dictionary, has_edge);
    Ok(())
}

/// Returns whether a lower bound of the triangle count exceeds the limit.
#[expect(clippy::cast_precision_loss, reason = "a bound, far from both sides")]
fn is_too_fine(patch: &HolePatch, sizes: &[f64], limit: usize) -> bool {
    let corners = |t: &[u32; 3]| t.map(|v| patch.points[v as usize]);
    let doubled = |t| area_vector(corners(t)).norm();
    let side = BOUND_EDGE * sizes.iter().copied().fold(0.0, f64::max);
    let least = patch.triangles.iter().map(doubled).sum::<f64>() / (0.75f64.sqrt() * side * side);
    least > limit as f64
}

/// Flips edges and smooths vertices of a refined patch, after folding it back into space.
pub(super) fn flip_and_smooth(patch: &mut HolePatch, has_edge: &impl Fn(u32, u32) -> bool) {
    let mut dictionary = EdgeDictionary::from_triangles(&patch.triangles);
    for _ in 0..FINAL_PASSES {
        flip_to_delaunay(patch, &mut dictionary, has_edge);
        smooth(patch);
    }
    flip_to_delaunay(patch, &mut dictionary, has_edge);
}

/// Returns whether triangle `i` is larger than its corners' sizes and not flat.
fn is_too_large(patch: &HolePatch, sizes: &[f64], i: usize) -> bool {
    let corners = patch.triangles[i];
    let at = corners.map(|v| patch.points[v as usize]);
    let own = corners.map(|v| sizes[v as usize]);
    let (center, size) = ((at[0] + at[1] + at[2]) / 3.0, own.iter().sum::<f64>() / 3.0);
    let sides = [at[1] - at[0], at[2] - at[1], at[0] - at[2]];
    let longest = sides.iter().map(Vec3::norm).fold(0.0, f64::max);
    (0..3).all(|k| ALPHA * (at[k] - center).norm() > size.max(own[k]))
        && sides[0].cross(&sides[1]).norm() > MIN_HEIGHT * size * longest
}

/// Splits triangle `i` into three around its center.
fn split(patch: &mut HolePatch, sizes: &mut Vec<f64>, dictionary: &mut EdgeDictionary, i: usize) {
    let parents = patch.triangles[i];
    let [a, b, c] = parents;
    let center = index_u32(patch.points.len());
    patch.push(NewVertex {
        parents,
        weights: [1.0 / 3.0; 3],
    });
    sizes.push(parents.iter().map(|&p| sizes[p as usize]).sum::<f64>() / 3.0);
    dictionary.split(
        parents,
        index_u32(i),
        index_u32(patch.triangles.len()),
        center,
    );
    patch.triangles[i] = [a, b, center];
    patch.triangles.push([b, c, center]);
    patch.triangles.push([c, a, center]);
}

/// Flips edges toward Delaunay at the vertices' current positions.
pub(super) fn flip_to_delaunay_again(patch: &mut HolePatch, has_edge: &impl Fn(u32, u32) -> bool) {
    let mut dictionary = EdgeDictionary::from_triangles(&patch.triangles);
    flip_to_delaunay(patch, &mut dictionary, has_edge);
}

/// Flips edges toward Delaunay, in at most [`MAX_PASSES`] passes.
fn flip_to_delaunay(
    patch: &mut HolePatch,
    dictionary: &mut EdgeDictionary,
    has_edge: &impl Fn(u32, u32) -> bool,
) {
    for _ in 0..MAX_PASSES {
        let mut flips = 0;
        for i in 0..dictionary.len() {
            let flip = dictionary.flip_of(i, &patch.triangles);
            if improves(&flip, patch, dictionary, has_edge) {
                dictionary.flip(&flip, &mut patch.triangles);
                flips += 1;
            }
        }
        if flips == 0 {
            break;
        }
    }
}

/// Returns whether a flip is valid and brings the patch closer to Delaunay.
///
/// The angles opposite to the edge must sum to more than pi, the new edge must not exist, and the
/// new triangles must not fold.
fn improves(
    flip: &Flip,
    patch: &HolePatch,
    dictionary: &EdgeDictionary,
    has_edge: &impl Fn(u32, u32) -> bool,
) -> bool {
    let ([from, to], [c, d]) = (flip.ends, flip.apexes);
    let at = |v: u32| patch.points[v as usize];
    let is_taken = |v: u32, w: u32| {
        let count = patch.rim;
        let on_rim = (v as usize) < count && (w as usize) < count;
        let steps = v.abs_diff(w) as usize;
        on_rim && (steps == 1 || steps == count - 1 || has_edge(v, w))
    };
    if c == d || !is_not_delaunay(at(from), at(to), at(c), at(d)) {
        return false;
    }
    if dictionary.contains(c, d) || is_taken(c, d) {
        return false;
    }
    let normal = |[a, b, c]: [u32; 3]| (at(b) - at(a)).cross(&(at(c) - at(a)));
    let pairs = [flip.old_triangles(&patch.triangles), flip.new_triangles()];
    let [old_normals, new_normals] = pairs.map(|pair| pair.map(normal));
    let areas = [old_normals, new_normals].map(|pair| pair.map(|n| n.norm()));
    let least = |[x, y]: [f64; 2]| x.min(y);
    let fold = |n: [Vec3; 2], area: [f64; 2]| n[0].dot(&n[1]) / (area[0] * area[1]);
    if least(areas[1]) <= least(areas[0]) {
        return false;
    }
    least(areas[0]) == 0.0 || {
        let side = old_normals[0] / areas[0][0] + old_normals[1] / areas[0][1];
        fold(new_normals, areas[1]) >= MIN_FOLD_COS.min(fold(old_normals, areas[0]))
            && new_normals.iter().all(|n| n.dot(&side) > 0.0)
    }
}

/// Returns whether the angles at `c` and `d` opposite to the edge `ab` sum to more than pi.
///
/// Tests the sign of the sine of the sum, with a tolerance for cocircular points.
fn is_not_delaunay(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> bool {
    let angle = |p: Vec3| {
        let (u, v) = (a - p, b - p);
        (u.cross(&v).norm(), u.dot(&v), u.norm() * v.norm())
    };
    let ((sin_c, cos_c, c), (sin_d, cos_d, d)) = (angle(c), angle(d));
    sin_c * cos_d + cos_c * sin_d < -1e-9 * c * d
}
