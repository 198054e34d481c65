//! Data of new vertices and corners, interpolated from the surface before the cut.

use incise_mesh::geometry::{round_to_f32, to_f32};
use incise_mesh::{
    CornerValues, Edit, HalfEdge, Surface, TriangleId, Vec3, VertexId, VertexOrigin,
};

/// Adds a vertex at `position` \[m\] with the rest position and inverse mass of its origin.
pub(crate) fn add_vertex(edit: &mut Edit<'_>, position: Vec3, origin: VertexOrigin) -> VertexId {
    let surface = edit.surface();
    let rest = origin.interpolate(|v| surface.rest_positions()[v.index()]);
    let [w] = origin.interpolate(|v| [surface.positions()[v.index()][3]]);
    let [x, y, z] = to_f32(position);
    edit.add_vertex([x, y, z, round_to_f32(w)], to_f32(rest.into()), origin)
}

/// Vertices and corner attributes of a triangle before the edit that removes it.
#[derive(Debug, Clone)]
pub(crate) struct OldTriangle {
    pub(crate) triangle: TriangleId,
    pub(crate) corners: [VertexId; 3],
    values: [CornerValues; 3],
}

impl OldTriangle {
    pub(crate) fn new(surface: &Surface, triangle: TriangleId) -> Self {
        Self {
            triangle,
            corners: surface.topology().triangle(triangle),
            values: triangle.half_edges().map(|h| surface.corner_values(h)),
        }
    }

    /// Whether corners have no attributes.
    pub(crate) fn is_plain(&self) -> bool {
        self.values[0].is_empty()
    }

    /// Sets the attributes of a new corner to the weighted sum of the three old ones.
    pub(crate) fn interpolate(&self, edit: &mut Edit<'_>, h: HalfEdge, weights: [f32; 3]) {
        let values = CornerValues::interpolate(self.values.each_ref(), weights);
        edit.set_corner_values(h, &values);
    }
}

/// Attribute values of a vertex in one chart, before and after it moves.
///
/// Corners with the old value get the new one. Other charts keep theirs.
pub(crate) struct Chart {
    from: CornerValues,
    to: CornerValues,
}

impl Chart {
    /// Corner `from` has the old values, corner `to` those at the new position.
    pub(crate) fn new(surface: &Surface, from: HalfEdge, to: HalfEdge) -> Self {
        let [from, to] = [from, to].map(|h| surface.corner_values(h));
        Self { from, to }
    }

    /// Updates a corner of the vertex if it belongs to this chart.
    pub(crate) fn update(&self, edit: &mut Edit<'_>, h: HalfEdge) {
        edit.replace_corner_values(h, &self.from, &self.to);
    }
}
