//! Adjacency of triangles that need not form a surface.

use crate::ids::{EdgeKey, HalfEdge, VertexId};
use crate::partition::Partition;
use crate::topology::sort_by_edge;

/// The half-edges of triangles, grouped by edge.
pub(super) struct Links {
    keyed: Vec<(EdgeKey, HalfEdge)>,
}

/// Numbers of edges with defects.
pub(super) struct EdgeCounts {
    pub(super) all: usize,
    /// Edges with one triangle.
    pub(super) open: usize,
    /// Edges with more than two triangles.
    pub(super) nonmanifold: usize,
    /// Directed edges of more than one triangle.
    pub(super) conflicts: usize,
}

impl Links {
    /// Returns the adjacency of `triangles`, whose corners must differ.
    pub(super) fn new(triangles: &[[u32; 3]]) -> Self {
        let vertices = triangles.iter().flatten().max();
        let vertices = vertices.map_or(0, |&v| v as usize + 1);
        let key = |h: HalfEdge| EdgeKey::new(origin(triangles, h), origin(triangles, h.next()));
        let half_edges = (0..3 * triangles.len()).map(HalfEdge::from_index);
        Self {
            keyed: sort_by_edge(half_edges.map(|h| (key(h), h)), vertices),
        }
    }

    /// Iterates over the half-edges of every edge, in the order of the edges' keys.
    pub(super) fn edges(&self) -> impl Iterator<Item = &[(EdgeKey, HalfEdge)]> {
        self.keyed.chunk_by(|x, y| x.0 == y.0)
    }

    pub(super) fn edge_counts(&self, triangles: &[[u32; 3]]) -> EdgeCounts {
        let mut counts = EdgeCounts {
            all: 0,
            open: 0,
            nonmanifold: 0,
            conflicts: 0,
        };
        for edge in self.edges() {
            counts.all += 1;
            counts.open += usize::from(edge.len() == 1);
            counts.nonmanifold += usize::from(edge.len() > 2);
            let low = edge[0].0.vertices()[0];
            let up = edge
                .iter()
                .filter(|&&(_, h)| origin(triangles, h) == low)
                .count();
            counts.conflicts += usize::from(up > 1) + usize::from(edge.len() - up > 1);
        }
        counts
    }

    /// Returns the fans of triangles around vertices.
    ///
    /// Corners of a vertex are in one fan if a chain of triangles with common edges at the vertex
    /// connects them.
    pub(super) fn fans(&self, triangles: &[[u32; 3]]) -> Fans {
        let mut fans = Fans::single(3 * triangles.len());
        for edge in self.edges() {
            for &(_, other) in &edge[1..] {
                fans.join_across(triangles, edge[0].1, other);
            }
        }
        fans
    }

    /// Returns the other half-edge of every edge with two, null for all others.
    pub(super) fn twins(&self) -> Vec<HalfEdge> {
        let mut twins = vec![HalfEdge::NULL; self.keyed.len()];
        for edge in self.edges() {
            if let [(_, h), (_, g)] = *edge {
                twins[h.index()] = g;
                twins[g.index()] = h;
            }
        }
        twins
    }

    /// Returns whether no two triangles of an edge of [`Self::edges`] have the same direction.
    pub(super) fn is_consistent(edge: &[(EdgeKey, HalfEdge)], triangles: &[[u32; 3]]) -> bool {
        edge.len() < 2
            || edge.len() == 2 && origin(triangles, edge[0].1) != origin(triangles, edge[1].1)
    }
}

/// The fans of triangles around vertices, as sets of corners.
pub(super) struct Fans {
    corners: Partition,
}

impl Fans {
    /// Returns a fan for each of `count` corners.
    pub(super) fn single(count: usize) -> Self {
        Self {
            corners: Partition::new(count),
        }
    }

