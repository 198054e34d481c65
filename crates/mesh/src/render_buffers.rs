//! Vertex and index buffers for renderers, kept up to date while a surface moves and is cut.

mod refresh;
mod smooth;
#[cfg(test)]
mod tests;

use crate::delta::TopologyDelta;
use crate::ids::{HalfEdge, TriangleId, VertexId, index_u32};
use crate::surface::{Channel, Domain, Surface};

/// Marks a triangle slot or corner without a place in the buffers.
const NONE: u32 = u32::MAX;

/// Options of [`RenderBuffers`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderParams {
    /// Angle between two triangles from which their edge is a crease with two normals \[rad\].
    ///
    /// Measured at rest. Surfaces with normals of their own have creases where these differ.
    pub crease_angle: f64,
    /// Materials from this number on belong to caps.
    pub cap_material: u32,
    /// The only piece in the buffers; all pieces if absent.
    pub piece: Option<u32>,
    /// Compute tangents. They need texture coordinates.
    pub tangents: bool,
}

impl Default for RenderParams {
    fn default() -> Self {
        Self {
            crease_angle: 30_f64.to_radians(),
            cap_material: 1,
            piece: None,
            tangents: false,
        }
    }
}

/// Vertex and index buffers of a surface or of one of its pieces.
///
/// A buffer vertex belongs to all corners of a surface vertex with the same attributes on the same
/// side of creases. Its number stays the same while these corners exist; free numbers have zeros
/// and no triangle refers to them.
///
/// ```
/// use incise_mesh::{RenderBuffers, RenderParams, icosphere};
///
/// let body = icosphere(2, 0.5);
/// let mut buffers = RenderBuffers::new(&body, RenderParams::default());
/// assert_eq!(buffers.skin_indices().len(), 3 * 320);
/// buffers.refresh(&body);
/// assert_eq!(buffers.positions()[0], body.rest_positions()[0]);
/// ```
#[derive(Debug, Clone)]
pub struct RenderBuffers {
    params: RenderParams,
    /// [`Surface::fingerprint`] at the last rebuild or update.
    fingerprint: u64,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    tangents: Vec<[f32; 4]>,
    uvs: Vec<[f32; 2]>,
    channels: Vec<Channel>,
    /// Indices of the skin and of the caps.
    indices: [Vec<u32>; 2],
    /// The triangles of both index buffers, in their order.
    triangles: [Vec<TriangleId>; 2],
    /// Place of each triangle slot in its index buffer.
    place: Vec<u32>,
    /// Which index buffer a triangle slot is in.
    submesh: Vec<u8>,
    /// Buffer vertex of each corner slot.
    corner_vertices: Vec<u32>,
    /// A corner of each buffer vertex; null if the vertex is free.
    corners: Vec<HalfEdge>,
    free: Vec<u32>,
    /// Scratch memory: changed vertices and corners of one vertex.
    touched: Vec<VertexId>,
    fan: Vec<HalfEdge>,
}

impl RenderBuffers {
    /// Builds the buffers of a surface. O(n).
    #[must_use]
    pub fn new(surface: &Surface, params: RenderParams) -> Self {
        let mut out = Self {
            params,
            fingerprint: surface.fingerprint(),
            positions: Vec::new(),
            normals: Vec::new(),
            tangents: Vec::new(),
            uvs: Vec::new(),
            channels: Vec::new(),
            indices: Default::default(),
            triangles: Default::default(),
            place: Vec::new(),
            submesh: Vec::new(),
            corner_vertices: Vec::new(),
            corners: Vec::new(),
            free: Vec::new(),
            touched: Vec::new(),
            fan: Vec::new(),
        };
        out.rebuild(surface);
        out
    }

    /// Builds the buffers again and keeps their memory. O(n).
    pub fn rebuild(&mut self, surface: &Surface) {
        self.fingerprint = surface.fingerprint();
        for part in 0..2 {
            self.indices[part].clear();
            self.triangles[part].clear();
        }
        self.place.clear();
        self.submesh.clear();
        self.corner_vertices.clear();
        self.corners.clear();
        self.free.clear();
        self.fit(surface);
        for t in surface.topology().triangles() {
            self.add_triangle(surface, t);
        }
        for h in surface
            .topology()
            .triangles()
            .flat_map(TriangleId::half_edges)
        {
            self.number_corner(surface, h);
        }
        let empty = surface
            .channels()
            .iter()
            .map(|channel| channel.with_values(Vec::new()));
        self.channels = empty.collect();
        self.write_attributes(surface);
        self.refresh(surface);
    }

