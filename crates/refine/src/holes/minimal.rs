//! Triangles over a rim on its own vertices that bend as little as possible.
//!
//! Liepa, "Filling Holes in Meshes", SGP 2003, after Barequet and Sharir: of all triangulations the one
//! whose largest dihedral angle, against the surface too, is smallest, and among those the one of
//! least area. O(n^3), so a long rim is cut in two along its best diagonal until parts are short.

use super::rim::unit;
use incise_mesh::Vec3;
use incise_mesh::geometry::area_vector;
use rustc_hash::FxHashMap;

/// The longest rim that is triangulated at once: 3 million triangles are looked at.
const AT_ONCE: usize = 256;

/// How finely bends are told apart, as 1 - cos of the angle: 3.6 degrees. On a rim that is almost plane
/// all bends are rounding, and area is to decide.
const BEND: f64 = 512.0;

/// The most diagonals that are looked at to cut a rim in two.
const DIAGONALS: usize = 4_000_000;

/// Triangles over a rim, and what could not be covered.
#[derive(Debug, Default)]
pub(super) struct Minimal {
    pub(super) triangles: Vec<[u32; 3]>,
    /// Rims left, for which the surface has every diagonal already.
    pub(super) open: Vec<Vec<u32>>,
}

/// A part of the patch: what is known of its triangulation, from vertex i to vertex j of its rim.
#[derive(Clone, Copy)]
struct Span {
    bend: f64,
    area: f64,
    /// The third vertex of the triangle on the edge from i to j.
    apex: usize,
    /// That triangle's unit normal; of an edge of the rim that of the triangle across, if there is one.
    normal: Option<Vec3>,
}

/// Triangulates the rim through `points`. `across` are the unit normals of the surface's triangles
/// along its edges, `joined(a, b)` says which diagonals the surface has as edges already.
pub(super) fn minimal(
    points: &[Vec3],
    across: &[Vec3],
    joined: &impl Fn(u32, u32) -> bool,
) -> Minimal {
    let count = u32::try_from(points.len()).expect("rims have 32-bit numbers");
    let mut out = Minimal::default();
    let mut known: FxHashMap<[u32; 2], Vec3> = FxHashMap::default();
    for (i, &normal) in (0..count).zip(across) {
        // What has no area bends no way.
        if normal != Vec3::zeros() {
            known.insert([i, (i + 1) % count], normal);
        }
    }
    let mut parts: Vec<Vec<u32>> = vec![(0..count).collect()];
    while let Some(rim) = parts.pop() {
        if rim.len() > AT_ONCE {
            match cut(points, &rim, joined) {
                Some([i, j]) => {
                    parts.push(rim[i..=j].to_vec());
                    parts.push([&rim[..=i], &rim[j..]].concat());
                }
                None => out.open.push(rim),
            }
            continue;
        }
        let first = out.triangles.len();
        if !cover(points, &rim, &known, joined, &mut out.triangles) {
            out.open.push(rim);
            continue;
        }
        for &[a, b, c] in &out.triangles[first..] {
            let normal = unit(area_vector([a, b, c].map(|v| points[v as usize])));
            known.extend([[b, a], [c, b], [a, c]].map(|side| (side, normal)));
        }
    }
    out
}

/// Where to cut a long rim in two: the diagonal that is shortest against the way along the rim.
#[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 vertices")]
fn cut(points: &[Vec3], rim: &[u32], joined: &impl Fn(u32, u32) -> bool) -> Option<[usize; 2]> {
    let n = rim.len();
    let step = (n * n / 2).div_ceil(DIAGONALS);
    let at = |i: usize| points[rim[i] as usize];
    let mut way = vec![0.0; n + 1];
    for i in 0..n {
        way[i + 1] = way[i] + (at((i + 1) % n) - at(i)).norm();
    }
    let mut best = (f64::INFINITY, None);
    for i in (0..n).step_by(step) {
        // Neither part is shorter than a fourth, so that parts shrink.
        for j in i + n / 4..(i + n - n / 4).min(n) {
            let along = way[j] - way[i];
            let ratio = (at(j) - at(i)).norm() / along.min(way[n] - along).max(f64::MIN_POSITIVE);
            let middle = (2 * (j - i)).abs_diff(n) as f64 / n as f64;
            let cost = ratio * (1.0 + middle);
            if cost < best.0 && !joined(rim[i], rim[j]) {
                best = (cost, Some([i, j]));
            }
        }
    }
    best.1
}

