//! Data of new vertices and corners, interpolated from the surface before the cut.

use incise_mesh::geometry::{round_to_f32, to_f32};
use incise_mesh::{Edit, HalfEdge, Surface, TriangleId, Vec3, VertexId, VertexOrigin};

/// Adds a vertex at `position` \[m\] with the rest position and inverse mass of its origin.
pub(crate) fn add_vertex(edit: &mut Edit<'_>, position: Vec3, origin: VertexOrigin) -> VertexId {
    let surface = edit.surface();
    let rest = origin.interpolate(|v| surface.rest_positions()[v.index()]);
    let [w] = origin.interpolate(|v| [surface.positions()[v.index()][3]]);
    let [x, y, z] = to_f32(position);
    edit.add_vertex([x, y, z, round_to_f32(w)], to_f32(rest.into()), origin)
}

/// Vertices and corner attributes of a triangle before the edit that removes it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OldTriangle {
    pub(crate) triangle: TriangleId,
    pub(crate) corners: [VertexId; 3],
    uv: Option<[[f32; 2]; 3]>,
    normal: Option<[[f32; 3]; 3]>,
}

impl OldTriangle {
    pub(crate) fn new(surface: &Surface, triangle: TriangleId) -> Self {
        let half_edges = triangle.half_edges();
        let (uvs, normals) = (surface.corner_uvs(), surface.corner_normals());
        Self {
            triangle,
            corners: surface.topology().triangle(triangle),
            uv: (!uvs.is_empty()).then(|| half_edges.map(|h| uvs[h.index()])),
            normal: (!normals.is_empty()).then(|| half_edges.map(|h| normals[h.index()])),
        }
    }

    /// Whether corners have no attributes.
    pub(crate) fn is_plain(&self) -> bool {
        self.uv.is_none() && self.normal.is_none()
    }

    /// Sets the attributes of a new corner to the weighted sum of the three old ones.
    pub(crate) fn interpolate(&self, edit: &mut Edit<'_>, h: HalfEdge, weights: [f32; 3]) {
        if let Some(uv) = self.uv {
            edit.set_uv(h, blend(uv, weights));
        }
        if let Some(normal) = self.normal {
            edit.set_normal(h, blend(normal, weights));
        }
    }
}

/// Returns the weighted sum; exactly one of the values where its weight is 1.
fn blend<const N: usize>(values: [[f32; N]; 3], weights: [f32; 3]) -> [f32; N] {
    if let Some(k) = weights.iter().position(|&w| w == 1.0) {
        return values[k];
    }
    std::array::from_fn(|i| (0..3).map(|k| weights[k] * values[k][i]).sum())
}

/// Attribute values of a vertex in one chart, before and after it moves.
///
/// Corners with the old value get the new one. Other charts keep theirs.
pub(crate) struct Chart {
    uv: Option<[[f32; 2]; 2]>,
    normal: Option<[[f32; 3]; 2]>,
}

impl Chart {
    /// Corner `from` has the old values, corner `to` those at the new position.
    pub(crate) fn new(surface: &Surface, from: HalfEdge, to: HalfEdge) -> Self {
        let uv = |h: HalfEdge| surface.corner_uvs().get(h.index()).copied();
        let normal = |h: HalfEdge| surface.corner_normals().get(h.index()).copied();
        Self {
            uv: uv(from).zip(uv(to)).map(|(a, b)| [a, b]),
            normal: normal(from).zip(normal(to)).map(|(a, b)| [a, b]),
        }
    }

    /// Updates a corner of the vertex if it belongs to this chart.
    pub(crate) fn update(&self, edit: &mut Edit<'_>, h: HalfEdge) {
        if let Some([from, to]) = self.uv
            && edit.surface().corner_uvs()[h.index()] == from
        {
            edit.set_uv(h, to);
        }
        if let Some([from, to]) = self.normal
            && edit.surface().corner_normals()[h.index()] == from
        {
            edit.set_normal(h, to);
        }
    }
}
