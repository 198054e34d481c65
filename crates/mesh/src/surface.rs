//! A surface: connectivity and the arrays that go with it.

use crate::geometry::{Aabb, Vec3, widen};
use crate::history::{History, Step};
use crate::ids::{HalfEdge, TriangleId, VertexId};
use crate::pieces::Pieces;
use crate::topology::{Topology, TopologyError, copy};

mod parts;

/// What corners carry beside their vertex. A seam is where the corners of one vertex differ; it
/// never splits the vertex. Each array is empty or has three entries a triangle slot.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CornerAttributes {
    /// Texture coordinates, shape \[3 x triangle slots\].
    pub uv: Vec<[f32; 2]>,
    /// Shading normals, shape \[3 x triangle slots\].
    pub normal: Vec<[f32; 3]>,
}

impl CornerAttributes {
    /// Gives new triangle slots zeros in the arrays that are there.
    pub(crate) fn fit(&mut self, triangle_slots: usize) {
        if !self.uv.is_empty() {
            self.uv.resize(3 * triangle_slots, [0.0; 2]);
        }
        if !self.normal.is_empty() {
            self.normal.resize(3 * triangle_slots, [0.0; 3]);
        }
    }
}

/// A triangle surface as a structure of arrays, one array an attribute. One surface holds any
/// number of pieces (bodies after a cut): every triangle has the number of its piece.
///
/// Surfaces are equal when their arrays are, however they came to be what they are. A new surface has
/// room for a quarter more than it holds, so that its first edits do not move whole arrays, and so has
/// a copy of it; [`Surface::reserve`] makes more.
#[derive(Debug, Default)]
pub struct Surface {
    pub(crate) topology: Topology,
    /// Position \[m\] and inverse mass \[1/kg\], 0 = pinned, shape \[vertex slots\].
    pub positions: Vec<[f32; 4]>,
    /// Rest position \[m\], shape \[vertex slots\].
    pub rest: Vec<[f32; 3]>,
    /// Attributes of corners.
    pub corners: CornerAttributes,
    /// Shape \[triangle slots\], like `material`.
    pub(crate) piece: Vec<u32>,
    pub(crate) material: Vec<u32>,
    pub(crate) pieces: Pieces,
    pub(crate) history: History,
}

impl Clone for Surface {
    fn clone(&self) -> Self {
        Self {
            topology: self.topology.clone(),
            positions: copy(&self.positions),
            rest: copy(&self.rest),
            corners: CornerAttributes {
                uv: copy(&self.corners.uv),
                normal: copy(&self.corners.normal),
            },
            piece: copy(&self.piece),
            material: copy(&self.material),
            pieces: self.pieces.clone(),
            history: self.history,
        }
    }
}

impl PartialEq for Surface {
    fn eq(&self, other: &Self) -> bool {
        self.topology == other.topology
            && self.positions == other.positions
            && self.rest == other.rest
            && self.corners == other.corners
            && self.piece == other.piece
            && self.material == other.material
            && self.pieces == other.pieces
    }
}

