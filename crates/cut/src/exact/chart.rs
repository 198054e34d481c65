//! Texture coordinates and normals of corners whose vertex moves.

use incise_mesh::{Edit, HalfEdge, Surface};

/// What texture coordinates and normals do when a vertex moves: corners that had what the vertex had in
/// this triangle get what its new place has there. Other charts keep theirs.
pub(super) struct Chart {
    uv: Option<[[f32; 2]; 2]>,
    normal: Option<[[f32; 3]; 2]>,
}

impl Chart {
    /// Corner `from` has what the vertex had, corner `to` what its new place has.
    pub(super) fn of(surface: &Surface, from: HalfEdge, to: HalfEdge) -> Self {
        let corners = &surface.corners;
        let uv = |h: HalfEdge| corners.uv.get(h.index()).copied();
        let normal = |h: HalfEdge| corners.normal.get(h.index()).copied();
        Self {
            uv: uv(from).zip(uv(to)).map(|(a, b)| [a, b]),
            normal: normal(from).zip(normal(to)).map(|(a, b)| [a, b]),
        }
    }

    /// A corner that the vertex had: it gets what the new place has if it is of this chart.
    pub(super) fn follow(&self, edit: &mut Edit<'_>, h: HalfEdge) {
        if let Some([from, to]) = self.uv
            && edit.surface().corners.uv[h.index()] == from
        {
            edit.set_uv(h, to);
        }
        if let Some([from, to]) = self.normal
            && edit.surface().corners.normal[h.index()] == from
        {
            edit.set_normal(h, to);
        }
    }
}
