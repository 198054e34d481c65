//! Counts of the elements of triangles.

use super::links::{EdgeCounts, Links};
use crate::partition::Partition;

/// Counts of the surface that [`MeshData::repair`](crate::MeshData::repair) returns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct RepairedCounts {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Number of edges.
    pub edges: usize,
    /// Number of parts that share no vertex.
    pub components: usize,
    /// Total genus, if the surface is closed.
    pub genus: Option<i64>,
}

impl RepairedCounts {
    /// Counts the elements of an oriented manifold.
    pub(super) fn new(triangles: &[[u32; 3]]) -> Self {
        let counts = Counts::new(triangles, &Links::new(triangles));
        Self {
            vertices: counts.vertices,
            triangles: triangles.len(),
            edges: counts.edges.all,
            components: counts.components,
            genus: (counts.edges.open == 0).then(|| counts.genus()),
        }
    }
}

/// Counts of the elements of any triangles.
pub(super) struct Counts {
    vertices: usize,
    pub(super) edges: EdgeCounts,
    pub(super) components: usize,
    pub(super) euler_characteristic: i64,
}

impl Counts {
    /// Counts the elements of triangles with that adjacency.
    pub(super) fn new(triangles: &[[u32; 3]], links: &Links) -> Self {
        let ids = triangles.iter().flatten().max();
        let ids = ids.map_or(0, |&v| v as usize + 1);
        let mut partition = Partition::new(ids);
        let mut is_used = vec![false; ids];
        for t in triangles {
            partition.join(t[0], t[1]);
            partition.join(t[0], t[2]);
            t.iter().for_each(|&v| is_used[v as usize] = true);
        }
        let used = (0..).zip(&is_used).filter(|&(_, &used)| used);
        let vertices = used.clone().count();
        let edges = links.edge_counts(triangles);
        Self {
            components: used.filter(|&(v, _)| partition.find(v) == v).count(),
            euler_characteristic: signed(vertices) - signed(edges.all) + signed(triangles.len()),
            vertices,
            edges,
        }
    }

    /// Returns the total genus of a closed, oriented manifold.
    pub(super) fn genus(&self) -> i64 {
        signed(self.components) - self.euler_characteristic / 2
    }
}

fn signed(count: usize) -> i64 {
    i64::try_from(count).expect("elements have 32-bit ids")
}
