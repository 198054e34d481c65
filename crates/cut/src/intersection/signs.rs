//! Exact predicates for a mesh and a sweep in general position.
//!
//! Ties are broken by symbolic perturbation (Edelsbrunner and Muecke 1990): the whole sweep moves
//! by (e, e^2, e^3) for an infinitesimal e. A translation is enough: a vertex on the plane of a
//! sweep triangle leaves it, intersecting lines separate, and parallel lines never decide anything.
//! So the mesh meets the sweep in closed curves and in curves that end on the sweep's boundary.
//! That holds for any mesh, also with triangles without area and repeated points.

use crate::sweep::Sweep;
use incise_mesh::Vec3;
use incise_mesh::geometry::area_vector;
use robust::{Coord3D, orient3d};

/// Corners of the sweep's two triangles. They share the crease from corner 0 to corner 2.
pub(crate) const TRIANGLES: [[usize; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

/// The edges of each triangle, the crease first.
const EDGES: [[[usize; 2]; 3]; 2] = [[[2, 0], [0, 1], [1, 2]], [[0, 2], [2, 3], [3, 0]]];

/// A sweep prepared for exact predicates.
#[derive(Debug)]
pub(crate) struct Signs {
    corners: [Vec3; 4],
    normals: [Vec3; 2],
    /// By triangle, unit vectors in its plane across the crease, from the first to the second.
    across: [Vec3; 2],
    /// Whether each of the two triangles has an area.
    exists: [bool; 2],
    /// Whether a point on a triangle's plane counts as above it.
    tie_is_above: [bool; 2],
    /// Whether the second triangle rises above the first one's plane.
    pub(crate) is_valley: bool,
}

/// For each of [`EDGES`], whether a point on a sweep triangle's plane is on the inner side.
pub(crate) type Inside = [bool; 3];

impl Signs {
    pub(crate) fn new(sweep: &Sweep) -> Self {
        let corners = sweep.corners().map(incise_mesh::geometry::to_f64);
        let normal = TRIANGLES.map(|t| {
            let [a, b, c] = t.map(|i| corners[i]);
            [0, 1, 2].map(|k| cross_sign(&[(a, b), (b, c), (c, a)], k))
        });
        let first = normal.map(|n| n.into_iter().find(|&sign| sign != 0.0));
        let [s0, s1, s2, s3] = corners.map(coord);
        let normals = TRIANGLES.map(|t| area_vector(t.map(|i| corners[i])));
        Self {
            corners,
            normals,
            across: normals.map(|n| n.cross(&(corners[2] - corners[0])).normalize()),
            exists: first.map(|sign| sign.is_some()),
            // The plane moves along the normal, so its points end up below it.
            tie_is_above: first.map(|sign| sign.is_some_and(|sign| sign < 0.0)),
            is_valley: orient3d(s0, s1, s2, s3) <= 0.0,
        }
    }

    /// Returns whether sweep triangle `i` has an area.
    pub(crate) fn exists(&self, i: usize) -> bool {
        self.exists[i]
    }

    /// Returns whether the crease separates two triangles; else it is part of the sweep's boundary.
    pub(crate) fn has_crease(&self) -> bool {
        self.exists == [true; 2]
    }

    /// Returns the ends of the crease \[m\].
    pub(crate) fn crease(&self) -> [Vec3; 2] {
        [self.corners[0], self.corners[2]]
    }

    /// Returns the normal of sweep triangle `i`, as long as twice its area.
    pub(crate) fn normal(&self, i: usize) -> Vec3 {
        self.normals[i]
    }

    /// Returns the height of `p` above the plane of sweep triangle `i`, scaled and rounded.
    pub(crate) fn height(&self, i: usize, p: Vec3) -> f64 {
        self.normals[i].dot(&(p - self.corners[0]))
    }

    /// Returns the distance of `p` across the crease along sweep triangle `i`, rounded \[m\].
    pub(crate) fn across(&self, i: usize, p: Vec3) -> f64 {
        self.across[i].dot(&(p - self.corners[0]))
    }

    /// Returns the distance of `p` from sweep triangle `i` \[m\]: from its plane or its crease.
    pub(crate) fn miss(&self, i: usize, p: Vec3) -> f64 {
        let height = self.height(i, p) / self.normals[i].norm();
        height.abs().max(self.beyond(i, p))
    }

    /// Returns the distance of `p` beyond the crease of sweep triangle `i`; 0 on its side \[m\].
    pub(crate) fn beyond(&self, i: usize, p: Vec3) -> f64 {
        if !self.has_crease() {
            return 0.0;
        }
        let across = self.across(i, p);
        if i == 0 { across } else { -across }.max(0.0)
    }

    /// Returns the distance of `p` from the line of the crease \[m\].
    pub(crate) fn off_crease(&self, p: Vec3) -> f64 {
        let [start, end] = self.crease();
        let along = end - start;
        along.cross(&(p - start)).norm() / along.norm()
    }

    /// Returns whether `p` is above the plane of sweep triangle `i`.
    pub(crate) fn is_above(&self, i: usize, p: Vec3) -> bool {
        let [a, b, c] = TRIANGLES[i].map(|k| coord(self.corners[k]));
        // `orient3d` is negative for a point on the side to which the normal points.
        let sign = orient3d(a, b, c, coord(p));
        sign < 0.0 || (sign == 0.0 && self.tie_is_above[i])
    }

    /// Tests on which side of each sweep edge the edge from `p` to `q` crosses the plane of sweep
    /// triangle `i`. `p` and `q` are on different sides of it; `q` is above if `rises`.
    pub(crate) fn inside(&self, i: usize, p: Vec3, q: Vec3, rises: bool) -> Inside {
        EDGES[i].map(|[a, b]| {
            let sign = self.around(p, q, a, b);
            if rises { sign < 0.0 } else { sign > 0.0 }
        })
    }

    /// Returns whether edge `side` of sweep triangle `i` pierces the mesh triangle.
    pub(crate) fn pierces(&self, i: usize, side: usize, [p, q, r]: [Vec3; 3]) -> bool {
        let [a, b] = EDGES[i][side];
        let normal = [0, 1, 2].map(|k| cross_sign(&[(p, q), (q, r), (r, p)], k));
        let Some(tie) = normal.into_iter().find(|&sign| sign != 0.0) else {
            return false;
        };
        let is_above = |corner: usize| {
            let [p, q, r] = [p, q, r].map(coord);
            let sign = orient3d(p, q, r, coord(self.corners[corner]));
            sign < 0.0 || (sign == 0.0 && tie > 0.0)
        };
        if is_above(a) == is_above(b) {
            return false;
        }
        let signs = [(p, q), (q, r), (r, p)].map(|(x, y)| self.around(x, y, a, b));
        signs.iter().all(|&s| s > 0.0) || signs.iter().all(|&s| s < 0.0)
    }

    /// Returns the sign of the line from `p` to `q` relative to the sweep's line from corner `a` to
    /// corner `b`; 0 only for parallel lines.
    fn around(&self, p: Vec3, q: Vec3, a: usize, b: usize) -> f64 {
        let (a, b) = (self.corners[a], self.corners[b]);
        let sign = orient3d(coord(p), coord(q), coord(a), coord(b));
        if sign != 0.0 {
            return sign;
        }
        // Moving a and b by d changes it by d . ((p - q) x (a - b)).
        let components = [0, 1, 2].map(|k| cross_sign(&[(p, a), (q, b), (b, p), (a, q)], k));
        components.into_iter().find(|&s| s != 0.0).unwrap_or(0.0)
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
fn cross_sign(pairs: &[(Vec3, Vec3)], k: usize) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn lattice() -> impl Strategy<Value = [i8; 3]> {
        prop::array::uniform3(-2i8..=2)
    }

    fn vector(p: [i8; 3]) -> Vec3 {
        Vec3::from(p.map(f64::from))
    }

    proptest! {
        /// Signs of a degenerate sweep equal the plain signs of a sweep that is displaced a little.
        #[test]
        fn ties_are_those_of_a_moved_sweep(
            corners in prop::array::uniform4(lattice()),
            face in prop::array::uniform3(lattice()),
        ) {
            let sweep = |d: [f64; 3]| {
                let at = |p: [i8; 3]| incise_mesh::geometry::to_f32(vector(p) + Vec3::from(d));
                let [a, b, c, e] = corners.map(at);
                Sweep::new([a, b], [e, c])
            };
            // Powers of two, so that the moved corners are exact; far apart, as the symbolic ones
            // are.
            let moved = sweep([1.0 / 64.0, 1.0 / 8192.0, 1.0 / 1_048_576.0]);
            let (Ok(flush), Ok(moved)) = (sweep([0.0; 3]), moved) else { return Ok(()) };
            let [flush, moved] = [flush, moved].map(|s| Signs::new(&s));
            let face = face.map(vector);
            for i in [0, 1].into_iter().filter(|&i| flush.exists(i)) {
                let above = face.map(|p| flush.is_above(i, p));
                prop_assert_eq!(above, face.map(|p| moved.is_above(i, p)));
                for k in 0..3 {
                    let (p, q) = (face[k], face[(k + 1) % 3]);
                    if above[k] != above[(k + 1) % 3] {
                        let rises = above[(k + 1) % 3];
                        prop_assert_eq!(
                            flush.inside(i, p, q, rises),
                            moved.inside(i, p, q, rises)
                        );
                    }
                }
                for side in 0..3 {
                    prop_assert_eq!(flush.pierces(i, side, face), moved.pierces(i, side, face));
                }
            }
        }
    }

    #[test]
    fn sums_of_products_keep_their_sign_where_rounding_loses_it() {
        // (2^60 + 1) and -(2^60), as products of f32 numbers.
        let big = 2.0_f64.powi(30);
        let u = Vec3::new(0.0, big, 0.0);
        let v = Vec3::new(0.0, 0.0, big);
        let one = (Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0));
        assert_eq!(cross_sign(&[(u, v), one, (v, u)], 0), 1.0);
        assert_eq!(cross_sign(&[(u, v), (v, u)], 0), 0.0);
    }
}