impl Surface {
    /// A surface at rest: rest positions are `positions`, inverse masses 1, one piece a connected
    /// component, numbered in order of their first triangle.
    ///
    /// # Errors
    /// [`TopologyError`] when the triangles do not make an oriented manifold (boundaries are allowed).
    pub fn from_triangles(
        positions: &[[f32; 3]],
        triangles: &[[u32; 3]],
    ) -> Result<Self, TopologyError> {
        let topology = Topology::from_triangles(positions.len(), triangles)?;
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
            corners: CornerAttributes::default(),
            piece,
        };
        surface.reserve(positions.len() / 4, triangles.len() / 4);
        Ok(surface)
    }

    /// Makes room for so many vertices and triangles more, so that edits up to this size do not move
    /// whole arrays.
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
    }

    /// The connectivity.
    #[must_use]
    #[inline]
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// The positions, to be moved, together with the connectivity, for who needs both at once.
    #[must_use]
    #[inline]
    pub fn positions_and_topology(&mut self) -> (&mut [[f32; 4]], &Topology) {
        (&mut self.positions, &self.topology)
    }

    /// Where `v` is \[m\].
    #[must_use]
    #[inline]
    pub fn position(&self, v: VertexId) -> Vec3 {
        let [x, y, z, _] = self.positions[v.index()];
        widen([x, y, z])
    }

    /// Where `v` is at rest \[m\].
    #[must_use]
    #[inline]
    pub fn rest_position(&self, v: VertexId) -> Vec3 {
        widen(self.rest[v.index()])
    }

    /// Where the corners of `t` are \[m\].
    #[must_use]
    #[inline]
    pub fn triangle_positions(&self, t: TriangleId) -> [Vec3; 3] {
        self.topology.triangle(t).map(|v| self.position(v))
    }

    /// The piece that `t` belongs to.
    #[must_use]
    #[inline]
    pub fn piece(&self, t: TriangleId) -> u32 {
        self.piece[t.index()]
    }

    /// One more than the largest piece number that was ever in use. O(1).
    #[must_use]
    #[inline]
    pub fn piece_bound(&self) -> u32 {
        self.pieces.bound()
    }

    /// How many pieces have triangles. O(1).
    #[must_use]
    #[inline]
    pub fn piece_count(&self) -> usize {
        self.pieces.len()
    }

    /// The triangles of a piece; 0 of a number not in use. O(log p) for p pieces.
    #[must_use]
    #[inline]
    pub fn piece_triangles(&self, piece: u32) -> usize {
        self.pieces.count(piece) as usize
    }

    /// The material of `t`: a number that means what its user says. 0 unless set.
    #[must_use]
    #[inline]
    pub fn material(&self, t: TriangleId) -> u32 {
        self.material[t.index()]
    }

    /// A fingerprint of how the surface was made and of every edit since, in order; motion does not
    /// count. The same on every machine. An undo puts the old one back.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        self.history.value()
    }

    /// The box around the vertices that triangles use.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::around(self.topology.vertices().map(|v| {
            let [x, y, z, _] = self.positions[v.index()];
            [x, y, z]
        }))
    }

    /// Vertices as a renderer counts them: one for each distinct set of corner attributes of a
    /// vertex that triangles use. This is the paper's "Number of Vertices".
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
                (
                    self.topology.origin(h),
                    uv.map(f32::to_bits),
                    normal.map(f32::to_bits),
                )
            })
            .collect();
        corners.sort_unstable();
        corners.dedup();
        corners.len()
    }

    /// Makes a vertex that no triangle uses yet.
    pub fn add_vertex(&mut self, position: [f32; 4], rest: [f32; 3]) -> VertexId {
        let v = self.topology.add_vertex();
        if v.index() == self.positions.len() {
            self.positions.push(position);
            self.rest.push(rest);
        } else {
            self.positions[v.index()] = position;
            self.rest[v.index()] = rest;
        }
        self.history.step(Step::AddVertex, v.0);
        self.history.floats(&position);
        self.history.floats(&rest);
        v
    }

    /// Makes a triangle of `piece` without neighbors; corner attributes are zero.
    ///
    /// # Errors
    /// [`TopologyError`] when the vertices repeat or do not exist.
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
        self.pieces.add(piece);
        let [a, b, c] = corners.map(|v| v.0);
        self.history.step(Step::AddTriangle, t.0);
        self.history.pair(a, b);
        self.history.pair(c, piece);
        Ok(t)
    }

    /// Joins boundary half-edges, see [`Topology::stitch`].
    ///
    /// # Errors
    /// [`TopologyError`]; nothing is joined then.
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
    /// When a triangle still uses one.
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

    /// Gives a triangle another material.
    pub fn set_material(&mut self, t: TriangleId, material: u32) {
        self.material[t.index()] = material;
        self.history.step(Step::SetMaterial, t.0);
        self.history.pair(material, 0);
    }
}