/// Triangulates one rim; tells whether it could.
fn cover(
    points: &[Vec3],
    rim: &[u32],
    known: &FxHashMap<[u32; 2], Vec3>,
    joined: &impl Fn(u32, u32) -> bool,
    triangles: &mut Vec<[u32; 3]>,
) -> bool {
    let n = rim.len();
    let none = Span {
        bend: f64::INFINITY,
        area: f64::INFINITY,
        apex: usize::MAX,
        normal: None,
    };
    let mut spans = vec![none; n * n];
    let edge = |i: usize, j: usize| known.get(&[rim[i], rim[j]]).copied();
    for i in 0..n - 1 {
        let normal = edge(i, i + 1);
        spans[i * n + i + 1] = Span {
            bend: 0.0,
            area: 0.0,
            apex: usize::MAX,
            normal,
        };
    }
    for length in 2..n {
        for i in 0..n - length {
            let j = i + length;
            let is_last = length == n - 1;
            if !is_last && joined(rim[i], rim[j]) {
                continue;
            }
            let outside = if is_last { edge(j, i) } else { None };
            let mut best = none;
            for m in i + 1..j {
                let (left, right) = (spans[i * n + m], spans[m * n + j]);
                let below = left.bend.max(right.bend);
                if below > best.bend {
                    continue;
                }
                let cross = area_vector([i, m, j].map(|k| points[rim[k] as usize]));
                let normal = unit(cross);
                let neighbors = [left.normal, right.normal, outside];
                let bend = neighbors
                    .into_iter()
                    .flatten()
                    .map(|other| bend(normal, other))
                    .fold(below, f64::max);
                let area = left.area + right.area + cross.norm();
                if bend < best.bend || bend == best.bend && area < best.area {
                    best = Span {
                        bend,
                        area,
                        apex: m,
                        normal: Some(normal),
                    };
                }
            }
            spans[i * n + j] = best;
        }
    }
    if spans[n - 1].apex == usize::MAX {
        return false;
    }
    let mut open = vec![(0, n - 1)];
    while let Some((i, j)) = open.pop() {
        if j > i + 1 {
            let m = spans[i * n + j].apex;
            triangles.push([i, m, j].map(|k| rim[k]));
            open.extend([(i, m), (m, j)]);
        }
    }
    true
}

/// How much two triangles bend along their edge, 0 to 1024. One without area is the worst.
fn bend(a: Vec3, b: Vec3) -> f64 {
    let cos = a.dot(&b);
    if a == Vec3::zeros() || b == Vec3::zeros() {
        return 2.0 * BEND;
    }
    ((1.0 - cos) * BEND).round()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point([x, y, z]: [f64; 3]) -> Vec3 {
        Vec3::new(x, y, z)
    }

    proptest! {
        /// Of the two triangulations of four points the one that bends less, and of equals the smaller.
        #[test]
        fn four_points_get_the_better_diagonal(
            points in prop::array::uniform4(prop::array::uniform3(-1.0f64..1.0)),
            outside in prop::array::uniform4(prop::array::uniform3(-1.0f64..1.0)),
        ) {
            let points = points.map(point);
            let across = outside.map(|p| unit(point(p)));
            let cost = |pair: [[usize; 3]; 2]| {
                let cross = pair.map(|t| area_vector(t.map(|v| points[v])));
                let normals = cross.map(unit);
                let mut worst = bend(normals[0], normals[1]);
                for (t, normal) in pair.iter().zip(normals) {
                    for k in 0..3 {
                        if (t[k] + 1) % 4 == t[(k + 1) % 3] {
                            worst = worst.max(bend(normal, across[t[k]]));
                        }
                    }
                }
                (worst, cross[0].norm() + cross[1].norm())
            };
            let pairs = [[[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]];
            let [one, other] = pairs.map(cost);
            prop_assume!(one.0 != other.0 || (one.1 - other.1).abs() > 1e-9);
            let best = usize::from(other < one);
            let found = minimal(&points, &across, &|_, _| false);
            let mut sorted: Vec<Vec<u32>> = found.triangles.iter().map(|t| {
                let mut t = t.to_vec();
                t.sort_unstable();
                t
            }).collect();
            sorted.sort_unstable();
            let expected = pairs[best].map(|t| t.map(|v| u32::try_from(v).unwrap()).to_vec());
            prop_assert_eq!(sorted, expected.to_vec());
        }
    }

    #[test]
    fn diagonals_that_the_surface_has_are_not_used() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let points = square.map(|[x, y]| Vec3::new(x, y, 0.0));
        let across = [Vec3::zeros(); 4];
        let found = minimal(&points, &across, &|a, b| (a.min(b), a.max(b)) == (0, 2));
        assert!(
            found
                .triangles
                .iter()
                .all(|t| !(t.contains(&0) && t.contains(&2)))
        );
        assert_eq!((found.triangles.len(), found.open.len()), (2, 0));
        let found = minimal(&points, &across, &|_, _| true);
        assert_eq!(found.open, [[0, 1, 2, 3]]);
        assert!(found.triangles.is_empty());
    }
}
