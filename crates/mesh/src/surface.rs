//! A triangle surface: connectivity and attribute arrays.

use crate::geometry::{Aabb, Vec3};
use crate::history::{History, Step};
use crate::ids::{HalfEdge, TriangleId, VertexId};
use crate::pieces::Pieces;
use crate::topology::{Topology, TopologyError, copy};

mod append;
mod attributes;
mod channels;
mod corner_values;
mod exchange;
mod folds;
mod origin;
mod parts;
mod validate;

pub use attributes::{AttributeLengthError, CornerAttributes};
pub(crate) use channels::Row;
pub use channels::{Blend, Channel, ChannelError, Domain, MAX_WIDTH};
pub use corner_values::{CornerValues, TriangleCorners};
pub(crate) use exchange::exchange;
pub use validate::InvalidSurface;

/// A triangle surface as a structure of arrays.
///
/// A surface has any number of pieces (bodies after a cut); every triangle has a piece number.
///
/// Surfaces are equal if their arrays are equal. A new surface and every clone reserve a quarter of
/// their size, so that the first edits do not reallocate; see [`Surface::reserve`].
///
/// With the feature `serde`, `finish_load` must follow its `Deserialize`, which `load` does.
#[derive(Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Surface {
    pub(crate) topology: Topology,
    /// Position \[m\] and inverse mass \[1/kg\], 0 = pinned, shape \[vertex slots\].
    pub(crate) positions: Vec<[f32; 4]>,
    /// Origin of the positions in the coordinates of its file \[m\].
    pub(crate) origin: [f64; 3],
    /// Rest position \[m\], shape \[vertex slots\].
    pub(crate) rest: Vec<[f32; 3]>,
    /// Attributes of corners.
    pub(crate) corners: CornerAttributes,
    /// Further attributes of vertices and corners.
    pub(crate) channels: Vec<Channel>,
    /// Piece number, shape \[triangle slots\].
    pub(crate) piece: Vec<u32>,
    pub(crate) material: Vec<u32>,
    pub(crate) pieces: Pieces,
    pub(crate) history: History,
    /// The stamp of the last access to positions for writing, see [`Surface::motion_version`].
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) motion: u64,
}

impl Clone for Surface {
    fn clone(&self) -> Self {
        Self {
            topology: self.topology.clone(),
            positions: copy(&self.positions),
            origin: self.origin,
            rest: copy(&self.rest),
            corners: CornerAttributes {
                uv: copy(&self.corners.uv),
                normal: copy(&self.corners.normal),
            },
            channels: (self.channels.iter())
                .map(|channel| channel.with_values(copy(&channel.values)))
                .collect(),
            piece: copy(&self.piece),
            material: copy(&self.material),
            pieces: self.pieces.clone(),
            history: self.history,
            motion: self.motion,
        }
    }
}

impl PartialEq for Surface {
    fn eq(&self, other: &Self) -> bool {
        self.topology == other.topology
            && self.positions == other.positions
            && self.origin == other.origin
            && self.rest == other.rest
            && self.corners == other.corners
            && self.channels == other.channels
            && self.piece == other.piece
            && self.material == other.material
            && self.pieces == other.pieces
    }
}

impl Surface {
    /// Builds a surface at rest, with inverse masses of 1.
    ///
    /// Rest positions equal `positions`. Each connected component is a piece, in the order of their
    /// first triangles.
    ///
    /// # Errors
    /// [`TopologyError`] if the triangles do not form an oriented manifold; boundaries are allowed.
    pub fn from_triangles(
        positions: &[[f32; 3]],
        triangles: &[[u32; 3]],
    ) -> Result<Self, TopologyError> {
        let topology = Topology::from_triangles(positions.len(), triangles)?;
        Ok(Self::from_topology(topology, positions, triangles))
    }