    /// Updates the buffers after an edit of the surface, and refreshes positions and normals.
    ///
    /// Only corners around changed triangles get other buffer vertices. The buffers are rebuilt if
    /// the surface is open, its channels have changed, or a single piece may have been split or
    /// merged. Values of UVs and channels are read again at every vertex; new seams need
    /// [`Self::rebuild`].
    pub fn update(&mut self, surface: &Surface, delta: &TopologyDelta) {
        let has_new_pieces = !delta.pieces_added.is_empty() || !delta.pieces_removed.is_empty();
        let may_have_split = self.params.piece.is_some() && has_new_pieces;
        let kinds = self.channels.iter().map(kind);
        let has_same_channels = kinds.eq(surface.channels().iter().map(kind));
        if may_have_split || !has_same_channels || !surface.topology().is_closed() {
            self.rebuild(surface);
            return;
        }
        self.fingerprint = surface.fingerprint();
        self.touched.clear();
        for &(t, corners) in &delta.triangles_removed {
            self.remove_triangle(t);
            self.touched.extend(corners);
        }
        self.fit(surface);
        for &t in &delta.triangles_added {
            self.add_triangle(surface, t);
            self.touched.extend(surface.topology().triangle(t));
        }
        self.touched.sort_unstable();
        self.touched.dedup();
        self.touched
            .retain(|&v| !surface.topology().outgoing(v).is_null());
        // Corners may be joined or parted, so all corners of these vertices are numbered again.
        for i in 0..self.touched.len() {
            for h in surface.topology().outgoing_fan(self.touched[i]) {
                self.release(h);
            }
        }
        for i in 0..self.touched.len() {
            for h in surface.topology().outgoing_fan(self.touched[i]) {
                self.number_corner(surface, h);
            }
        }
        self.write_attributes(surface);
        self.refresh(surface);
    }

