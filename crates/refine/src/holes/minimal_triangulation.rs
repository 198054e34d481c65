//! Minimum triangulation of a rim on its own vertices: least dihedral angle, then least area.
//!
//! Liepa, "Filling Holes in Meshes", SGP 2003, after Barequet and Sharir. Dihedral angles to the
//! surrounding surface count too. Dynamic programming takes O(n^3), so a long rim is split along
//! its best diagonal until its parts are short.

use super::rim::unit;
use incise_mesh::geometry::area_vector;
use incise_mesh::{Vec3, index_u32};
use rustc_hash::FxHashMap;

/// Maximum length of a rim for dynamic programming, which then visits 3 million triangles.
const MAX_RIM: usize = 256;

/// Number of bends per unit of 1 - cos of the dihedral angle; the first bend ends at 3.6 degrees.
///
/// On an almost planar rim all angles are rounding errors, and the area must decide.
const BENDS_PER_UNIT: f64 = 512.0;

/// Maximum number of diagonals that are tested to split a rim.
const MAX_DIAGONALS: usize = 4_000_000;

/// The triangulation of a rim, and its parts that could not be triangulated.
#[derive(Debug, Default)]
pub(super) struct MinimalTriangulation {
    pub(super) triangles: Vec<[u32; 3]>,
    /// Remaining rims, all of whose diagonals are edges of the surface.
    pub(super) open: Vec<Vec<u32>>,
}

/// The best triangulation of the rim's part from vertex i to vertex j.
#[derive(Clone, Copy)]
struct Span {
    /// Largest bend.
    bend: f64,
    /// Twice the area.
    area: f64,
    /// The third vertex of the triangle on the edge from i to j.
    apex: usize,
    /// Unit normal of that triangle, or of the surface's triangle at an edge of the rim.
    normal: Option<Vec3>,
}

/// Triangulates the rim through `points`.
///
/// `across` are the unit normals of the surface's triangles along its edges. `has_edge(a, b)`
/// returns whether the surface already has an edge between two rim vertices.
pub(super) fn triangulate_minimal(
    points: &[Vec3],
    across: &[Vec3],
    has_edge: &impl Fn(u32, u32) -> bool,
) -> MinimalTriangulation {
    let count = index_u32(points.len());
    let mut out = MinimalTriangulation::default();
    let mut known: FxHashMap<[u32; 2], Vec3> = FxHashMap::default();
    for (i, &normal) in (0..count).zip(across) {
        // A triangle without area has no normal to bend against.
        if normal != Vec3::zeros() {
            known.insert([i, (i + 1) % count], normal);
        }
    }
    let mut parts: Vec<Vec<u32>> = vec![(0..count).collect()];
    while let Some(rim) = parts.pop() {
        if rim.len() > MAX_RIM {
            match splitting_diagonal(points, &rim, has_edge) {
                Some([i, j]) => {
                    parts.push(rim[i..=j].to_vec());
                    parts.push([&rim[..=i], &rim[j..]].concat());
                }
                None => out.open.push(rim),
            }
            continue;
        }
        let first = out.triangles.len();
        if !triangulate_part(points, &rim, &known, has_edge, &mut out.triangles) {
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

/// Returns the diagonal that splits a rim best: the shortest relative to the length of its arcs.
#[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 vertices")]
fn splitting_diagonal(
    points: &[Vec3],
    rim: &[u32],
    has_edge: &impl Fn(u32, u32) -> bool,
) -> Option<[usize; 2]> {
    let n = rim.len();
    let step = (n * n / 2).div_ceil(MAX_DIAGONALS);
    let at = |i: usize| points[rim[i] as usize];
    let mut way = vec![0.0; n + 1];
    for i in 0..n {
        way[i + 1] = way[i] + (at((i + 1) % n) - at(i)).norm();
    }
    let mut best = (f64::INFINITY, None);
    for i in (0..n).step_by(step) {
        // Both parts have at least a fourth of the edges, so that parts shrink.
        for j in i + n / 4..(i + n - n / 4).min(n) {
            let along = way[j] - way[i];
            let ratio = (at(j) - at(i)).norm() / along.min(way[n] - along).max(f64::MIN_POSITIVE);
            let middle = (2 * (j - i)).abs_diff(n) as f64 / n as f64;
            let cost = ratio * (1.0 + middle);
            if cost < best.0 && !has_edge(rim[i], rim[j]) {
                best = (cost, Some([i, j]));
            }
        }
    }
    best.1
}

/// Triangulates one rim by dynamic programming and returns whether it succeeded.
fn triangulate_part(
    points: &[Vec3],
    rim: &[u32],
    known: &FxHashMap<[u32; 2], Vec3>,
    has_edge: &impl Fn(u32, u32) -> bool,
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
            if !is_last && has_edge(rim[i], rim[j]) {
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

/// Returns the bend of two triangles at their edge, 0 to 1024; a triangle without area is worst.
fn bend(a: Vec3, b: Vec3) -> f64 {
    let cos = a.dot(&b);
    if a == Vec3::zeros() || b == Vec3::zeros() {
        return 2.0 * BENDS_PER_UNIT;
    }
    ((1.0 - cos) * BENDS_PER_UNIT).round()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point([x, y, z]: [f64; 3]) -> Vec3 {
        Vec3::new(x, y, z)
    }

    proptest! {
        /// Four points get the diagonal that bends less, or else the smaller area.
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
            let found = triangulate_minimal(&points, &across, &|_, _| false);
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
    fn existing_edges_are_not_used_as_diagonals() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let points = square.map(|[x, y]| Vec3::new(x, y, 0.0));
        let across = [Vec3::zeros(); 4];
        let taken = |a: u32, b: u32| (a.min(b), a.max(b)) == (0, 2);
        let found = triangulate_minimal(&points, &across, &taken);
        assert!(
            found
                .triangles
                .iter()
                .all(|t| !(t.contains(&0) && t.contains(&2)))
        );
        assert_eq!((found.triangles.len(), found.open.len()), (2, 0));
        let found = triangulate_minimal(&points, &across, &|_, _| true);
        assert_eq!(found.open, [[0, 1, 2, 3]]);
        assert!(found.triangles.is_empty());
    }
}
