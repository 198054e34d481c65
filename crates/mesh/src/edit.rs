//! Transactional local edits: an [`Edit`] in progress, an [`Undo`] of a finished one.
//!
//! An edit works in place and logs what it overwrites. Dropped, it restores the surface; finished,
//! it returns the change as a [`TopologyDelta`](crate::TopologyDelta) and the log as an [`Undo`].
//! Its cost depends on the size of the change only.

mod channels;
mod edges;
mod finish;
mod log;
mod piece_move;
mod relatives;
#[cfg(test)]
mod tests;
mod undo;

pub use edges::EdgeError;
pub use undo::{Undo, UndoError};

use crate::delta::VertexOrigin;
use crate::geometry::{Vec3, round_to_f32, to_f32};
use crate::history::Step;
use crate::ids::{HalfEdge, TriangleId, VertexId, index_u32};
use crate::surface::Surface;
use channels::fit_corners;
use log::Log;
use piece_move::TriangleSet;

impl Surface {
    /// Begins an edit. O(1).
    pub fn edit(&mut self) -> Edit<'_> {
        Edit {
            log: Log::new(self),
            surface: self,
            vertices: Vec::new(),
            pieces: Vec::new(),
            open: true,
        }
    }
}

/// An edit in progress, applied by [`Edit::finish`].
///
/// Dropped without a finish, it restores the surface bit for bit: arrays, their lengths and the
/// lists of free slots.
///
/// Between two calls the surface need not be a manifold; the caller ensures that it is one at the
/// end. [`Topology::outgoing`](crate::Topology::outgoing), and traversal around vertices with it,
/// is valid again only after the finish.
///
/// ```
/// use incise_mesh::{Surface, TriangleId};
///
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let mut body = Surface::from_triangles(&corners, &faces)?;
/// let before = body.clone();
///
/// let mut edit = body.edit();
/// edit.remove_triangle(TriangleId(2));
/// drop(edit);
/// assert_eq!(body, before);
///
/// let mut edit = body.edit();
/// edit.remove_triangle(TriangleId(2));
/// let (delta, undo) = edit.finish();
/// assert_eq!(delta.triangles_removed.len(), 1);
/// assert!(!body.topology().is_closed());
/// let back = undo.revert(&mut body)?;
/// assert_eq!(back.triangles_added, [TriangleId(2)]);
/// assert_eq!(body, before);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Edit<'a> {
    surface: &'a mut Surface,
    log: Log,
    /// Created vertices with their origins.
    vertices: Vec<(VertexId, VertexOrigin)>,
    /// Allocated piece numbers, each with its parent.
    pieces: Vec<(u32, u32)>,
    open: bool,
}

