//! Exact predicates for a mesh and the facets of a sweep in general position.
//!
//! Ties are broken by symbolic perturbation (Edelsbrunner and Muecke 1990): the whole sweep moves
//! by (e, e^2, e^3) for an infinitesimal e. A translation is enough: a vertex on the plane of a
//! sweep triangle leaves it, intersecting lines separate, and parallel lines never decide anything.
//! So the mesh meets the sweep in closed curves and in curves that end on the sweep's boundary.
//! That holds for any mesh, also with triangles without area and repeated points.

use super::order::{Plane, compare_along};
use crate::sweep::Sweep;
use incise_mesh::geometry::{area_vector, to_f64};
use incise_mesh::{HalfEdge, Vec3, VertexId, index_u32};
use robust::{Coord3D, orient3d};
use std::cmp::Ordering;

/// No facet.
pub(crate) const NO_FACET: u32 = u32::MAX;

/// A sweep prepared for exact predicates: its triangles, called facets, and their edges.
#[derive(Debug, Clone, Default)]
pub(crate) struct Facets {
    corners: Vec<Vec3>,
    facets: Vec<Facet>,
    edges: Vec<SweepEdge>,
    weld: Weld,
}

/// The tip of an incision that a sweep continues.
///
/// Previous points of the sweep lie exactly on vertices of the tip. There the surface is not cut
/// by predicates but opened by identity.
#[derive(Debug, Clone, Default)]
pub(crate) struct Weld {
    /// By previous point, the vertex of the tip on which it lies, or null. Empty if there is none.
    pub(crate) vertices: Vec<VertexId>,
    /// By pair of neighbors, the half-edge from the first vertex to the second along the tip, or
    /// null.
    pub(crate) half_edges: Vec<HalfEdge>,
}

/// A corner of a facet that is a corner of a mesh triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shared {
    /// None.
    No,
    /// Corner `facet` of the facet and corner `triangle` of the triangle.
    One { facet: usize, triangle: usize },
    /// An edge or more.
    Edge,
}

/// A triangle of the sweep, counterclockwise.
#[derive(Debug, Clone, Copy)]
struct Facet {
    corners: [u32; 3],
    /// Edge k runs from corner k to the next.
    edges: [u32; 3],
    /// As long as twice the area.
    normal: Vec3,
    /// By edge, the unit vector in the facet's plane across the edge, away from the facet.
    outward: [Vec3; 3],
    /// Whether it has an area.
    exists: bool,
    /// Whether a point on the plane counts as above it.
    tie_is_above: bool,
    bounds: [Vec3; 2],
}

/// An edge of the sweep's facets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SweepEdge {
    pub(crate) ends: [u32; 2],
    /// The facet on its left and the one on its right, [`NO_FACET`] at the sweep's boundary.
    pub(crate) facets: [u32; 2],
}

impl SweepEdge {
    /// Returns whether the edge is between two facets; else it is part of the sweep's boundary.
    pub(crate) fn is_crease(&self) -> bool {
        !self.facets.contains(&NO_FACET)
    }
}

/// The kinds of edges of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum EdgeKind {
    /// From a previous point to the same point now.
    Rib,
    /// Across two neighbors.
    Diagonal,
    /// Between two neighbors in the previous frame.
    Previous,
    /// Between two neighbors in the current frame.
    Current,
}

/// For each edge of a facet, whether a point on its plane is on the inner side.
pub(crate) type Inside = [bool; 3];

impl Facets {
    /// Prepares a sweep that continues the tip of `weld`.
    ///
    /// Between previous points i and i + 1 and the current ones, facet 2 i lies at the previous
    /// edge and facet 2 i + 1 at the current edge.
    pub(crate) fn read(&mut self, sweep: &Sweep, weld: &Weld) {
        self.weld.clone_from(weld);
        let n = index_u32(sweep.previous().len());
        self.corners.clear();
        self.corners
            .extend(sweep.points().iter().map(|&p| to_f64(p)));
        self.edges.clear();
        self.facets.clear();
        let edge = |a, b| SweepEdge {
            ends: [a, b],
            facets: [NO_FACET; 2],
        };
        // n ribs, then a diagonal, a previous and a current edge for each quadrilateral.
        self.edges.extend((0..n).map(|i| edge(i, n + i)));
        for i in 0..n - 1 {
            let (j, k, l) = (i + 1, n + i, n + i + 1);
            let first = index_u32(self.edges.len());
            self.edges.extend([edge(i, l), edge(i, j), edge(k, l)]);
            let [diagonal, previous, current] = [0, 1, 2].map(|e| first + e);
            self.add_facet([i, j, l], [previous, j, diagonal]);
            self.add_facet([i, l, k], [diagonal, current, i]);
        }
    }

