//! Choices of the file's vertices that stay separate although their positions are equal.
//!
//! Readers weld equal positions. Bodies that touch, and the two walls of an incision, must not be
//! welded; only the parts of the file and its own indices tell them apart.

use super::links::Links;
use super::repair::is_collapsed;
use crate::ids::{VertexId, index_u32};
use crate::io::{MeshData, Warning};
use crate::partition::Partition;

/// Stands for the file's vertex where equal positions are one vertex.
const ANY: u32 = u32::MAX;

/// Triangles of mesh data over vertices of one choice.
pub(super) struct Weld {
    /// Vertex of the data for each vertex.
    pub(super) vertices: Vec<u32>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The difference from the data, if there is one.
    pub(super) warning: Option<Warning>,
}

impl Weld {
    /// Makes equal positions one vertex, as in the data.
    pub(super) fn everything(data: &MeshData) -> Self {
        Self {
            vertices: (0..).take(data.positions.len()).collect(),
            triangles: data.triangles.clone(),
            warning: None,
        }
    }

    /// Welds equal positions only within parts of the file.
    ///
    /// Returns nothing if the file has one part.
    pub(super) fn within_parts(data: &MeshData) -> Option<Self> {
        (!data.parts.is_empty()).then(|| Self::within(data, &data.parts))
    }

    /// Welds equal positions only within components of the file's indices.
    ///
    /// Returns nothing if the file has no two vertices at one position.
    pub(super) fn within_components(data: &MeshData) -> Option<Self> {
        Some(Self::within(data, &components(data)?))
    }

    /// Welds equal positions only within bodies, of which every triangle has one.
    fn within(data: &MeshData, bodies: &[u32]) -> Self {
        let corner = |t: usize, k: usize| (bodies[t], data.triangles[t][k]);
        let mut distinct = bodies.to_vec();
        distinct.sort_unstable();
        distinct.dedup();
        let count = distinct.len();
        Self::by_key(data, corner, Some(Warning::BodiesKeptApart { count }))
    }

    /// Keeps the file's indices of components that they close; welds all others.
    ///
    /// Returns nothing if that separates no vertices.
    pub(super) fn except_closed_components(data: &MeshData) -> Option<Self> {
        let components = components(data)?;
        let is_closed = closed_components(data, &components);
        let corner = |t: usize, k: usize| {
            let own = if is_closed[components[t] as usize] {
                data.file_triangles[t][k]
            } else {
                ANY
            };
            (own, data.triangles[t][k])
        };
        let mut out = Self::by_key(data, corner, None);
        let mut positions = out.vertices.clone();
        positions.sort_unstable();
        let separate = positions.chunk_by(|a, b| a == b).filter(|c| c.len() > 1);
        let mut first = None;
        let mut count = 0;
        for chunk in separate {
            first = first.or(Some(chunk[0]));
            count += 1;
        }
        out.warning = first.map(|v| Warning::IndicesKept {
            vertex: VertexId(v),
            count,
        });
        out.warning.is_some().then_some(out)
    }

    /// Makes a vertex of every distinct key of a corner, whose second part is the data's vertex.
    fn by_key(
        data: &MeshData,
        key: impl Fn(usize, usize) -> (u32, u32),
        warning: Option<Warning>,
    ) -> Self {
        let count = data.triangles.len();
        let mut keys: Vec<(u32, u32)> = (0..count)
            .flat_map(|t| [key(t, 0), key(t, 1), key(t, 2)])
            .collect();
        keys.sort_unstable();
        keys.dedup();
        // Every corner's key is there, so the position is an index.
        let vertex = |key| index_u32(keys.partition_point(|&other| other < key));
        let triangles = (0..count)
            .map(|t| [0, 1, 2].map(|k| vertex(key(t, k))))
            .collect();
        Self {
            vertices: keys.iter().map(|&(_, v)| v).collect(),
            triangles,
            warning,
        }
    }
}

/// Returns the component of every triangle by the file's indices, named by a vertex of the file.
fn components(data: &MeshData) -> Option<Vec<u32>> {
    let count = data.file_triangles.iter().flatten().max()?;
    let mut partition = Partition::new(*count as usize + 1);
    for t in &data.file_triangles {
        partition.join(t[0], t[1]);
        partition.join(t[0], t[2]);
    }
    let triangles = data.file_triangles.iter();
    Some(triangles.map(|t| partition.find(t[0])).collect())
}

/// Returns for every component whether its indices form a closed, oriented manifold.
///
/// Its edges may have no length: where walls of incisions cross, several vertices are in one place.
fn closed_components(data: &MeshData, components: &[u32]) -> Vec<bool> {
    let count = components.iter().max().map_or(0, |&c| c as usize + 1);
    let mut is_closed = vec![true; count];
    for (t, &component) in data.file_triangles.iter().zip(components) {
        is_closed[component as usize] &= !is_collapsed(t);
    }
    let sound: Vec<usize> = (0..components.len())
        .filter(|&t| is_closed[components[t] as usize])
        .collect();
    let triangles: Vec<[u32; 3]> = sound.iter().map(|&t| data.file_triangles[t]).collect();
    for edge in Links::new(&triangles).edges() {
        if !Links::is_consistent(edge, &triangles) || edge.len() != 2 {
            let t = sound[edge[0].1.triangle().index()];
            is_closed[components[t] as usize] = false;
        }
    }
    is_closed
}
