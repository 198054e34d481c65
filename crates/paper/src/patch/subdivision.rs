//! The paper's Algorithm 4: subdivide triangles that are too large, swap edges, repeat.
//!
//! Departures from the listing:
//!
//! - Formula 1 sums n + 1 terms and divides by n; here it is n and n.
//! - Line 9 calls the triangle's edges its vertices; line 10 means their lengths.
//! - Line 8 runs to the number of triangles minus 2. That would skip two triangles and, if the
//!   number grows during the loop, subdivide new ones before any swap. Here, each round visits
//!   the triangles that existed at its start once.
//! - The number of rounds n "may require more or less" by model. Here, rounds continue until none
//!   subdivides a triangle, at most [`PaperParams::max_rounds`].
//! - The rim is not subdivided. A triangle on a rim edge longer than 3/2 alpha has a mean edge over
//!   alpha for any third vertex, and so have its neighbors. The listing would subdivide them into
//!   slivers without end (always at level 2x-finer). A triangle whose smallest height is below
//!   [`MIN_HEIGHT`] alpha is therefore not subdivided.

use super::Patch;
use super::edge_swap::swap;
use crate::error::PaperError;
use crate::params::PaperParams;
use incise_mesh::{Vec3, index_u32};
use incise_refine::{EdgeDictionary, RefineError};

/// Minimum height, in alpha, of a triangle to subdivide; an equilateral one has 0.87.
const MIN_HEIGHT: f64 = 0.65;

/// Edge length, in alpha, of equilateral triangles that bound the triangle count from below.
///
/// No refined triangle has a larger area, except flat ones along long edges of the rim.
const BOUND_EDGE: f64 = 1.2;

/// Returns the mean length of the rim's edges \[m\]: t of Formula 1.
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

/// Subdivides every triangle whose mean edge exceeds `alpha` \[m\] and swaps edges, in rounds.
///
/// The rim stays as it is. [`fill`](super::fill) explains `normal` and `has_edge`.
///
/// # Errors
/// [`PaperError::Refine`] when the patch grows over `params.max_triangles`.
pub fn refine(
    patch: &mut Patch,
    normal: Vec3,
    alpha: f64,
    params: &PaperParams,
    has_edge: &impl Fn(u32, u32) -> bool,
) -> Result<(), PaperError> {
    let rim = patch.rim_len;
    let is_taken = |a: u32, b: u32| {
        let (i, j) = (a as usize, b as usize);
        i < rim && j < rim && ((i + 1) % rim == j || (j + 1) % rim == i || has_edge(a, b))
    };
    let mut dictionary = EdgeDictionary::from_triangles(&patch.triangles);
    let limit = params.max_triangles;
    let too_many = RefineError::TooManyTriangles { limit };
    if is_too_fine(patch, alpha, params) {
        return Err(too_many.into());
    }
    let mut swaps = swap_all(patch, &mut dictionary, normal, &is_taken);
    let mut converged = false;
    let mut rounds = 0;
    while !converged && rounds < params.max_rounds {
        converged = true;
        for i in 0..patch.triangles.len() {
            if patch.triangles.len() > limit {
                break;
            }
            if is_too_large(patch, i, alpha) {
                subdivide(patch, &mut dictionary, i);
                converged = false;
            }
        }
        if patch.triangles.len() > limit {
            return Err(too_many.into());
        }
        if !converged {
            swaps += swap_all(patch, &mut dictionary, normal, &is_taken);
            rounds += 1;
        }
    }
    patch.report.rounds = rounds;
    patch.report.swaps = swaps;
    patch.report.converged =
        converged || !(0..patch.triangles.len()).any(|i| is_too_large(patch, i, alpha));
    Ok(())
}

/// Returns whether a lower bound of the triangle count exceeds the limit.
///
/// The patch's area is at least the length of its area vector, which depends on the rim alone.
#[expect(clippy::cast_precision_loss, reason = "a bound, far from both sides")]
fn is_too_fine(patch: &Patch, alpha: f64, params: &PaperParams) -> bool {
    let limit = params.max_triangles as f64;
    // A round splits a triangle in three, so few rounds may stay below the limit for any area.
    let grown = patch.triangles.len() as f64 * 3f64.powf(f64::from(params.max_rounds) / 1.5);
    let at = |v: u32| patch.points[v as usize] - patch.points[0];
    let doubled: Vec3 = (patch.triangles.iter())
        .map(|&[a, b, c]| (at(b) - at(a)).cross(&(at(c) - at(a))))
        .sum();
    let side = BOUND_EDGE * alpha;
    grown > limit && doubled.norm() / (0.75f64.sqrt() * side * side) > limit
}

/// Lines 6 and 25: attempts one swap of every edge of the dictionary.
///
/// Vertices do not move, so the result for an edge stays the same until a triangle changes.
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

