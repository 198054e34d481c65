//! The paper's Algorithm A3: swap an interior edge for the other diagonal by the circumcircle test.
//!
//! What the listing has wrong, and what was decided:
//!
//! - Line 10 takes `ac x ab` for the cross product, plain lengths where the circumcenter's formula
//!   has squares, and divides by `2 * ||crossProd||` without parentheses. The formula is
//!   `toCenter = ((ab x ac) x ab |ac|^2 + ac x (ab x ac) |ab|^2) / (2 |ab x ac|^2)`.
//! - Line 6 looks for the new edge in the dictionary, which knows interior edges only. An edge of
//!   the rim, or of the surface outside, between the same vertices forbids the swap too.
//! - On a rim that is not quite plane a swap could turn a triangle over. It is refused when either
//!   new triangle would not face along the patch's normal.

use crate::edge_dictionary::EdgeDictionary;
use crate::patch::Patch;
use incise_mesh::Vec3;

/// A vertex counts as inside a circumcircle only this much (relative to the radius) within it, so
/// that rounding on cocircular points (a square grid) does not swap for nothing.
const INSIDE: f64 = 1.0 - 1e-9;

/// Swaps edge `i` of the dictionary if that brings the patch closer to Delaunay; tells whether it did. `is_taken` names
/// edges that are there though not in the dictionary: those of the rim, and of the surface outside.
pub(crate) fn swap(
    patch: &mut Patch,
    dictionary: &mut EdgeDictionary,
    i: usize,
    normal: Vec3,
    is_taken: &impl Fn(u32, u32) -> bool,
) -> bool {
    let edge = dictionary.edge(i);
    let [t1, t2] = edge.triangles;
    let [start, end] = edge.vertices;
    let v1 = apex(patch.triangles[t1 as usize], edge.vertices);
    let v2 = apex(patch.triangles[t2 as usize], edge.vertices);
    let at = |v: u32| patch.points[v as usize];
    if !in_circumcircle(at(start), at(end), at(v1), at(v2))
        && !in_circumcircle(at(start), at(end), at(v2), at(v1))
    {
        dictionary.settle(i);
        return false;
    }
    // The triangle that runs along the edge from `from` to `to` is t1; its apex is v1.
    let (from, to) = if follows(patch.triangles[t1 as usize], start, end) {
        (start, end)
    } else {
        (end, start)
    };
    let new1 = [v1, v2, to];
    let new2 = [v2, v1, from];
    let faces_out =
        |[a, b, c]: [u32; 3]| (at(b) - at(a)).cross(&(at(c) - at(a))).dot(&normal) > 0.0;
    let faced_out =
        faces_out(patch.triangles[t1 as usize]) && faces_out(patch.triangles[t2 as usize]);
    if faced_out && !(faces_out(new1) && faces_out(new2)) {
        dictionary.settle(i);
        return false;
    }
    // Not settled: the edge in the way may go.
    if v1 == v2 || dictionary.contains(v1, v2) || is_taken(v1, v2) {
        return false;
    }
    patch.triangles[t1 as usize] = new1;
    patch.triangles[t2 as usize] = new2;
    // t1 keeps the edge to-v1 and gains v2-to; t2 keeps from-v2 and gains v1-from.
    dictionary.unsettle(to, v1);
    dictionary.unsettle(from, v2);
    dictionary.substitute(v2, to, t2, t1);
    dictionary.substitute(v1, from, t1, t2);
    dictionary.rename(i, [v1, v2]);
    true
}

fn apex(triangle: [u32; 3], [a, b]: [u32; 2]) -> u32 {
    triangle
        .into_iter()
        .find(|&v| v != a && v != b)
        .expect("a triangle on an edge has a third vertex")
}

fn follows([a, b, c]: [u32; 3], start: u32, end: u32) -> bool {
    [(a, b), (b, c), (c, a)].contains(&(start, end))
}

/// Whether `p` lies inside the circle through `a`, `b` and `c` (about its center in space). False
/// when the three lie on a line.
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
    fn the_circumcircle_is_the_one_through_three_points() {
        let [a, b, c] = [(3.0, 1.0), (1.0, 3.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, 0.5));
        assert!(in_circumcircle(a, b, c, Vec3::new(1.0, -0.999, 0.5)));
        assert!(!in_circumcircle(a, b, c, Vec3::new(1.0, -1.001, 0.5)));
        assert!(!in_circumcircle(a, b, c, Vec3::new(1.0, -1.0, 0.5)));
        assert!(!in_circumcircle(a, a, c, b), "no circle, nothing inside");
    }
}
