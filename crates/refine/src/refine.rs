//! The paper's Algorithm 4: subdivide triangles that are too large, swap edges, repeat.
//!
//! What the listing leaves open, and what was decided:
//!
//! - Formula 1 sums n + 1 terms and divides by n; here it is n and n.
//! - Line 9 calls the triangle's edges its vertices; line 10 means their lengths.
//! - Line 8 runs to the number of triangles less 2, which would skip two triangles and, if the
//!   number grows on the way, subdivide new ones before any swap. Each round looks once at every
//!   triangle that there was when it began.
//! - n, the number of rounds, "may require more or less" by model: rounds go on until none
//!   subdivides a triangle, at most [`RefineParams::max_rounds`].
//! - The rim is not subdivided, so a triangle on a rim edge longer than 3/2 alpha has a mean edge
//!   over alpha whatever its third vertex, and so have its neighbors: the listing would subdivide
//!   them for ever into slivers (always at level 2x-finer). A triangle that is flat already, its
//!   smallest height below [`FLAT`] alpha, is left as it is.

use crate::edge_dictionary::EdgeDictionary;
use crate::patch::{Patch, RefineError, RefineParams};
use crate::swap::swap;
use crate::triangulate::index;
use incise_mesh::Vec3;

/// A triangle whose smallest height is below this many alpha is not subdivided. An equilateral one
/// of mean edge alpha has 0.87.
const FLAT: f64 = 0.65;

/// A bound of the triangles takes all for equilateral ones of this many alpha. None that is left has a larger area but
/// the flat ones along long edges of the rim.
const SPARSE: f64 = 1.2;

/// Formula 1: the mean length of the rim's edges, t \[m\].
#[must_use]
#[expect(
    clippy::cast_precision_loss,
    reason = "a rim has far fewer than 2^53 vertices"
)]
pub fn mean_rim_length(rim: &[Vec3]) -> f64 {
    let sum: f64 = (0..rim.len())
        .map(|i| (rim[(i + 1) % rim.len()] - rim[i]).norm())
        .sum();
    sum / rim.len().max(1) as f64
}

/// Subdivides every triangle whose mean edge exceeds `alpha` \[m\] and swaps edges, in rounds. The
/// rim stays as it is. `normal` and `joined` as in [`crate::fill`].
///
/// # Errors
/// [`RefineError::TooManyTriangles`] when the patch grows over `params.max_triangles`.
pub fn refine(
    patch: &mut Patch,
    normal: Vec3,
    alpha: f64,
    params: &RefineParams,
    joined: &impl Fn(u32, u32) -> bool,
) -> Result<(), RefineError> {
    let rim = patch.rim;
    let is_taken = |a: u32, b: u32| {
        let (i, j) = (a as usize, b as usize);
        i < rim && j < rim && ((i + 1) % rim == j || (j + 1) % rim == i || joined(a, b))
    };
    let dictionary = EdgeDictionary::of(&patch.triangles, |_, _| false);
    refine_edges(patch, dictionary, normal, alpha, params, &is_taken, |_| {
        true
    })
}

/// [`refine`] with the edges that may be swapped in `dictionary`, and others that are there in `is_taken`. A
/// triangle whose center `place` refuses stays whole.
pub(crate) fn refine_edges(
    patch: &mut Patch,
    mut dictionary: EdgeDictionary,
    normal: Vec3,
    alpha: f64,
    params: &RefineParams,
    is_taken: &impl Fn(u32, u32) -> bool,
    mut place: impl FnMut(Vec3) -> bool,
) -> Result<(), RefineError> {
    if is_too_fine(patch, alpha, params) {
        return Err(RefineError::TooManyTriangles {
            limit: params.max_triangles,
        });
    }
    let mut swaps = swap_all(patch, &mut dictionary, normal, is_taken);
    let mut converged = false;
    let mut rounds = 0;
    while !converged && rounds < params.max_rounds {
        converged = true;
        for i in 0..patch.triangles.len() {
            if patch.triangles.len() > params.max_triangles {
                break;
            }
            if !is_too_large(patch, i, alpha) {
                continue;
            }
            let [a, b, c] = patch.triangles[i].map(|v| patch.points[v as usize]);
            let center = (a + b + c) / 3.0;
            if place(center) {
                subdivide(patch, &mut dictionary, i, center);
                converged = false;
            }
        }
        if patch.triangles.len() > params.max_triangles {
            return Err(RefineError::TooManyTriangles {
                limit: params.max_triangles,
            });
        }
        if !converged {
            swaps += swap_all(patch, &mut dictionary, normal, is_taken);
            rounds += 1;
        }
    }
    patch.report.rounds = rounds;
    patch.report.swaps = swaps;
    patch.report.converged =
        converged || !(0..patch.triangles.len()).any(|i| is_too_large(patch, i, alpha));
    Ok(())
}