/// Lines 10 and 11: returns whether the mean edge exceeds `alpha` and the triangle is not flat.
fn is_too_large(patch: &Patch, i: usize, alpha: f64) -> bool {
    let [a, b, c] = patch.triangles[i].map(|v| patch.points[v as usize]);
    let edges = [(b - a).norm(), (c - b).norm(), (a - c).norm()];
    let longest = edges.into_iter().fold(0.0, f64::max);
    edges.iter().sum::<f64>() / 3.0 > alpha
        && (b - a).cross(&(c - a)).norm() > MIN_HEIGHT * alpha * longest
}

/// Lines 12 to 22: splits a triangle into three around its center.
fn subdivide(patch: &mut Patch, dictionary: &mut EdgeDictionary, i: usize) {
    let [v1, v2, v3] = patch.triangles[i];
    let [a, b, c] = patch.triangles[i].map(|v| patch.points[v as usize]);
    let vc = index_u32(patch.points.len());
    patch.points.push((a + b + c) / 3.0);
    patch.parents.push([v1, v2, v3]);
    dictionary.split(
        [v1, v2, v3],
        index_u32(i),
        index_u32(patch.triangles.len()),
        vc,
    );
    patch.triangles[i] = [v1, v2, vc];
    patch.triangles.push([vc, v2, v3]);
    patch.triangles.push([v1, vc, v3]);
}

#[cfg(test)]
mod tests {
    use crate::{PaperError, PaperParams, Patch, fill};
    use incise_mesh::Vec3;
    use incise_refine::{RefineError, RefinementLevel};
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
        let rim = u32::try_from(patch.rim_len).unwrap();
        let open = sides.keys().filter(|&&(a, b)| !sides.contains_key(&(b, a)));
        let mut count = 0;
        for &(a, b) in open {
            assert_eq!(b, (a + 1) % rim, "only the rim is open");
            count += 1;
        }
        assert_eq!(count, rim);
        assert_eq!(
            patch.triangles.len(),
            patch.rim_len - 2 + 2 * patch.parents.len()
        );
        for (i, parents) in patch.parents.iter().enumerate() {
            assert!(parents.iter().all(|&p| (p as usize) < patch.rim_len + i));
        }
    }

    #[test]
    fn five_levels_are_ordered_and_meet_their_length() {
        let rim = circle(40);
        let mut last = 0;
        for level in RefinementLevel::FIVE {
            let params = PaperParams {
                level,
                ..PaperParams::default()
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
        let params = |z| PaperParams {
            level: RefinementLevel::Z(z),
            ..PaperParams::default()
        };
        let rim = circle(8);
        let none = PaperParams {
            rim_length: Some(0.0),
            ..params(1.0)
        };
        let out = fill(&rim, Vec3::z(), &none, |_, _| false);
        let text = out.unwrap_err().to_string();
        assert_eq!(text, "rim_length is 0; it must be a finite number above 0");
        for z in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let out = fill(&rim, Vec3::z(), &params(z), |_, _| false);
            assert!(matches!(out, Err(PaperError::Parameter(_))));
        }
        let out = fill(&rim[..2], Vec3::z(), &params(1.0), |_, _| false);
        assert_eq!(out, Err(PaperError::RimTooShort { vertices: 2 }));
        let mut bad = rim.clone();
        bad[5].y = f64::NAN;
        let out = fill(&bad, Vec3::z(), &params(1.0), |_, _| false);
        assert_eq!(out, Err(RefineError::NonFinite { vertex: 5 }.into()));
        let small = PaperParams {
            max_triangles: 1000,
            ..params(1e-3)
        };
        let out = fill(&rim, Vec3::z(), &small, |_, _| false);
        assert_eq!(
            out,
            Err(RefineError::TooManyTriangles { limit: 1000 }.into())
        );
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// The lower bound never rejects a patch that stays within the limit.
        #[test]
        fn lower_bound_does_not_exceed_the_triangle_count(
            radii in prop::collection::vec(0.3f64..1.0, 3..30),
            z in 0.03f64..1.0,
            max_rounds in 1u32..24,
        ) {
            let n = radii.len() as f64;
            let rim: Vec<Vec3> = radii.iter().enumerate().map(|(i, r)| {
                let a = i as f64 * std::f64::consts::TAU / n;
                Vec3::new(r * a.cos(), r * a.sin(), 0.1 * r)
            }).collect();
            let level = RefinementLevel::Z(z);
            let params = PaperParams { level, max_rounds, ..PaperParams::default() };
            let free = |_, _| false;
            let patch = fill(&rim, Vec3::z(), &params, free).unwrap();
            let tight = PaperParams { max_triangles: patch.triangles.len(), ..params };
            prop_assert_eq!(fill(&rim, Vec3::z(), &tight, free), Ok(patch));
        }

        /// Rims that cross themselves, leave the plane or repeat points still give a manifold.
        #[test]
        fn any_rim_gives_a_closed_patch(
            points in prop::collection::vec([-1.0f64..1.0, -1.0..1.0, -0.3..0.3], 3..24),
            z in 0.4f64..2.5,
        ) {
            let rim: Vec<Vec3> = points.iter().map(|&p| p.into()).collect();
            let params = PaperParams { level: RefinementLevel::Z(z), ..PaperParams::default() };
            check(&fill(&rim, Vec3::z(), &params, |_, _| false).unwrap());
        }
    }
}
