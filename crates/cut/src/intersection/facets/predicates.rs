//! Exact signs of mesh elements relative to facets, and the order of points along edges.

use super::Facets;
use crate::intersection::order::{Plane, compare_along};
use incise_mesh::Vec3;
use robust::{Coord3D, orient3d};
use std::cmp::Ordering;

/// For each edge of a facet, whether a point on its plane is on the inner side.
pub(crate) type Inside = [bool; 3];

impl Facets {
    /// Returns whether `p` is above the plane of facet `i`.
    pub(crate) fn is_above(&self, i: u32, p: Vec3) -> bool {
        let [a, b, c] = self.corners_of(i).map(coord);
        // `orient3d` is negative for a point on the side to which the normal points.
        let sign = orient3d(a, b, c, coord(p));
        sign < 0.0 || (sign == 0.0 && self.facets[i as usize].tie_is_above)
    }

    /// Tests on which side of each edge of facet `i` the edge from `p` to `q` crosses its plane.
    ///
    /// `p` and `q` are on different sides of it; `q` is above if `rises`.
    pub(crate) fn inside(&self, i: u32, p: Vec3, q: Vec3, rises: bool) -> Inside {
        let [a, b, c] = self.facets[i as usize].corners;
        [(a, b), (b, c), (c, a)].map(|(a, b)| {
            let sign = self.around(p, q, a, b);
            if rises { sign < 0.0 } else { sign > 0.0 }
        })
    }

    /// Returns whether a sweep edge pierces the mesh triangle.
    pub(crate) fn pierces(&self, edge: u32, [p, q, r]: [Vec3; 3]) -> bool {
        let [a, b] = self.edges[edge as usize].ends;
        let normal = [0, 1, 2].map(|k| cross_sign(&[(p, q), (q, r), (r, p)], k));
        let Some(tie) = normal.into_iter().find(|&sign| sign != 0.0) else {
            return false;
        };
        let is_above = |corner: u32| {
            let [p, q, r] = [p, q, r].map(coord);
            let sign = orient3d(p, q, r, coord(self.corner(corner)));
            sign < 0.0 || (sign == 0.0 && tie * self.direction() > 0.0)
        };
        if is_above(a) == is_above(b) {
            return false;
        }
        let signs = [(p, q), (q, r), (r, p)].map(|(x, y)| self.around(x, y, a, b));
        signs.iter().all(|&s| s > 0.0) || signs.iter().all(|&s| s < 0.0)
    }

    /// Compares the points at which the mesh edge from `p` to `q` crosses facets `i` and `j`.
    ///
    /// The order from `q` to `p` is the reverse. Of two facets in one plane, as those of a blade
    /// that turned over, the later one counts as above the other.
    pub(crate) fn compare_on_mesh_edge(&self, [p, q]: [Vec3; 2], i: u32, j: u32) -> Ordering {
        let planes = [i, j].map(|i| Plane(self.corners_of(i)));
        compare_along([p, q], [&planes[0], &planes[1]], self.direction()).then_with(|| {
            if self.is_above(i.min(j), q) {
                i.cmp(&j)
            } else {
                j.cmp(&i)
            }
        })
    }

    /// Compares the points at which a sweep edge pierces two mesh triangles.
    ///
    /// Equal only for triangles in one plane.
    pub(crate) fn compare_on_sweep_edge(&self, edge: u32, a: [Vec3; 3], b: [Vec3; 3]) -> Ordering {
        // That the sweep moves by d is the same as that the triangles move by -d.
        compare_along(self.ends(edge), [&Plane(a), &Plane(b)], -self.direction())
    }

    /// Returns whether the facets beside a crease rise above each other's planes.
    pub(crate) fn is_valley(&self, crease: u32) -> bool {
        let [left, right] = self.edges[crease as usize].facets;
        let (first, second) = (left.min(right), left.max(right));
        let [a, b, c] = self.corners_of(first).map(coord);
        let beyond = (0..3).find(|&k| self.edges_of(second)[k] == crease);
        let opposite = beyond.map_or(0, |k| (k + 2) % 3);
        orient3d(a, b, c, coord(self.corners_of(second)[opposite])) <= 0.0
    }

    /// Returns the sign of the line from `p` to `q` relative to the sweep's line from corner `a` to
    /// corner `b`; 0 only for parallel lines.
    fn around(&self, p: Vec3, q: Vec3, a: u32, b: u32) -> f64 {
        let (a, b) = (self.corner(a), self.corner(b));
        let sign = orient3d(coord(p), coord(q), coord(a), coord(b));
        if sign != 0.0 {
            return sign;
        }
        // Moving a and b by d changes it by d . ((p - q) x (a - b)).
        let components = [0, 1, 2].map(|k| cross_sign(&[(p, a), (q, b), (b, p), (a, q)], k));
        let tie = components.into_iter().find(|&s| s != 0.0).unwrap_or(0.0);
        tie * self.direction()
    }

    /// Returns the sign of the infinitesimal translation that breaks ties.
    fn direction(&self) -> f64 {
        if self.reverses_ties { -1.0 } else { 1.0 }
    }
}

fn coord(p: Vec3) -> Coord3D<f64> {
    Coord3D {
        x: p.x,
        y: p.y,
        z: p.z,
    }
}

/// Returns the exact sign of component `k` of a sum of cross products.
///
/// Coordinates are widened `f32`, so that a product of two is exact.
pub(super) fn cross_sign(pairs: &[(Vec3, Vec3)], k: usize) -> f64 {
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    // An expansion of parts that do not overlap, the largest last (Shewchuk 1997, Grow-Expansion).
    let mut parts = [0.0; 8];
    let terms = pairs.iter().flat_map(|(u, v)| [u[i] * v[j], -u[j] * v[i]]);
    for (n, mut sum) in terms.enumerate() {
        for part in &mut parts[..n] {
            (sum, *part) = two_sum(sum, *part);
        }
        parts[n] = sum;
    }
    parts.into_iter().rev().find(|&p| p != 0.0).unwrap_or(0.0)
}

/// Returns the rounded sum and its rounding error (Knuth).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    let a_part = sum - b_part;
    (sum, (a - a_part) + (b - b_part))
}