    /// Returns the fans of triangles whose edges are oriented and have at most two of them.
    ///
    /// `twins` are those of [`Links::twins`].
    pub(super) fn of_manifold(twins: &[HalfEdge]) -> Self {
        let mut corners = Partition::new(twins.len());
        let mut is_found = vec![false; twins.len()];
        for first in (0..twins.len()).map(HalfEdge::from_index) {
            if is_found[first.index()] {
                continue;
            }
            let mut add = |h: HalfEdge| {
                is_found[h.index()] = true;
                corners.attach(h.0, first.0);
            };
            let mut h = first;
            while !h.is_null() {
                add(h);
                h = twins[h.prev().index()];
                if h == first {
                    break;
                }
            }
            if h.is_null() {
                // The fan ends at a boundary, and its other end may lie behind the first corner.
                let mut twin = twins[first.index()];
                while !twin.is_null() {
                    add(twin.next());
                    twin = twins[twin.next().index()];
                }
            }
        }
        Self { corners }
    }

    /// Merges the fans of two triangles at both ends of their common edge.
    pub(super) fn join_across(&mut self, triangles: &[[u32; 3]], h: HalfEdge, g: HalfEdge) {
        for v in [origin(triangles, h), origin(triangles, h.next())] {
            self.join(corner_at(triangles, h, v), corner_at(triangles, g, v));
        }
    }

    /// Merges the fans of two corners.
    pub(super) fn join(&mut self, a: HalfEdge, b: HalfEdge) {
        self.corners.join(a.0, b.0);
    }

    /// Returns the vertices with more than one fan, ascending.
    pub(super) fn split_vertices(&mut self, triangles: &[[u32; 3]]) -> Vec<VertexId> {
        let mut heads: Vec<u32> = self.heads(triangles).map(|(_, v)| v).collect();
        heads.sort_unstable();
        let mut out: Vec<VertexId> = heads
            .chunk_by(|a, b| a == b)
            .filter(|fans| fans.len() > 1)
            .map(|fans| VertexId(fans[0]))
            .collect();
        out.dedup();
        out
    }

    /// Gives every fan but the first of a vertex its own vertex, numbered from `next`.
    ///
    /// Returns the vertices that the new ones copy.
    pub(super) fn split(&mut self, triangles: &mut [[u32; 3]], next: usize) -> Vec<u32> {
        let mut seen = vec![false; next];
        let mut copies = Vec::new();
        let heads: Vec<(u32, u32)> = self.heads(triangles).collect();
        let mut vertex_of_head = vec![u32::MAX; 3 * triangles.len()];
        for (head, v) in heads {
            vertex_of_head[head as usize] = if std::mem::replace(&mut seen[v as usize], true) {
                copies.push(v);
                VertexId::from_index(next + copies.len() - 1).0
            } else {
                v
            };
        }
        if copies.is_empty() {
            return copies;
        }
        for h in (0..3 * triangles.len()).map(HalfEdge::from_index) {
            let head = self.corners.find(h.0);
            triangles[h.index() / 3][h.index() % 3] = vertex_of_head[head as usize];
        }
        copies
    }

    /// Iterates over the first corner of every fan and its vertex.
    fn heads(&mut self, triangles: &[[u32; 3]]) -> impl Iterator<Item = (u32, u32)> {
        let corners = &mut self.corners;
        (0..)
            .zip(triangles.as_flattened())
            .filter(|&(h, _)| corners.find(h) == h)
            .map(|(h, &v)| (h, v))
    }
}

/// Returns the origin of `h`.
pub(super) fn origin(triangles: &[[u32; 3]], h: HalfEdge) -> VertexId {
    VertexId(triangles[h.index() / 3][h.index() % 3])
}

/// Returns the corner at `v`, an end of `h`, in `h`'s triangle.
fn corner_at(triangles: &[[u32; 3]], h: HalfEdge, v: VertexId) -> HalfEdge {
    if origin(triangles, h) == v {
        h
    } else {
        h.next()
    }
}