impl Edit<'_> {
    /// Returns the surface as edited so far.
    #[must_use]
    pub fn surface(&self) -> &Surface {
        self.surface
    }

    /// Adds a vertex. It is removed again if no triangle uses it at the end.
    ///
    /// Parents must have been used by triangles before this edit, or be earlier vertices of this
    /// edit. In the delta, the nearest parent of a created vertex without triangles stands for it.
    /// Channels of vertices are interpolated from parents.
    pub fn add_vertex(
        &mut self,
        position: [f32; 4],
        rest: [f32; 3],
        origin: VertexOrigin,
    ) -> VertexId {
        let surface = &mut *self.surface;
        let free = &mut surface.topology.free_vertices;
        let v = if let Some(v) = self.log.free_vertices.pop(free) {
            self.log
                .positions
                .set(&mut surface.positions, v.0, position);
            self.log.rest.set(&mut surface.rest, v.0, rest);
            v
        } else {
            let v = VertexId::from_index(surface.topology.vertex_slots());
            surface.topology.outgoing.push(HalfEdge::NULL);
            surface.positions.push(position);
            surface.rest.push(rest);
            v
        };
        self.vertices.push((v, origin));
        surface.history.step(Step::AddVertex, v.0);
        surface.history.floats(&position);
        surface.history.floats(&rest);
        self.interpolate_rows(v, &origin);
        v
    }

    /// Adds a vertex at `position` \[m\] with the rest position and inverse mass of its origin.
    ///
    /// See [`Self::add_vertex`].
    pub fn add_interpolated_vertex(&mut self, position: Vec3, origin: VertexOrigin) -> VertexId {
        let surface = self.surface();
        let rest = origin.interpolate(|v| surface.rest_positions()[v.index()]);
        let [w] = origin.interpolate(|v| [surface.positions()[v.index()][3]]);
        let [x, y, z] = to_f32(position);
        self.add_vertex([x, y, z, round_to_f32(w)], to_f32(rest.into()), origin)
    }

    /// Adds a triangle without neighbors, with zero corner attributes.
    ///
    /// Corners are vertices that triangles use or that this edit added. A new piece number comes
    /// from [`Self::new_piece`].
    ///
    /// # Panics
    /// If vertices repeat or have no slot.
    pub fn add_triangle(
        &mut self,
        corners: [VertexId; 3],
        piece: u32,
        material: u32,
    ) -> TriangleId {
        let [a, b, c] = corners;
        assert!(a != b && b != c && c != a, "a triangle of {corners:?}");
        let (surface, log) = (&mut *self.surface, &mut self.log);
        let topology = &mut surface.topology;
        let t = if let Some(t) = log.free_triangles.pop(&mut topology.free_triangles) {
            log.piece.set(&mut surface.piece, t.0, piece);
            log.material.set(&mut surface.material, t.0, material);
            for h in t.half_edges() {
                if h.index() < surface.corners.uv.len() {
                    log.uv.set(&mut surface.corners.uv, h.0, [0.0; 2]);
                }
                if h.index() < surface.corners.normal.len() {
                    log.normal.set(&mut surface.corners.normal, h.0, [0.0; 3]);
                }
            }
            for h in t.half_edges() {
                log.clear_corner_rows(&mut surface.channels, h);
            }
            t
        } else {
            let t = TriangleId::from_index(topology.triangle_slots());
            topology.origin.extend([VertexId::NULL; 3]);
            topology.twin.extend([HalfEdge::NULL; 3]);
            surface.piece.push(piece);
            surface.material.push(material);
            surface.corners.fit(topology.triangle_slots());
            fit_corners(&mut surface.channels, topology.triangle_slots());
            t
        };
        for (h, v) in t.half_edges().into_iter().zip(corners) {
            log.origin.set(&mut topology.origin, h.0, v);
            if topology.outgoing[v.index()].is_null() {
                log.outgoing.set(&mut topology.outgoing, v.0, h);
            }
        }
        surface.pieces.add(piece);
        surface.history.step(Step::AddTriangle, t.0);
        surface.history.pair(a.0, b.0);
        surface.history.pair(c.0, piece);
        surface.history.pair(material, 0);
        t
    }

    /// Frees a triangle, whose neighbors get boundaries there. The slot may be reused at once.
    ///
    /// # Panics
    /// If the slot is free.
    pub fn remove_triangle(&mut self, t: TriangleId) {
        assert!(self.surface.topology.is_triangle(t), "{t} is no triangle");
        for h in t.half_edges() {
            self.part(h);
            let origin = &mut self.surface.topology.origin;
            self.log.origin.set(origin, h.0, VertexId::NULL);
        }
        self.surface.topology.free_triangles.push(t);
        self.surface.pieces.remove(self.surface.piece[t.index()]);
        self.surface.history.step(Step::RemoveTriangle, t.0);
    }

    /// Moves the corner at `h` to vertex `v`.
    ///
    /// Neighbors do not change, so all corners of an edge must move, or be paired again.
    pub fn set_corner(&mut self, h: HalfEdge, v: VertexId) {
        let topology = &mut self.surface.topology;
        self.log.origin.set(&mut topology.origin, h.0, v);
        if topology.outgoing[v.index()].is_null() {
            self.log.outgoing.set(&mut topology.outgoing, v.0, h);
        }
        self.surface.history.step(Step::SetCorner, h.0);
        self.surface.history.pair(v.0, 0);
    }

    /// Makes two half-edges twins. Their former twins become boundaries.
    pub fn set_twins(&mut self, a: HalfEdge, b: HalfEdge) {
        let twins = [a, b].map(|h| self.surface.topology.twin(h));
        if twins != [b, a] {
            self.part(a);
            self.part(b);
            let twin = &mut self.surface.topology.twin;
            self.log.twin.set(twin, a.0, b);
            self.log.twin.set(twin, b.0, a);
        }
        self.surface.history.step(Step::Join, a.0);
        self.surface.history.pair(b.0, 0);
    }

    /// Makes a half-edge and its twin boundaries.
    pub fn open_edge(&mut self, h: HalfEdge) {
        self.part(h);
        self.surface.history.step(Step::OpenEdge, h.0);
    }

    /// Sets the texture coordinates of the corner at `h`, if the surface has any.
    pub fn set_uv(&mut self, h: HalfEdge, uv: [f32; 2]) {
        if h.index() < self.surface.corners.uv.len() {
            self.log.uv.set(&mut self.surface.corners.uv, h.0, uv);
            self.surface.history.step(Step::SetUv, h.0);
            self.surface.history.floats(&uv);
        }
    }

    /// Sets the shading normal of the corner at `h`, if the surface has any.
    pub fn set_normal(&mut self, h: HalfEdge, normal: [f32; 3]) {
        if h.index() < self.surface.corners.normal.len() {
            let normals = &mut self.surface.corners.normal;
            self.log.normal.set(normals, h.0, normal);
            self.surface.history.step(Step::SetNormal, h.0);
            self.surface.history.floats(&normal);
        }
    }

    /// Moves a triangle to another piece: an existing one or one from [`Self::new_piece`].
    ///
    /// # Panics
    /// If the slot is free.
    pub fn set_piece(&mut self, t: TriangleId, piece: u32) {
        let surface = &mut *self.surface;
        assert!(surface.topology.is_triangle(t), "{t} is no triangle");
        let old = surface.piece[t.index()];
        if old != piece {
            self.log.piece.set(&mut surface.piece, t.0, piece);
            surface.pieces.remove(old);
            surface.pieces.add(piece);
            surface.history.step(Step::SetPiece, t.0);
            surface.history.pair(piece, 0);
        }
    }

    /// Moves triangles to another piece, like [`Self::set_piece`].
    ///
    /// No slot may be free. Only debug builds check, because the check would double the time.
    pub fn set_pieces(&mut self, triangles: impl Iterator<Item = TriangleId> + Clone, piece: u32) {
        let surface = &mut *self.surface;
        let (topology, pieces) = (&surface.topology, &mut surface.piece);
        let mut current = triangles.clone().map(|t| pieces[t.index()]);
        let Some(from) = current.find(|&from| from != piece) else {
            return;
        };
        // New slots need no log, and triangles of other pieces are few.
        let known = self.log.piece.len();
        let mut others = Vec::new();
        let set = TriangleSet::new(triangles, known, |t| {
            debug_assert!(topology.is_triangle(t), "{t} is no triangle");
            let current = &mut pieces[t.index()];
            let is_simple = t.index() < known && *current == from;
            if is_simple {
                *current = piece;
            } else {
                others.push(t);
            }
            is_simple
        });
        if set.len() > 0 {
            surface.pieces.shift(from, piece, index_u32(set.len()));
            surface.history.pair(from, piece);
            set.words().for_each(|word| surface.history.word(word));
            self.log.move_pieces(set, from, piece);
        }
        for t in others {
            self.set_piece(t, piece);
        }
    }

    /// Adds triangles with their connectivity and zero corner attributes, and appends them to
    /// `out`.
    ///
    /// `twins[3 i + k]` is the twin of side k of triangle i in the same numbering, `u32::MAX` on
    /// the patch's boundary.
    ///
    /// # Panics
    /// If the lengths of `twins` or `pieces` do not match `corners`.
    pub fn add_patch(
        &mut self,
        corners: &[[VertexId; 3]],
        twins: &[u32],
        pieces: &[u32],
        material: u32,
        out: &mut Vec<TriangleId>,
    ) {
        assert_eq!(twins.len(), 3 * corners.len(), "one twin a half-edge");
        assert_eq!(pieces.len(), corners.len(), "one piece a triangle");
        let first = out.len();
        let reused = self
            .surface
            .topology
            .free_triangles
            .len()
            .min(corners.len());
        for (&triangle, &piece) in corners.iter().zip(pieces).take(reused) {
            out.push(self.add_triangle(triangle, piece, material));
        }
        self.append(&corners[reused..], &pieces[reused..], material, out);
        // In new slots, half-edges have the patch's order.
        let scattered = 3 * reused;
        let offset = out.get(first + reused).map_or(0, |t| 3 * t.index());
        let id = |h: usize| {
            if h < scattered {
                out[first + h / 3].half_edges()[h % 3].index()
            } else {
                offset + h - scattered
            }
        };
        let (surface, log) = (&mut *self.surface, &mut self.log);
        for (h, &twin) in twins
            .iter()
            .enumerate()
            .filter(|&(_, &twin)| twin != u32::MAX)
        {
            let (h, twin) = (
                HalfEdge::from_index(id(h)),
                HalfEdge::from_index(id(twin as usize)),
            );
            log.twin.set(&mut surface.topology.twin, h.0, twin);
        }
    }

    /// Adds triangles in new slots.
    fn append(
        &mut self,
        corners: &[[VertexId; 3]],
        pieces: &[u32],
        material: u32,
        out: &mut Vec<TriangleId>,
    ) {
        let (surface, log) = (&mut *self.surface, &mut self.log);
        let topology = &mut surface.topology;
        let first = topology.triangle_slots();
        topology.origin.extend(corners.iter().flatten());
        topology.twin.resize(topology.origin.len(), HalfEdge::NULL);
        surface.piece.extend_from_slice(pieces);
        surface.material.resize(first + corners.len(), material);
        surface.corners.fit(topology.triangle_slots());
        fit_corners(&mut surface.channels, topology.triangle_slots());
        for (i, triangle) in corners.iter().enumerate() {
            let [a, b, c] = *triangle;
            assert!(a != b && b != c && c != a, "a triangle of {triangle:?}");
            let t = TriangleId::from_index(first + i);
            out.push(t);
            for (h, v) in t.half_edges().into_iter().zip([a, b, c]) {
                if topology.outgoing[v.index()].is_null() {
                    log.outgoing.set(&mut topology.outgoing, v.0, h);
                }
            }
            surface.history.pair(a.0, b.0);
            surface.history.pair(c.0, material);
        }
        for run in pieces.chunk_by(|a, b| a == b) {
            let count = index_u32(run.len());
            surface.pieces.grow(run[0], count);
        }
    }

    /// Allocates a piece number for a part of piece `parent`. O(1).
    ///
    /// The delta lists it if a triangle has it at the end.
    pub fn new_piece(&mut self, parent: u32) -> u32 {
        let piece = self.surface.pieces.take_number();
        self.pieces.push((piece, parent));
        self.surface.history.step(Step::NewPiece, parent);
        piece
    }

    /// Unpairs `h` and its twin, if it has one.
    fn part(&mut self, h: HalfEdge) {
        let twin = &mut self.surface.topology.twin;
        let other = twin[h.index()];
        if !other.is_null() {
            self.log.twin.set(twin, other.0, HalfEdge::NULL);
            self.log.twin.set(twin, h.0, HalfEdge::NULL);
        }
    }
}

impl Drop for Edit<'_> {
    fn drop(&mut self) {
        if self.open {
            self.log.put_back(self.surface);
        }
    }
}