    /// Builds a surface of the triangles of a topology without free slots.
    pub(crate) fn from_topology(
        topology: Topology,
        positions: &[[f32; 3]],
        triangles: &[[u32; 3]],
    ) -> Self {
        let piece = topology.component_labels();
        let mut pieces = Pieces::default();
        piece.iter().for_each(|&p| pieces.add(p));
        let mut history = History::default();
        for (i, &[a, b, c]) in (0..).zip(triangles) {
            history.step(Step::Build, i);
            history.pair(a, b);
            history.pair(c, 0);
        }
        history.floats(positions.as_flattened());
        let mut surface = Self {
            material: vec![0; piece.len()],
            pieces,
            history,
            topology,
            positions: positions.iter().map(|&[x, y, z]| [x, y, z, 1.0]).collect(),
            rest: positions.to_vec(),
            origin: [0.0; 3],
            corners: CornerAttributes::default(),
            channels: Vec::new(),
            piece,
            motion: 0,
        };
        surface.reserve(positions.len() / 4, triangles.len() / 4);
        surface
    }

    /// Reserves memory for additional vertices and triangles, so that edits do not reallocate.
    pub fn reserve(&mut self, vertices: usize, triangles: usize) {
        self.topology.reserve(vertices, triangles);
        self.positions.reserve(vertices);
        self.rest.reserve(vertices);
        self.piece.reserve(triangles);
        self.material.reserve(triangles);
        if !self.corners.uv.is_empty() {
            self.corners.uv.reserve(3 * triangles);
        }
        if !self.corners.normal.is_empty() {
            self.corners.normal.reserve(3 * triangles);
        }
        for channel in &mut self.channels {
            let rows = match channel.domain() {
                Domain::Vertex => vertices,
                Domain::Corner => 3 * triangles,
            };
            channel.values.reserve(rows * channel.width());
        }
    }

    /// Returns the connectivity.
    #[must_use]
    #[inline]
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// Returns the corner positions of `t` \[m\].
    #[must_use]
    #[inline]
    pub fn triangle_positions(&self, t: TriangleId) -> [Vec3; 3] {
        self.topology.triangle(t).map(|v| self.position(v))
    }

    /// Returns the piece number of `t`.
    #[must_use]
    #[inline]
    pub fn piece(&self, t: TriangleId) -> u32 {
        self.piece[t.index()]
    }

    /// Returns an upper bound of all piece numbers ever used, exclusive. O(1).
    #[must_use]
    #[inline]
    pub fn piece_bound(&self) -> u32 {
        self.pieces.bound()
    }

    /// Returns the number of pieces with triangles. O(1).
    #[must_use]
    #[inline]
    pub fn piece_count(&self) -> usize {
        self.pieces.len()
    }

    /// Returns the number of triangles of a piece; 0 for an unused number. O(log p) for p pieces.
    #[must_use]
    #[inline]
    pub fn piece_triangles(&self, piece: u32) -> usize {
        self.pieces.count(piece) as usize
    }

    /// Returns the material number of `t`, whose meaning is up to the caller; 0 by default.
    #[must_use]
    #[inline]
    pub fn material(&self, t: TriangleId) -> u32 {
        self.material[t.index()]
    }

