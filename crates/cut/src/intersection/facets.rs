//! Exact predicates for a mesh and the facets of a sweep in general position.
//!
//! Ties are broken by symbolic perturbation (Edelsbrunner and Muecke 1990): the whole sweep moves
//! by (e, e^2, e^3) for an infinitesimal e. A translation is enough: a vertex on the plane of a
//! sweep triangle leaves it, intersecting lines separate, and parallel lines never decide anything.
//! So the mesh meets the sweep in closed curves and in curves that end on the sweep's boundary.
//! That holds for any mesh, also with triangles without area and repeated points.

mod edges;
mod predicates;
#[cfg(test)]
mod tests;

use crate::intersection::continued_tip::ContinuedTip;
use crate::sweep::Sweep;
use incise_mesh::geometry::{area_vector, to_f64};
use incise_mesh::{Vec3, VertexId, index_u32};
use predicates::cross_sign;

pub(crate) use edges::{EdgeKind, SweepEdge};

/// No facet.
pub(crate) const NO_FACET: u32 = u32::MAX;

/// No corner.
const NO_CORNER: u32 = u32::MAX;

/// A sweep prepared for exact predicates: its triangles, called facets, and their edges.
#[derive(Debug, Clone, Default)]
pub(crate) struct Facets {
    corners: Vec<Vec3>,
    facets: Vec<Facet>,
    edges: Vec<SweepEdge>,
    tip: ContinuedTip,
    /// By corner, the vertices of the tip on which it lies, or null: of up to two parts.
    vertices: Vec<[VertexId; 2]>,
    /// Whether ties are broken by the opposite translation of the sweep, from the next read on.
    pub(crate) reverses_ties: bool,
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

impl Facets {
    /// Prepares a sweep that continues `tip`.
    ///
    /// Between points i and j = i + 1, facet 2 i lies at the previous edge and facet 2 i + 1 at the
    /// current edge. Where one of the points stands still, facet 2 i lies at both, and the other
    /// does not exist. Where the previous or the current points coincide, the facet at their edge
    /// does not exist.
    pub(crate) fn read(&mut self, sweep: &Sweep, tip: &ContinuedTip) {
        let n = index_u32(sweep.previous().len());
        self.corners.clear();
        self.corners
            .extend(sweep.points().iter().map(|&p| to_f64(p)));
        self.edges.clear();
        self.facets.clear();
        let edge = |a, b| SweepEdge {
            ends: [a, b],
            facets: [NO_FACET; 2],
            is_tip: false,
        };
        let merged = self.merged_corners(n, !tip.parts.is_empty());
        let row = |i: u32| [merged[i as usize], merged[(n + i) as usize]];
        // n ribs, then a diagonal, a previous and a current edge for each quadrilateral.
        self.edges.extend((0..n).map(row).map(|[p, c]| edge(p, c)));
        for (i, j) in (1..n).map(|j| (j - 1, j)) {
            let ([a, d], [b, c]) = (row(i), row(j));
            let first = index_u32(self.edges.len());
            self.edges.extend([edge(a, c), edge(a, b), edge(d, c)]);
            let [diagonal, previous, current] = [0, 1, 2].map(|e| first + e);
            let none = ([a; 3], [diagonal; 3]);
            let both = if a == b {
                [none, ([a, c, d], [j, current, i])]
            } else if c == d {
                [([a, b, c], [previous, j, i]), none]
            } else if b == c {
                [([a, b, d], [previous, current, i]), none]
            } else if a == d {
                [([a, b, c], [previous, j, current]), none]
            } else {
                let at_current = ([a, c, d], [diagonal, current, i]);
                [([a, b, c], [previous, j, diagonal]), at_current]
            };
            for (corners, edges) in both {
                self.add_facet(corners, edges);
            }
        }
        self.read_tip(tip, &merged);
    }

    /// Returns the corner of each of `n` previous points, then of each current point.
    ///
    /// A point that stands still is one corner. So are neighbors at one vertex, if there is a tip.
    fn merged_corners(&self, n: u32, has_tip: bool) -> Vec<u32> {
        let mut merged: Vec<u32> = (0..2 * n).collect();
        for i in 0..2 * n {
            let at = |corner: u32| self.corners[corner as usize];
            let neighbor = i.checked_sub(1).filter(|_| has_tip && i % n > 0);
            let before = i.checked_sub(n);
            let mut known = before.into_iter().chain(neighbor);
            if let Some(known) = known.find(|&known| at(known) == at(i)) {
                merged[i as usize] = merged[known as usize];
            }
        }
        merged
    }

    /// Takes the tip over to the merged corners.
    fn read_tip(&mut self, tip: &ContinuedTip, merged: &[u32]) {
        self.tip.clone_from(tip);
        self.vertices.clear();
        let count = if tip.parts.is_empty() {
            0
        } else {
            merged.len()
        };
        self.vertices.resize(count, [VertexId::NULL; 2]);
        let mut next = vec![NO_CORNER; count];
        for part in &mut self.tip.parts {
            for corner in &mut part.corners {
                *corner = merged[*corner as usize];
            }
            for (&corner, &vertex) in part.corners.iter().zip(&part.vertices) {
                let own = &mut self.vertices[corner as usize];
                own[usize::from(!own[0].is_null())] = vertex;
            }
            for [from, to] in part.edges() {
                next[from as usize] = to;
            }
        }
        if count > 0 {
            for edge in &mut self.edges {
                let [a, b] = edge.ends;
                edge.is_tip = next[a as usize] == b || next[b as usize] == a;
            }
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
            tie_is_above: first.is_some_and(|sign| (sign < 0.0) != self.reverses_ties),
            bounds: [a.inf(&b).inf(&c), a.sup(&b).sup(&c)],
        });
    }

    /// Returns the tip that the sweep continues.
    pub(crate) fn tip(&self) -> &ContinuedTip {
        &self.tip
    }

    /// Returns the corners that a facet and a mesh triangle share.
    pub(crate) fn shared(&self, i: u32, triangle: [VertexId; 3]) -> Shared {
        let mut shared = Shared::No;
        if self.vertices.is_empty() {
            return shared;
        }
        for (k, corner) in self.facets[i as usize].corners.into_iter().enumerate() {
            let own = self.vertices[corner as usize];
            let found = triangle
                .iter()
                .position(|v| own.contains(v) && !v.is_null());
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

    /// Returns a current point in the present shape \[m\], if the sweep is in the rest shape.
    pub(crate) fn present(&self, corner: u32) -> Option<Vec3> {
        let current = (corner as usize).checked_sub(self.corners.len() / 2)?;
        self.tip.present.get(current).copied()
    }

    /// Returns the number of corners.
    pub(crate) fn corner_count(&self) -> usize {
        self.corners.len()
    }

    /// Returns the ends of a sweep edge \[m\].
    pub(crate) fn ends(&self, edge: u32) -> [Vec3; 2] {
        (self.edges[edge as usize].ends).map(|c| self.corners[c as usize])
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
}
