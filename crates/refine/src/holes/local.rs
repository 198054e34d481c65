//! Refinement to a size that differs from place to place, of what cannot be unfolded.
//!
//! Liepa's algorithm, of which the paper's Algorithm 4 is the form with one size for all: a triangle is
//! divided at its center when all three corners are farther from it than the sizes there ask for, edges
//! are swapped toward Delaunay, and vertices moved where that makes triangles better. Lengths and angles are those along the patch, so it need not be
//! plane, and a swap never folds it.

use super::smooth::smooth;
use super::{Filling, HoleError, Inner};
use crate::edge_dictionary::EdgeDictionary;
use incise_mesh::Vec3;
use incise_mesh::geometry::area_vector;

/// Liepa's alpha, the root of 3: an equilateral triangle is divided when its edges are longer than the
/// size. He takes the root of 2, with which edges come out a quarter longer than the size on average.
const ALPHA: f64 = 1.732_050_807_568_877_2;

/// A triangle whose smallest height is below this many sizes is not divided. On a long edge of the rim, which stays
/// whole, there is always one whose corners are far from its center, and to divide those for ever makes needles.
const FLAT: f64 = 0.4;

/// No patch has so few triangles as equilateral ones with sides of this many of the largest size would be.
const SPARSE: f64 = 2.0;

/// The most rounds: a round divides lengths by about the root of 3.
const ROUNDS: usize = 40;

/// The most passes of swaps after a round. In the plane a few are enough; elsewhere they need not end.
const PASSES: usize = 6;

/// Times that vertices are moved when all are there.
const LAST: usize = 6;

/// A swap may bend the patch by this much where it was flatter, as the cosine: 45 degrees.
const FOLD: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Refines until triangles have the sizes \[m\] that `sizes` gives the rim's vertices. `joined` as in
/// [`super::minimal::minimal`]; `limit` is how many triangles there may be.
///
/// # Errors
/// [`HoleError::TooManyTriangles`], whose limit the caller sets.
pub(super) fn refine(
    filling: &mut Filling,
    sizes: &mut Vec<f64>,
    limit: usize,
    joined: &impl Fn(u32, u32) -> bool,
) -> Result<(), HoleError> {
    if is_too_fine(filling, sizes, limit) {
        return Err(HoleError::TooManyTriangles { limit });
    }
    for inner in &filling.inner[sizes.len() - filling.rim..] {
        sizes.push(
            inner
                .parents
                .iter()
                .map(|&p| sizes[p as usize])
                .sum::<f64>()
                / 3.0,
        );
    }
    let mut dictionary = EdgeDictionary::of(&filling.triangles, |_, _| false);
    relax(filling, &mut dictionary, joined);
    for _ in 0..ROUNDS {
        let mut grew = false;
        for i in 0..filling.triangles.len() {
            if is_too_large(filling, sizes, i) {
                if filling.triangles.len() + 2 > limit {
                    return Err(HoleError::TooManyTriangles { limit });
                }
                divide(filling, sizes, &mut dictionary, i);
                grew = true;
            }
        }
        let passes = if grew { 1 } else { LAST };
        for _ in 0..passes {
            relax(filling, &mut dictionary, joined);
            smooth(filling);
        }
        if !grew {
            break;
        }
    }
    relax(filling, &mut dictionary, joined);
    Ok(())
}

/// Whether the patch would have too many triangles whatever is done: then there is no use in making the first ones.
#[expect(clippy::cast_precision_loss, reason = "a bound, far from both sides")]
fn is_too_fine(filling: &Filling, sizes: &[f64], limit: usize) -> bool {
    let corners = |t: &[u32; 3]| t.map(|v| filling.points[v as usize]);
    let doubled = |t| area_vector(corners(t)).norm();
    let side = SPARSE * sizes.iter().copied().fold(0.0, f64::max);
    let least = filling.triangles.iter().map(doubled).sum::<f64>() / (0.75f64.sqrt() * side * side);
    least > limit as f64
}

/// Swaps edges and moves vertices of a patch that is refined already, for what bends made of its triangles.
pub(super) fn settle(filling: &mut Filling, joined: &impl Fn(u32, u32) -> bool) {
    let mut dictionary = EdgeDictionary::of(&filling.triangles, |_, _| false);
    for _ in 0..LAST {
        relax(filling, &mut dictionary, joined);
        smooth(filling);
    }
    relax(filling, &mut dictionary, joined);
}

fn is_too_large(filling: &Filling, sizes: &[f64], i: usize) -> bool {
    let corners = filling.triangles[i];
    let at = corners.map(|v| filling.points[v as usize]);
    let own = corners.map(|v| sizes[v as usize]);
    let (center, size) = ((at[0] + at[1] + at[2]) / 3.0, own.iter().sum::<f64>() / 3.0);
    let sides = [at[1] - at[0], at[2] - at[1], at[0] - at[2]];
    let longest = sides.iter().map(Vec3::norm).fold(0.0, f64::max);
    (0..3).all(|k| ALPHA * (at[k] - center).norm() > size.max(own[k]))
        && sides[0].cross(&sides[1]).norm() > FLAT * size * longest
}

