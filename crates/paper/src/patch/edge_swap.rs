//! The paper's Algorithm A3: swaps an interior edge for the other diagonal (an edge flip).
//!
//! Departures from the listing:
//!
//! - Line 10 takes `ac x ab` for the cross product, plain lengths where the circumcenter's formula
//!   has squares, and divides by `2 * ||crossProd||` without parentheses. The formula is
//!   `toCenter = ((ab x ac) x ab |ac|^2 + ac x (ab x ac) |ab|^2) / (2 |ab x ac|^2)`.
//! - Line 6 looks for the new edge in the dictionary, which has interior edges only. An edge of
//!   the rim or of the surrounding surface between the same vertices forbids the swap too.
//! - On a rim that is not planar a swap could invert a triangle. It is rejected unless both new
//!   triangles face along the patch's normal.

use super::Patch;
use incise_mesh::Vec3;
use incise_refine::EdgeDictionary;

/// Share of the radius within which a vertex counts as inside a circumcircle.
///
/// Rounding on cocircular points, as in a square grid, then causes no swaps.
const INSIDE: f64 = 1.0 - 1e-9;

/// Swaps edge `i` of the dictionary if that brings the patch closer to Delaunay.
///
/// `is_taken` returns whether two vertices have an edge of the rim or of the surrounding surface,
/// which the dictionary does not list. Returns whether it swapped.
pub(crate) fn swap(
    patch: &mut Patch,
    dictionary: &mut EdgeDictionary,
    i: usize,
    normal: Vec3,
    is_taken: &impl Fn(u32, u32) -> bool,
) -> bool {
    let flip = dictionary.flip_of(i, &patch.triangles);
    let ([from, to], [v1, v2]) = (flip.ends, flip.apexes);
    // The smaller vertex first, so that rounding does not depend on the triangles' order.
    let (start, end) = (from.min(to), from.max(to));
    let at = |v: u32| patch.points[v as usize];
    if !in_circumcircle(at(start), at(end), at(v1), at(v2))
        && !in_circumcircle(at(start), at(end), at(v2), at(v1))
    {
        dictionary.settle(i);
        return false;
    }
    let faces_out =
        |[a, b, c]: [u32; 3]| (at(b) - at(a)).cross(&(at(c) - at(a))).dot(&normal) > 0.0;
    let faced_out = (flip.old_triangles(&patch.triangles).into_iter()).all(faces_out);
    if faced_out && !flip.new_triangles().into_iter().all(faces_out) {
        dictionary.settle(i);
        return false;
    }
    // Not settled: the existing edge may be swapped away.
    if v1 == v2 || dictionary.contains(v1, v2) || is_taken(v1, v2) {
        return false;
    }
    dictionary.flip(&flip, &mut patch.triangles);
    true
}

/// Returns whether `p` lies inside the circumcircle of `a`, `b` and `c`, around its center in
/// space.
///
/// False if the three points are collinear.
fn in_circumcircle(a: Vec3, b: Vec3, c: Vec3, p: Vec3) -> bool {
    let (ab, ac) = (b - a, c - a);
    let cross = ab.cross(&ac);
    let to_center = (cross.cross(&ab) * ac.norm_squared() + ac.cross(&cross) * ab.norm_squared())
        / (2.0 * cross.norm_squared());
    let radius = to_center.norm();
    (p - (a + to_center)).norm() < radius * INSIDE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn circumcircle_passes_through_three_points() {
        let [a, b, c] = [(3.0, 1.0), (1.0, 3.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, 0.5));
        assert!(in_circumcircle(a, b, c, Vec3::new(1.0, -0.999, 0.5)));
        assert!(!in_circumcircle(a, b, c, Vec3::new(1.0, -1.001, 0.5)));
        assert!(!in_circumcircle(a, b, c, Vec3::new(1.0, -1.0, 0.5)));
        assert!(
            !in_circumcircle(a, a, c, b),
            "collinear points have no circle"
        );
    }
}
