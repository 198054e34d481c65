//! Attributes of new vertices and corners in an edit.

use super::Edit;
use super::log::{Log, RowTrack};
use crate::delta::VertexOrigin;
use crate::history::Step;
use crate::ids::{HalfEdge, TriangleId, VertexId};
use crate::surface::{Channel, CornerValues, Domain, Row};

impl Edit<'_> {
    /// Adds a channel of zeros, see [`Channel::new`]. An undo removes it.
    ///
    /// A surface that has a channel of this name keeps that one.
    pub fn add_channel(&mut self, channel: &Channel) {
        if self.surface.channel(channel.name()).is_none() {
            let mut added = channel.with_values(Vec::new());
            added.fit(self.surface.slots(channel.domain()));
            self.log.channels.push(RowTrack::of_added(&added));
            self.surface.channels.push(added);
        }
    }

    /// Sets the row of a vertex in the vertex channel of this name, if the surface has it.
    ///
    /// Values beyond the channel's width are ignored.
    pub fn set_vertex_row(&mut self, v: VertexId, name: &str, values: &[f32]) {
        let surface = &mut *self.surface;
        let mut channels = surface.channels.iter_mut().zip(&mut self.log.channels);
        let is_own = |c: &Channel| c.domain() == Domain::Vertex && c.name() == name;
        if let Some((channel, track)) = channels.find(|entry| is_own(entry.0)) {
            let mut row = channel.copy_row(v.index());
            for (value, &new) in row.iter_mut().zip(values).take(channel.width()) {
                *value = new;
            }
            track.set(channel, v.index(), &row);
            surface.history.step(Step::SetRow, v.0);
            surface.history.floats(&row[..channel.width()]);
        }
    }

    /// Sets the attributes of the corner at `h` that both the surface and `values` have.
    pub fn set_corner_values(&mut self, h: HalfEdge, values: &CornerValues) {
        if let Some(uv) = values.uv {
            self.set_uv(h, uv);
        }
        if let Some(normal) = values.normal {
            self.set_normal(h, normal);
        }
        for (i, (row, ..)) in values.rows.iter().enumerate() {
            self.set_corner_row(h, i, row);
        }
    }

    /// Replaces each attribute of the corner at `h` that equals that of `from` by that of `to`.
    ///
    /// Corners of a vertex on other sides of a seam keep theirs.
    pub fn replace_corner_values(&mut self, h: HalfEdge, from: &CornerValues, to: &CornerValues) {
        let own = self.surface().corner_values(h);
        if own.uv == from.uv
            && let Some(uv) = to.uv
        {
            self.set_uv(h, uv);
        }
        if own.normal == from.normal
            && let Some(normal) = to.normal
        {
            self.set_normal(h, normal);
        }
        let rows = own.rows.iter().zip(&from.rows).zip(&to.rows);
        for (i, ((own, from), to)) in rows.enumerate() {
            if own.0 == from.0 {
                self.set_corner_row(h, i, &to.0);
            }
        }
    }

    /// Sets the corner channels of new triangles from the surface around them.
    ///
    /// A vertex on the border of `triangles` has the values of the corners across the border, the
    /// smallest of several; any other vertex has the interpolation of its parents.
    pub fn inherit_corner_channels(&mut self, triangles: &[TriangleId]) {
        let count = self.surface.corner_channels().count();
        if count == 0 {
            return;
        }
        let mut own = triangles.to_vec();
        own.sort_unstable();
        let topology = &self.surface.topology;
        let sides = || own.iter().flat_map(|t| t.half_edges());
        let mut across: Vec<(VertexId, HalfEdge)> = sides()
            .map(|h| (h, topology.twin(h)))
            .filter(|(_, twin)| !twin.is_null() && own.binary_search(&twin.triangle()).is_err())
            .flat_map(|(h, twin)| {
                [
                    (topology.origin(h), twin.next()),
                    (topology.target(h), twin),
                ]
            })
            .collect();
        across.sort_unstable();
        // Parents of new vertices may lie outside of the triangles.
        let parents = self
            .vertices
            .iter()
            .flat_map(|(_, origin)| origin.parents());
        let mut vertices: Vec<VertexId> =
            sides().map(|h| topology.origin(h)).chain(parents).collect();
        vertices.sort_unstable();
        vertices.dedup();
        for i in 0..count {
            let rows = self.rows_of_vertices(i, &vertices, &across);
            for &t in triangles {
                for h in t.half_edges() {
                    let v = self.surface.topology.origin(h);
                    if let Ok(at) = vertices.binary_search(&v) {
                        self.set_corner_row(h, i, &rows[at].unwrap_or_default());
                    }
                }
            }
        }
    }

    /// Returns a row of corner channel `i` for each vertex, none where none is known.
    fn rows_of_vertices(
        &self,
        i: usize,
        vertices: &[VertexId],
        across: &[(VertexId, HalfEdge)],
    ) -> Vec<Option<Row>> {
        let mut rows = vec![None; vertices.len()];
        let Some(channel) = self.surface.corner_channels().nth(i) else {
            return rows;
        };
        let number = |v: VertexId| vertices.binary_search(&v).ok();
        for corners in across.chunk_by(|a, b| a.0 == b.0) {
            let values = corners.iter().map(|&(_, h)| channel.copy_row(h.index()));
            let smallest = values.min_by(|a, b| {
                let mut orders = a.iter().zip(b).map(|(a, b)| a.total_cmp(b));
                orders
                    .find(|order| order.is_ne())
                    .unwrap_or(std::cmp::Ordering::Equal)
            });
            if let Some(at) = number(corners[0].0) {
                rows[at] = smallest;
            }
        }
        for (v, origin) in &self.vertices {
            let Some(at) = number(*v).filter(|&at| rows[at].is_none()) else {
                continue;
            };
            let of_parents = origin.weights().map(|(parent, weight)| {
                let row = number(parent).and_then(|at| rows[at]);
                (row.unwrap_or_default(), weight)
            });
            rows[at] = Some(channel.blend().rows(channel.width(), of_parents));
        }
        rows
    }

    /// Sets the row of corner channel `i`, if the surface has it.
    fn set_corner_row(&mut self, h: HalfEdge, i: usize, row: &Row) {
        let surface = &mut *self.surface;
        let is_corner = |entry: &(&mut Channel, &mut RowTrack)| entry.0.domain() == Domain::Corner;
        let mut channels =
            (surface.channels.iter_mut().zip(&mut self.log.channels)).filter(is_corner);
        if let Some((channel, track)) = channels.nth(i) {
            track.set(channel, h.index(), row);
            surface.history.step(Step::SetRow, h.0);
            surface.history.floats(&row[..channel.width()]);
        }
    }

    /// Sets the rows of a new vertex to the interpolation of its parents.
    pub(super) fn interpolate_rows(&mut self, v: VertexId, origin: &VertexOrigin) {
        for (channel, track) in self.surface.channels.iter_mut().zip(&mut self.log.channels) {
            if channel.domain() == Domain::Vertex {
                let weights = origin.weights();
                let rows =
                    weights.map(|(parent, weight)| (channel.copy_row(parent.index()), weight));
                let row = channel.blend().rows(channel.width(), rows);
                track.set(channel, v.index(), &row);
            }
        }
    }
}

impl Log {
    /// Sets the rows of a corner to zeros in all channels.
    pub(super) fn clear_corner_rows(&mut self, channels: &mut [Channel], h: HalfEdge) {
        for (channel, track) in channels.iter_mut().zip(&mut self.channels) {
            if channel.domain() == Domain::Corner {
                track.set(channel, h.index(), &Row::default());
            }
        }
    }
}

/// Extends the channels of corners by zeros for new triangle slots.
pub(super) fn fit_corners(channels: &mut [Channel], triangle_slots: usize) {
    for channel in channels.iter_mut().filter(|c| c.domain() == Domain::Corner) {
        channel.fit(3 * triangle_slots);
    }
}