/// Whether the patch is going to have too many triangles: then there is no use in making the first ones. Its area is
/// no less than the length of its area vector, which the rim alone tells.
#[expect(clippy::cast_precision_loss, reason = "a bound, far from both sides")]
fn is_too_fine(patch: &Patch, alpha: f64, params: &RefineParams) -> bool {
    let limit = params.max_triangles as f64;
    // A round divides a triangle in three. With few of them the limit may not be reached, whatever the area.
    let grown = patch.triangles.len() as f64 * 3f64.powf(f64::from(params.max_rounds) / 1.5);
    let at = |v: u32| patch.points[v as usize] - patch.points[0];
    let doubled: Vec3 = (patch.triangles.iter())
        .map(|&[a, b, c]| (at(b) - at(a)).cross(&(at(c) - at(a))))
        .sum();
    let side = SPARSE * alpha;
    grown > limit && doubled.norm() / (0.75f64.sqrt() * side * side) > limit
}

/// Lines 6 and 25: one swap attempt on every edge of the dictionary. Nothing moves, so an edge that was not to be
/// swapped still is not while its two triangles are the same.
fn swap_all(
    patch: &mut Patch,
    dictionary: &mut EdgeDictionary,
    normal: Vec3,
    is_taken: &impl Fn(u32, u32) -> bool,
) -> usize {
    (0..dictionary.len())
        .filter(|&i| !dictionary.is_settled(i) && swap(patch, dictionary, i, normal, is_taken))
        .count()
}

/// Lines 10 and 11: whether the triangle's mean edge exceeds `alpha`, and it is not flat.
fn is_too_large(patch: &Patch, i: usize, alpha: f64) -> bool {
    let [a, b, c] = patch.triangles[i].map(|v| patch.points[v as usize]);
    let edges = [(b - a).norm(), (c - b).norm(), (a - c).norm()];
    let longest = edges.into_iter().fold(0.0, f64::max);
    edges.iter().sum::<f64>() / 3.0 > alpha
        && (b - a).cross(&(c - a)).norm() > FLAT * alpha * longest
}

/// Lines 12 to 22: the triangle becomes three around its center.
fn subdivide(patch: &mut Patch, dictionary: &mut EdgeDictionary, i: usize, center: Vec3) {
    let [v1, v2, v3] = patch.triangles[i];
    let vc = index(patch.points.len());
    patch.points.push(center);
    patch.inner.push([v1, v2, v3]);
    let first = index(i);
    let second = index(patch.triangles.len());
    let third = second + 1;
    patch.triangles[i] = [v1, v2, vc];
    patch.triangles.push([vc, v2, v3]);
    patch.triangles.push([v1, vc, v3]);
    dictionary.unsettle(v1, v2);
    dictionary.substitute(v2, v3, first, second);
    dictionary.substitute(v3, v1, first, third);
    dictionary.add([v1, vc], [first, third]);
    dictionary.add([v2, vc], [first, second]);
    dictionary.add([v3, vc], [second, third]);
}

#[cfg(test)]
mod tests {
    use crate::{Patch, RefineError, RefineParams, RefinementLevel, fill};
    use incise_mesh::Vec3;
    use proptest::prelude::*;
    use std::collections::HashMap;

    fn circle(n: u32) -> Vec<Vec3> {
        (0..n)
            .map(|i| f64::from(i) * std::f64::consts::TAU / f64::from(n))
            .map(|a| Vec3::new(a.cos(), a.sin(), 0.0))
            .collect()
    }

    fn check(patch: &Patch) {
        let mut sides: HashMap<(u32, u32), u32> = HashMap::new();
        for &[a, b, c] in &patch.triangles {
            for side in [(a, b), (b, c), (c, a)] {
                *sides.entry(side).or_default() += 1;
            }
        }
        assert!(
            sides.values().all(|&n| n == 1),
            "an edge is used once a side"
        );
        let rim = u32::try_from(patch.rim).unwrap();
        let open = sides.keys().filter(|&&(a, b)| !sides.contains_key(&(b, a)));
        let mut count = 0;
        for &(a, b) in open {
            assert_eq!(b, (a + 1) % rim, "only the rim is open");
            count += 1;
        }
        assert_eq!(count, rim);
        assert_eq!(patch.triangles.len(), patch.rim - 2 + 2 * patch.inner.len());
        for (i, parents) in patch.inner.iter().enumerate() {
            assert!(parents.iter().all(|&p| (p as usize) < patch.rim + i));
        }
    }