    /// Returns a fingerprint of the construction and of all edits since, in order.
    ///
    /// Motion does not change it. It is equal on every machine, and an undo restores it.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        self.history.value()
    }

    /// Returns the bounding box of the vertices that triangles use.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::around(self.topology.vertices().map(|v| {
            let [x, y, z, _] = self.positions[v.index()];
            [x, y, z]
        }))
    }

    /// Returns the number of vertices that a renderer needs: the paper's "Number of Vertices".
    ///
    /// It counts each distinct set of corner attributes of a used vertex.
    #[must_use]
    pub fn seam_split_vertices(&self) -> usize {
        let mut corners: Vec<_> = self
            .topology
            .triangles()
            .flat_map(TriangleId::half_edges)
            .map(|h| {
                let uv = self.corners.uv.get(h.index()).copied().unwrap_or_default();
                let normal = self
                    .corners
                    .normal
                    .get(h.index())
                    .copied()
                    .unwrap_or_default();
                let rows = self.corner_channels().flat_map(|c| c.row(h.index()));
                (
                    self.topology.origin(h),
                    uv.map(f32::to_bits),
                    normal.map(f32::to_bits),
                    rows.map(|x| x.to_bits()).collect::<Vec<_>>(),
                )
            })
            .collect();
        corners.sort_unstable();
        corners.dedup();
        corners.len()
    }

    /// Adds an unused vertex, with zeros in all channels.
    pub fn add_vertex(&mut self, position: [f32; 4], rest: [f32; 3]) -> VertexId {
        let v = self.topology.add_vertex();
        if v.index() == self.positions.len() {
            self.positions.push(position);
            self.rest.push(rest);
        } else {
            self.positions[v.index()] = position;
            self.rest[v.index()] = rest;
        }
        self.clear_rows(Domain::Vertex, v.index());
        self.history.step(Step::AddVertex, v.0);
        self.history.floats(&position);
        self.history.floats(&rest);
        v
    }

    /// Adds a triangle without neighbors, with zero corner attributes.
    ///
    /// # Errors
    /// [`TopologyError`] if the vertices repeat or do not exist.
    pub fn add_triangle(
        &mut self,
        corners: [VertexId; 3],
        piece: u32,
    ) -> Result<TriangleId, TopologyError> {
        let t = self.topology.add_triangle(corners)?;
        if t.index() == self.piece.len() {
            self.piece.push(piece);
            self.material.push(0);
            self.corners.fit(self.piece.len());
        } else {
            self.piece[t.index()] = piece;
            self.material[t.index()] = 0;
            for h in t.half_edges() {
                if let Some(uv) = self.corners.uv.get_mut(h.index()) {
                    *uv = [0.0; 2];
                }
                if let Some(normal) = self.corners.normal.get_mut(h.index()) {
                    *normal = [0.0; 3];
                }
            }
        }
        for h in t.half_edges() {
            self.clear_rows(Domain::Corner, h.index());
        }
        self.pieces.add(piece);
        let [a, b, c] = corners.map(|v| v.0);
        self.history.step(Step::AddTriangle, t.0);
        self.history.pair(a, b);
        self.history.pair(c, piece);
        Ok(t)
    }

    /// Pairs boundary half-edges, see [`Topology::stitch`].
    ///
    /// # Errors
    /// [`TopologyError`]; nothing is paired then.
    pub fn stitch(&mut self, half_edges: &[HalfEdge]) -> Result<(), TopologyError> {
        self.topology.stitch(half_edges)?;
        for h in half_edges {
            self.history.step(Step::Join, h.0);
        }
        Ok(())
    }

    /// Frees triangles, see [`Topology::remove_triangles`].
    pub fn remove_triangles(&mut self, triangles: &[TriangleId]) -> Vec<VertexId> {
        let unused = self.topology.remove_triangles(triangles);
        for t in triangles {
            self.pieces.remove(self.piece[t.index()]);
            self.history.step(Step::RemoveTriangle, t.0);
        }
        unused
    }

    /// Frees unused vertices, see [`Topology::remove_vertices`]; their data stays readable.
    ///
    /// # Panics
    /// If a triangle uses one of them.
    pub fn remove_vertices(&mut self, vertices: &[VertexId]) {
        self.topology.remove_vertices(vertices);
        for v in vertices {
            self.history.step(Step::RemoveVertex, v.0);
        }
    }

    /// Moves a triangle to another piece.
    pub fn set_piece(&mut self, t: TriangleId, piece: u32) {
        let old = std::mem::replace(&mut self.piece[t.index()], piece);
        if old != piece {
            if self.topology.is_triangle(t) {
                self.pieces.remove(old);
                self.pieces.add(piece);
            }
            self.history.step(Step::SetPiece, t.0);
            self.history.pair(piece, 0);
        }
    }

    /// Sets the material number of a triangle.
    pub fn set_material(&mut self, t: TriangleId, material: u32) {
        self.material[t.index()] = material;
        self.history.step(Step::SetMaterial, t.0);
        self.history.pair(material, 0);
    }
}