    /// Returns [`Surface::fingerprint`] of the topology that the buffers have.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        self.fingerprint
    }

    /// Returns positions \[m\], shape \[buffer vertices\].
    #[must_use]
    pub fn positions(&self) -> &[[f32; 3]] {
        &self.positions
    }

    /// Returns unit normals, shape \[buffer vertices\].
    #[must_use]
    pub fn normals(&self) -> &[[f32; 3]] {
        &self.normals
    }

    /// Returns unit tangents along u and the sign of the bitangent, as in glTF; empty unless asked
    /// for.
    #[must_use]
    pub fn tangents(&self) -> &[[f32; 4]] {
        &self.tangents
    }

    /// Returns texture coordinates, shape \[buffer vertices\]; empty if the surface has none.
    #[must_use]
    pub fn uvs(&self) -> &[[f32; 2]] {
        &self.uvs
    }

    /// Returns the channels of the surface with a row per buffer vertex.
    #[must_use]
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Returns three indices per triangle of the skin.
    #[must_use]
    pub fn skin_indices(&self) -> &[u32] {
        &self.indices[0]
    }

    /// Returns three indices per triangle of the caps.
    #[must_use]
    pub fn cap_indices(&self) -> &[u32] {
        &self.indices[1]
    }

    /// Returns the surface vertex of each buffer vertex; null if it is free.
    pub fn vertices<'a>(&'a self, surface: &'a Surface) -> impl Iterator<Item = VertexId> + 'a {
        let vertex = |h: &HalfEdge| {
            if h.is_null() {
                VertexId::NULL
            } else {
                surface.topology().origin(*h)
            }
        };
        self.corners.iter().map(vertex)
    }

    /// Returns a corner of each buffer vertex; null if it is free.
    #[cfg(feature = "gltf")]
    pub(crate) fn corners(&self) -> &[HalfEdge] {
        &self.corners
    }

    /// Iterates over the triangles of skin and caps with their indices.
    #[cfg(feature = "gltf")]
    pub(crate) fn triangles(&self) -> impl Iterator<Item = (TriangleId, [u32; 3])> {
        let parts = self.triangles.iter().zip(&self.indices);
        parts.flat_map(|(triangles, indices)| {
            triangles
                .iter()
                .copied()
                .zip(indices.as_chunks::<3>().0.iter().copied())
        })
    }

    /// Gives the arrays an entry per triangle slot.
    fn fit(&mut self, surface: &Surface) {
        let slots = surface.topology().triangle_slots();
        self.place.resize(slots, NONE);
        self.submesh.resize(slots, 0);
        self.corner_vertices.resize(3 * slots, NONE);
    }

    /// Adds a triangle to its index buffer, without vertices.
    fn add_triangle(&mut self, surface: &Surface, t: TriangleId) {
        if self
            .params
            .piece
            .is_some_and(|piece| surface.piece(t) != piece)
        {
            return;
        }
        let part = usize::from(surface.material(t) >= self.params.cap_material);
        self.submesh[t.index()] = u8::from(part == 1);
        self.place[t.index()] = index_u32(self.triangles[part].len());
        self.triangles[part].push(t);
        self.indices[part].extend([0; 3]);
    }

    /// Removes a triangle from its index buffer; the last one takes its place.
    fn remove_triangle(&mut self, t: TriangleId) {
        let Some(place) = self.place.get_mut(t.index()) else {
            return;
        };
        let place = std::mem::replace(place, NONE);
        if place == NONE {
            return;
        }
        for h in t.half_edges() {
            self.release(h);
        }
        let part = usize::from(self.submesh[t.index()]);
        let (triangles, indices) = (&mut self.triangles[part], &mut self.indices[part]);
        let at = place as usize;
        triangles.swap_remove(at);
        let last = 3 * triangles.len();
        indices.copy_within(last..last + 3, 3 * at);
        indices.truncate(last);
        if let Some(moved) = triangles.get(at) {
            self.place[moved.index()] = place;
        }
    }

    /// Takes the buffer vertex from a corner, and frees the vertex.
    ///
    /// All corners of the vertex are released together.
    fn release(&mut self, h: HalfEdge) {
        let vertex = std::mem::replace(&mut self.corner_vertices[h.index()], NONE);
        if let Some(corner) = self.corners.get_mut(vertex as usize)
            && !corner.is_null()
        {
            *corner = HalfEdge::NULL;
            self.free.push(vertex);
        }
    }

    /// Gives a corner a buffer vertex, together with all corners that share it.
    fn number_corner(&mut self, surface: &Surface, h: HalfEdge) {
        let is_absent = self.place[h.triangle().index()] == NONE;
        if is_absent || self.corner_vertices[h.index()] != NONE {
            return;
        }
        let vertex = self.free.pop().unwrap_or_else(|| {
            self.corners.push(HalfEdge::NULL);
            index_u32(self.corners.len() - 1)
        });
        self.corners[vertex as usize] = h;
        self.collect_smooth(surface, h);
        for &corner in &self.fan {
            let t = corner.triangle().index();
            let first = 3 * self.place[t] as usize;
            self.corner_vertices[corner.index()] = vertex;
            self.indices[usize::from(self.submesh[t])][first + corner.index() % 3] = vertex;
        }
    }

    /// Writes the values of all vertices that do not move.
    fn write_attributes(&mut self, surface: &Surface) {
        let count = self.corners.len();
        self.positions.resize(count, [0.0; 3]);
        self.normals.resize(count, [0.0; 3]);
        let has_uvs = !surface.corner_uvs().is_empty();
        self.uvs.resize(if has_uvs { count } else { 0 }, [0.0; 2]);
        let has_tangents = has_uvs && self.params.tangents;
        self.tangents
            .resize(if has_tangents { count } else { 0 }, [0.0; 4]);
        for (uv, &h) in self.uvs.iter_mut().zip(&self.corners) {
            *uv = surface
                .corner_uvs()
                .get(h.index())
                .copied()
                .unwrap_or_default();
        }
        for (out, channel) in self.channels.iter_mut().zip(surface.channels()) {
            out.fit(count);
            for (row, &h) in out
                .values
                .chunks_exact_mut(channel.width())
                .zip(&self.corners)
            {
                let slot = match channel.domain() {
                    Domain::Corner => h.index(),
                    Domain::Vertex if h.is_null() => usize::MAX,
                    Domain::Vertex => surface.topology().origin(h).index(),
                };
                match channel.row(slot) {
                    [] => row.fill(0.0),
                    values => row.copy_from_slice(values),
                }
            }
        }
    }
}

/// Returns the name and the width of a channel.
fn kind(channel: &Channel) -> (&str, usize) {
    (channel.name(), channel.width())
}
