//! Patches of triangles at edges of more than two triangles, and the loose ones among them.

use super::NonManifoldEdge;
use crate::check::around::{IncidentTriangle, inner_of_three, sort_around};
use crate::check::links::{Links, origin};
use crate::check::repair::Repaired;
use crate::geometry::to_f64;
use crate::ids::{EdgeKey, HalfEdge, VertexId};
use crate::io::MeshData;
use crate::partition::Partition;

/// Maximum number of rounds that detach walls within walls.
const ROUNDS: usize = 32;

/// The edges of more than two triangles, and the patches between them.
///
/// A patch has the number of its first triangle.
pub(super) struct Patches {
    pub(super) non_manifold_edges: Vec<NonManifoldEdge>,
    /// Whether a patch is loose, by its number.
    pub(super) is_loose: Vec<bool>,
    /// A patch, one of its edges, and whether material starts there; sorted.
    sides: Vec<(u32, u32, bool)>,
    /// Patches that became loose and were not yet followed.
    pending: Vec<u32>,
}

impl Patches {
    /// Finds the patches of repaired triangles.
    pub(super) fn new(repaired: &Repaired, data: &MeshData, links: &Links) -> Self {
        let triangles = &repaired.triangles;
        let mut partition = Partition::new(triangles.len());
        for edge in links.edges() {
            if let [(_, h), (_, g)] = *edge {
                partition.join(h.triangle().0, g.triangle().0);
            }
        }
        let position = |v: VertexId| {
            let v = repaired.vertices[v.index()];
            let p = to_f64(data.positions[v as usize]);
            [p.x, p.y, p.z]
        };
        let mut out = Self {
            non_manifold_edges: Vec::new(),
            is_loose: vec![false; triangles.len()],
            sides: Vec::new(),
            pending: Vec::new(),
        };
        for edge in links.edges() {
            let (key, first) = edge[0];
            if edge.len() == 1 {
                out.detach(partition.find(first.triangle().0));
            } else if edge.len() > 2 {
                let [low, high] = key.vertices();
                let spoke = |&(_, half_edge): &(EdgeKey, HalfEdge)| IncidentTriangle {
                    half_edge,
                    patch: partition.find(half_edge.triangle().0),
                    starts: origin(triangles, half_edge) == high,
                    angle: 0,
                };
                let mut spokes: Vec<IncidentTriangle> = edge.iter().map(spoke).collect();
                let starting = spokes.iter().filter(|s| s.starts).count();
                let apex = |s: &IncidentTriangle| position(origin(triangles, s.half_edge.prev()));
                let is_sorted = sort_around([low, high].map(position), &mut spokes, apex);
                out.non_manifold_edges.push(NonManifoldEdge {
                    key,
                    closed: [spokes.len() - starting, starting],
                    spokes,
                    is_sorted,
                    is_inverted: false,
                });
            }
        }
        for (i, crowd) in (0..).zip(&out.non_manifold_edges) {
            let side = |s: &IncidentTriangle| (s.patch, i, s.starts);
            out.sides.extend(crowd.spokes.iter().map(side));
        }
        out.sides.sort_unstable();
        out
    }

    /// Makes a patch loose.
    fn detach(&mut self, patch: u32) {
        if !std::mem::replace(&mut self.is_loose[patch as usize], true) {
            self.pending.push(patch);
        }
    }

    /// Makes patches loose that have no partner left at one of their edges.
    pub(super) fn detach_loose(&mut self) {
        for i in 0..self.non_manifold_edges.len() {
            self.detach_without_partner(i);
        }
        while let Some(patch) = self.pending.pop() {
            let first = self.sides.partition_point(|&(p, ..)| p < patch);
            let last = self.sides.partition_point(|&(p, ..)| p <= patch);
            for k in first..last {
                let (_, crowd, starts) = self.sides[k];
                self.non_manifold_edges[crowd as usize].closed[usize::from(starts)] -= 1;
                self.detach_without_partner(crowd as usize);
            }
        }
    }

    /// Makes the patches of an edge loose if all of them face the same way around it.
    fn detach_without_partner(&mut self, crowd: usize) {
        let [ending, starting] = self.non_manifold_edges[crowd].closed;
        if (ending == 0) != (starting == 0) {
            let spokes = self.non_manifold_edges[crowd].spokes.iter();
            let patches: Vec<u32> = spokes.map(|s| s.patch).collect();
            patches.into_iter().for_each(|patch| self.detach(patch));
        }
    }

    /// Makes walls within a closed surface loose.
    ///
    /// Such a wall is the inner one of three triangles at each of its edges.
    pub(super) fn detach_inner_walls(&mut self) {
        for _ in 0..ROUNDS {
            let mut inner: Vec<u32> = Vec::new();
            let mut other: Vec<u32> = Vec::new();
            for crowd in &self.non_manifold_edges {
                let is_closed = |s: &&IncidentTriangle| !self.is_loose[s.patch as usize];
                let closed: Vec<IncidentTriangle> =
                    crowd.spokes.iter().filter(is_closed).copied().collect();
                let wall = match <&[IncidentTriangle; 3]>::try_from(closed.as_slice()) {
                    Ok(three) if crowd.is_sorted => inner_of_three(three),
                    _ => None,
                };
                inner.extend(wall.map(|s| s.patch));
                let others = closed.iter().filter(|&s| Some(s) != wall);
                other.extend(others.map(|s| s.patch));
            }
            other.sort_unstable();
            inner.sort_unstable();
            inner.dedup();
            inner.retain(|patch| other.binary_search(patch).is_err());
            if inner.is_empty() {
                return;
            }
            inner.into_iter().for_each(|patch| self.detach(patch));
            self.detach_loose();
        }
    }

    /// Pairs the triangles of these half-edges' edges across the void.
    ///
    /// Returns the edges where that was already tried.
    pub(super) fn invert(&mut self, mut half_edges: Vec<HalfEdge>) -> Vec<EdgeKey> {
        half_edges.sort_unstable();
        let mut stuck = Vec::new();
        for crowd in &mut self.non_manifold_edges {
            let is_bad = |s: &IncidentTriangle| half_edges.binary_search(&s.half_edge).is_ok();
            if crowd.spokes.iter().any(is_bad) && std::mem::replace(&mut crowd.is_inverted, true) {
                stuck.push(crowd.key);
            }
        }
        stuck
    }
}