    #[test]
    fn five_levels_are_ordered_and_meet_their_length() {
        let rim = circle(40);
        let mut last = 0;
        for level in RefinementLevel::FIVE {
            let params = RefineParams {
                level,
                ..RefineParams::default()
            };
            let patch = fill(&rim, Vec3::z(), &params, |_, _| false).unwrap();
            check(&patch);
            assert!(patch.report.converged);
            assert!(patch.triangles.len() > last, "{level} is finer");
            last = patch.triangles.len();
            let area: f64 = patch
                .triangles
                .iter()
                .map(|t| {
                    let [a, b, c] = t.map(|v| patch.points[v as usize]);
                    let area = (b - a).cross(&(c - a)).z / 2.0;
                    assert!(area > 0.0, "no triangle is turned over");
                    area
                })
                .sum();
            assert!((area - 20.0 * (std::f64::consts::TAU / 40.0).sin()).abs() < 1e-12);
        }
    }

    #[test]
    fn bad_input_is_an_error() {
        let params = |z| RefineParams {
            level: RefinementLevel::Z(z),
            ..RefineParams::default()
        };
        let rim = circle(8);
        let none = RefineParams {
            rim_length: Some(0.0),
            ..params(1.0)
        };
        let out = fill(&rim, Vec3::z(), &none, |_, _| false);
        assert_eq!(out, Err(RefineError::NonPositiveLength { length: 0.0 }));
        for z in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let out = fill(&rim, Vec3::z(), &params(z), |_, _| false);
            assert!(matches!(out, Err(RefineError::NonPositiveLevel { .. })));
        }
        let out = fill(&rim[..2], Vec3::z(), &params(1.0), |_, _| false);
        assert_eq!(out, Err(RefineError::RimTooShort { vertices: 2 }));
        let mut bad = rim.clone();
        bad[5].y = f64::NAN;
        let out = fill(&bad, Vec3::z(), &params(1.0), |_, _| false);
        assert_eq!(out, Err(RefineError::NonFinite { vertex: 5 }));
        let small = RefineParams {
            max_triangles: 1000,
            ..params(1e-3)
        };
        let out = fill(&rim, Vec3::z(), &small, |_, _| false);
        assert_eq!(out, Err(RefineError::TooManyTriangles { limit: 1000 }));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// The bound ahead of the work never refuses what the work would not have: as many triangles as are made
        /// are allowed to be made.
        #[test]
        fn the_bound_is_below_what_is_made(
            radii in prop::collection::vec(0.3f64..1.0, 3..30),
            z in 0.03f64..1.0,
            max_rounds in 1u32..24,
        ) {
            let n = radii.len() as f64;
            let rim: Vec<Vec3> = radii.iter().enumerate().map(|(i, r)| {
                let a = i as f64 * std::f64::consts::TAU / n;
                Vec3::new(r * a.cos(), r * a.sin(), 0.1 * r)
            }).collect();
            let params = RefineParams { level: RefinementLevel::Z(z), max_rounds, ..RefineParams::default() };
            let free = |_, _| false;
            let made = fill(&rim, Vec3::z(), &params, free).unwrap();
            let just = RefineParams { max_triangles: made.triangles.len(), ..params };
            prop_assert_eq!(fill(&rim, Vec3::z(), &just, free), Ok(made));
        }

        /// Rims that cross themselves, bend out of the plane or repeat points still give patches
        /// that meet edge to edge.
        #[test]
        fn any_rim_gives_a_closed_patch(
            points in prop::collection::vec([-1.0f64..1.0, -1.0..1.0, -0.3..0.3], 3..24),
            z in 0.4f64..2.5,
        ) {
            let rim: Vec<Vec3> = points.iter().map(|&p| p.into()).collect();
            let params = RefineParams { level: RefinementLevel::Z(z), ..RefineParams::default() };
            check(&fill(&rim, Vec3::z(), &params, |_, _| false).unwrap());
        }
    }
}