/// The triangle becomes three around its center.
fn divide(filling: &mut Filling, sizes: &mut Vec<f64>, dictionary: &mut EdgeDictionary, i: usize) {
    let parents = filling.triangles[i];
    let [a, b, c] = parents;
    let center = id(filling.points.len());
    filling.push(Inner {
        parents,
        weights: [1.0 / 3.0; 3],
    });
    sizes.push(parents.iter().map(|&p| sizes[p as usize]).sum::<f64>() / 3.0);
    let first = id(i);
    let second = id(filling.triangles.len());
    let third = second + 1;
    filling.triangles[i] = [a, b, center];
    filling.triangles.push([b, c, center]);
    filling.triangles.push([c, a, center]);
    dictionary.substitute(b, c, first, second);
    dictionary.substitute(c, a, first, third);
    dictionary.add([a, center], [first, third]);
    dictionary.add([b, center], [first, second]);
    dictionary.add([c, center], [second, third]);
}

/// Swaps edges toward Delaunay where the vertices are now.
#[cfg(feature = "fair")]
pub(super) fn relax_again(filling: &mut Filling, joined: &impl Fn(u32, u32) -> bool) {
    let mut dictionary = EdgeDictionary::of(&filling.triangles, |_, _| false);
    relax(filling, &mut dictionary, joined);
}

/// Swaps edges toward Delaunay until none asks for it.
fn relax(
    filling: &mut Filling,
    dictionary: &mut EdgeDictionary,
    joined: &impl Fn(u32, u32) -> bool,
) {
    for _ in 0..PASSES {
        let swaps = (0..dictionary.len())
            .filter(|&i| swap(filling, dictionary, i, joined))
            .count();
        if swaps == 0 {
            break;
        }
    }
}

/// Swaps edge `i` of the dictionary if the angles opposite to it sum to more than half a turn, the
/// other diagonal is free and the two new triangles are sound; tells whether it did.
fn swap(
    filling: &mut Filling,
    dictionary: &mut EdgeDictionary,
    i: usize,
    joined: &impl Fn(u32, u32) -> bool,
) -> bool {
    let edge = dictionary.edge(i);
    let [t1, t2] = edge.triangles;
    let [a, b] = edge.vertices;
    let triangles = edge.triangles.map(|t| filling.triangles[t as usize]);
    let [c, d] = triangles.map(|t| t[0] ^ t[1] ^ t[2] ^ a ^ b);
    let (from, to) = if follows(triangles[0], a, b) {
        (a, b)
    } else {
        (b, a)
    };
    let at = |v: u32| filling.points[v as usize];
    let is_taken = |v: u32, w: u32| {
        let count = filling.rim;
        let on_rim = (v as usize) < count && (w as usize) < count;
        let steps = v.abs_diff(w) as usize;
        on_rim && (steps == 1 || steps == count - 1 || joined(v, w))
    };
    if c == d || !opens(at(from), at(to), at(c), at(d)) {
        return false;
    }
    if dictionary.contains(c, d) || is_taken(c, d) {
        return false;
    }
    let normal = |[a, b, c]: [u32; 3]| (at(b) - at(a)).cross(&(at(c) - at(a)));
    let new = [[c, d, to], [d, c, from]];
    let [old_normals, new_normals] = [triangles, new].map(|pair| pair.map(normal));
    let areas = [old_normals, new_normals].map(|pair| pair.map(|n| n.norm()));
    let least = |[x, y]: [f64; 2]| x.min(y);
    let fold = |n: [Vec3; 2], area: [f64; 2]| n[0].dot(&n[1]) / (area[0] * area[1]);
    if least(areas[1]) <= least(areas[0]) {
        return false;
    }
    let is_sound = least(areas[0]) == 0.0 || {
        let side = old_normals[0] / areas[0][0] + old_normals[1] / areas[0][1];
        fold(new_normals, areas[1]) >= FOLD.min(fold(old_normals, areas[0]))
            && new_normals.iter().all(|n| n.dot(&side) > 0.0)
    };
    if !is_sound {
        return false;
    }
    filling.triangles[t1 as usize] = new[0];
    filling.triangles[t2 as usize] = new[1];
    // t1 keeps the edge from `to` to c and gains d-to; t2 keeps from-d and gains c-from.
    dictionary.substitute(d, to, t2, t1);
    dictionary.substitute(c, from, t1, t2);
    dictionary.rename(i, [c, d]);
    true
}

/// Whether the angles at `c` and `d` over the edge from `a` to `b` sum to more than half a turn. The sign
/// of the sine of their sum tells, with room for rounding on cocircular points.
fn opens(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> bool {
    let angle = |p: Vec3| {
        let (u, v) = (a - p, b - p);
        (u.cross(&v).norm(), u.dot(&v), u.norm() * v.norm())
    };
    let ((sin_c, cos_c, c), (sin_d, cos_d, d)) = (angle(c), angle(d));
    sin_c * cos_d + cos_c * sin_d < -1e-9 * c * d
}

fn follows([a, b, c]: [u32; 3], start: u32, end: u32) -> bool {
    [(a, b), (b, c), (c, a)].contains(&(start, end))
}

fn id(i: usize) -> u32 {
    u32::try_from(i).expect("patches have 32-bit numbers")
}