    fn add_facet(&mut self, corners: [u32; 3], edges: [u32; 3]) {
        let points = corners.map(|c| self.corners[c as usize]);
        let [a, b, c] = points;
        let signs = [0, 1, 2].map(|k| cross_sign(&[(a, b), (b, c), (c, a)], k));
        let first = signs.into_iter().find(|&sign| sign != 0.0);
        let normal = area_vector(points);
        let outward = [(a, b), (b, c), (c, a)].map(|(p, q)| {
            let across = (q - p).cross(&normal);
            across.try_normalize(0.0).unwrap_or_default()
        });
        let facet = index_u32(self.facets.len());
        if first.is_some() {
            for (k, &e) in edges.iter().enumerate() {
                let edge = &mut self.edges[e as usize];
                edge.facets[usize::from(edge.ends[0] != corners[k])] = facet;
            }
        }
        self.facets.push(Facet {
            corners,
            edges,
            normal,
            outward,
            exists: first.is_some(),
            // The plane moves along the normal, so its points end up below it.
            tie_is_above: first.is_some_and(|sign| sign < 0.0),
            bounds: [a.inf(&b).inf(&c), a.sup(&b).sup(&c)],
        });
    }

    /// Returns the tip that the sweep continues.
    pub(crate) fn weld(&self) -> &Weld {
        &self.weld
    }

    /// Returns the vertex of the tip at a corner; null if there is none.
    pub(crate) fn vertex_at(&self, corner: u32) -> VertexId {
        let vertex = self.weld.vertices.get(corner as usize);
        vertex.copied().unwrap_or(VertexId::NULL)
    }

    /// Returns the corners that a facet and a mesh triangle share.
    pub(crate) fn shared(&self, i: u32, triangle: [VertexId; 3]) -> Shared {
        let mut shared = Shared::No;
        if self.weld.vertices.is_empty() {
            return shared;
        }
        for (k, corner) in self.facets[i as usize].corners.into_iter().enumerate() {
            let vertex = self.vertex_at(corner);
            let found = triangle
                .iter()
                .position(|&v| v == vertex && !vertex.is_null());
            shared = match (found, shared) {
                (None, shared) => shared,
                (Some(j), Shared::No) => Shared::One {
                    facet: k,
                    triangle: j,
                },
                (Some(_), _) => return Shared::Edge,
            };
        }
        shared
    }

    /// Returns the number of facets, including those without area.
    pub(crate) fn len(&self) -> u32 {
        index_u32(self.facets.len())
    }

    /// Returns whether facet `i` has an area.
    pub(crate) fn exists(&self, i: u32) -> bool {
        self.facets[i as usize].exists
    }

    /// Returns the edges of all facets.
    pub(crate) fn edges(&self) -> &[SweepEdge] {
        &self.edges
    }

    /// Returns the diagonal between the first two facets.
    pub(crate) fn crease(&self) -> u32 {
        index_u32(self.corners.len() / 2)
    }

    /// Returns whether the first two facets meet at their diagonal.
    pub(crate) fn has_crease(&self) -> bool {
        self.edges[self.crease() as usize].is_crease()
    }

    /// Returns whether the second facet rises above the first one's plane.
    pub(crate) fn is_valley(&self) -> bool {
        let [a, b, c] = self.corners_of(0).map(coord);
        orient3d(a, b, c, coord(self.corners_of(1)[2])) <= 0.0
    }

    /// Returns the kind of an edge.
    pub(crate) fn kind(&self, edge: u32) -> EdgeKind {
        let ribs = index_u32(self.corners.len() / 2);
        match edge.checked_sub(ribs).map(|i| i % 3) {
            None => EdgeKind::Rib,
            Some(0) => EdgeKind::Diagonal,
            Some(1) => EdgeKind::Previous,
            Some(_) => EdgeKind::Current,
        }
    }

    /// Returns the pair of neighbors on the polyline at which a diagonal, previous or current edge
    /// lies; for others none.
    pub(crate) fn pair_of(&self, edge: u32) -> Option<u32> {
        let ribs = index_u32(self.corners.len() / 2);
        edge.checked_sub(ribs).map(|i| i / 3)
    }

