//! [`Skin`]: the triangles of a surface at rest, in arrays.

use incise_mesh::{HalfEdge, Surface, TriangleId, Vec3, VertexId, index_u32};

/// An edge between two triangles.
#[derive(Debug)]
pub(crate) struct SkinEdge {
    pub(crate) ends: [Vec3; 2],
    /// Their numbers in the skin.
    pub(crate) triangles: [u32; 2],
}

/// The triangles of a surface at rest.
#[derive(Debug)]
pub(crate) struct Skin {
    pub(crate) ids: Vec<TriangleId>,
    pub(crate) corners: Vec<[Vec3; 3]>,
    /// The piece of each triangle.
    pub(crate) pieces: Vec<u32>,
    pub(crate) edges: Vec<SkinEdge>,
}

impl Skin {
    pub(crate) fn new(surface: &Surface) -> Self {
        let topology = surface.topology();
        let rest = |v: VertexId| surface.rest_position(v);
        let ids: Vec<TriangleId> = topology.triangles().collect();
        let mut numbers = vec![0; topology.triangle_slots()];
        for (i, t) in ids.iter().enumerate() {
            numbers[t.index()] = index_u32(i);
        }
        let edges = topology.edges().filter_map(|h: HalfEdge| {
            let twin = topology.twin(h);
            (!twin.is_null()).then(|| SkinEdge {
                ends: [topology.origin(h), topology.target(h)].map(rest),
                triangles: [h, twin].map(|h| numbers[h.triangle().index()]),
            })
        });
        Self {
            corners: ids
                .iter()
                .map(|&t| topology.triangle(t).map(rest))
                .collect(),
            pieces: ids.iter().map(|&t| surface.piece(t)).collect(),
            edges: edges.collect(),
            ids,
        }
    }
}