    /// Returns whether parts of an edge inside the body become chains.
    ///
    /// Not where the sweep continues a tip, nor on edges of triangles without area alone.
    pub(crate) fn may_have_chain(&self, edge: u32) -> bool {
        let is_tip = || {
            let pair = self.pair_of(edge).map(|pair| pair as usize);
            let along = pair.and_then(|pair| self.weld.half_edges.get(pair));
            self.kind(edge) == EdgeKind::Previous && along.is_some_and(|h| !h.is_null())
        };
        self.edges[edge as usize].facets != [NO_FACET; 2] && !is_tip()
    }

    /// Returns the edges of facet `i`, counterclockwise.
    pub(crate) fn edges_of(&self, i: u32) -> [u32; 3] {
        self.facets[i as usize].edges
    }

    /// Returns the corners of facet `i` \[m\].
    pub(crate) fn corners_of(&self, i: u32) -> [Vec3; 3] {
        (self.facets[i as usize].corners).map(|c| self.corners[c as usize])
    }

    /// Returns a corner \[m\].
    pub(crate) fn corner(&self, i: u32) -> Vec3 {
        self.corners[i as usize]
    }

    /// Returns the number of corners.
    pub(crate) fn corner_count(&self) -> usize {
        self.corners.len()
    }

    /// Returns the ends of a sweep edge \[m\].
    pub(crate) fn ends(&self, edge: u32) -> [Vec3; 2] {
        (self.edges[edge as usize].ends).map(|c| self.corners[c as usize])
    }

    /// Returns the facet beyond an edge of facet `i`, [`NO_FACET`] at the sweep's boundary.
    pub(crate) fn beyond_edge(&self, i: u32, edge: u32) -> u32 {
        let [left, right] = self.edges[edge as usize].facets;
        if left == i { right } else { left }
    }

    /// Returns the normal of facet `i`, as long as twice its area.
    pub(crate) fn normal(&self, i: u32) -> Vec3 {
        self.facets[i as usize].normal
    }

    /// Returns whether the box around a triangle meets that of facet `i`.
    pub(crate) fn may_touch(&self, i: u32, [a, b, c]: &[Vec3; 3]) -> bool {
        let [low, high] = self.facets[i as usize].bounds;
        (0..3).all(|k| a[k].min(b[k]).min(c[k]) <= high[k] && a[k].max(b[k]).max(c[k]) >= low[k])
    }

    /// Returns the height of `p` above the plane of facet `i`, scaled and rounded.
    pub(crate) fn height(&self, i: u32, p: Vec3) -> f64 {
        let facet = &self.facets[i as usize];
        facet
            .normal
            .dot(&(p - self.corners[facet.corners[0] as usize]))
    }

    /// Returns the distance of `p` from edge `k` of facet `i`, positive outside, rounded \[m\].
    pub(crate) fn outside(&self, i: u32, k: usize, p: Vec3) -> f64 {
        let facet = &self.facets[i as usize];
        facet.outward[k].dot(&(p - self.corners[facet.corners[k] as usize]))
    }

    /// Returns the side of facet `i` on whose outer side `p` lies farthest, and its distance \[m\].
    ///
    /// Only sides with another facet count.
    pub(crate) fn beyond(&self, i: u32, p: Vec3) -> Option<(usize, f64)> {
        let is_crease =
            |&k: &usize| self.edges[self.facets[i as usize].edges[k] as usize].is_crease();
        let sides = (0..3).filter(is_crease);
        let outside = sides.map(|k| (k, self.outside(i, k, p)));
        outside
            .filter(|s| s.1 > 0.0)
            .max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Returns the distance of `p` from facet `i` \[m\]: from its plane or its creases.
    pub(crate) fn miss(&self, i: u32, p: Vec3) -> f64 {
        let height = self.height(i, p) / self.facets[i as usize].normal.norm();
        height
            .abs()
            .max(self.beyond(i, p).map_or(0.0, |beyond| beyond.1))
    }

    /// Returns the distance of `p` from the line of a sweep edge \[m\].
    pub(crate) fn off_edge(&self, edge: u32, p: Vec3) -> f64 {
        let [start, end] = self.ends(edge);
        let along = end - start;
        along.cross(&(p - start)).norm() / along.norm()
    }

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
            sign < 0.0 || (sign == 0.0 && tie > 0.0)
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
        compare_along([p, q], [&planes[0], &planes[1]], 1.0).then_with(|| {
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
        compare_along(self.ends(edge), [&Plane(a), &Plane(b)], -1.0)
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
            let [flush, moved] = [flush, moved].map(|sweep| {
                let mut facets = Facets::default();
                facets.read(&sweep, &Weld::default());
                facets
            });
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
                for edge in flush.edges_of(i) {
                    prop_assert_eq!(flush.pierces(edge, face), moved.pierces(edge, face));
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
