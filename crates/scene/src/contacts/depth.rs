//! Depth of the points of a piece in another one, for [overlaps](super::overlaps).

use super::motion::Motion;
use super::narrow_phase::{MARGIN, Search};
use super::outside::outward_normal;
use super::overlaps::PieceId;
use crate::body::Body;
use incise_mesh::{HalfEdge, Surface, Vec3, VertexId};

/// Number of vertices per piece at whose other [points](points_at) an overlap is measured.
const MEASURED: usize = 50;

/// Returns about `count` vertices of a piece, evenly spaced; the offset rotates with the search.
fn sampled(
    vertices: &[VertexId],
    (count, search): (usize, usize),
) -> impl Iterator<Item = VertexId> {
    let stride = (vertices.len() / count).max(1);
    vertices
        .iter()
        .skip(search % stride)
        .step_by(stride)
        .copied()
}

/// Returns a point at each of about `count` vertices of a piece, which rotate with the search.
pub(super) fn sampled_points(
    surface: &Surface,
    vertices: &[VertexId],
    (count, search): (usize, usize),
) -> impl Iterator<Item = Point> {
    // After a full cycle over the vertices, their next sample points follow.
    let turn = search / (vertices.len() / count).max(1);
    sampled(vertices, (count, search)).filter_map(move |v| {
        let points = points_at(surface, v).count();
        points_at(surface, v).nth(turn % points)
    })
}

/// A point of a piece that is tested.
#[derive(Debug, Clone, Copy)]
pub(super) enum Point {
    Vertex(VertexId),
    /// The middle of an edge.
    Middle(HalfEdge),
    /// A point below a vertex.
    Below(VertexId),
}

impl Point {
    /// Returns the position of a point; of one below a vertex that of the vertex \[m\].
    pub(super) fn position(self, surface: &Surface) -> Vec3 {
        match self {
            Self::Vertex(v) | Self::Below(v) => surface.position(v),
            Self::Middle(h) => {
                let topology = surface.topology();
                let ends = [topology.origin(h), topology.target(h)];
                let [a, b] = ends.map(|v| surface.position(v));
                (a + b) / 2.0
            }
        }
    }
}

/// Returns the points at a vertex: itself, one below it, and the middles of edges that begin there,
/// each edge at one end.
fn points_at(surface: &Surface, v: VertexId) -> impl Iterator<Item = Point> {
    let topology = surface.topology();
    let edges = topology.outgoing_fan(v);
    let edges = edges.filter(move |&h| topology.target(h) > v);
    let of_vertex = [Point::Vertex(v), Point::Below(v)];
    of_vertex.into_iter().chain(edges.map(Point::Middle))
}

impl Search<'_> {
    /// Returns the body of a piece and its motion.
    pub(super) fn body_of(&self, piece: PieceId) -> Option<(&Body, &Motion)> {
        let body = self.bodies.get(piece.body as usize)?.as_ref()?;
        let is_known = piece.number < body.surface().piece_bound();
        let motion = &self.motions[piece.body as usize];
        (is_known && motion.is_active).then_some((body, motion))
    }

    /// Returns the index of a piece in the broad phase, if it takes part.
    fn index_of(&self, piece: PieceId) -> Option<u32> {
        let (_, motion) = self.body_of(piece)?;
        let index = motion.pieces[piece.number as usize];
        (index != u32::MAX).then_some(index)
    }

    /// Returns the vertices of a piece, ascending.
    pub(super) fn vertices(&self, piece: PieceId) -> &[VertexId] {
        let index = self.index_of(piece);
        index.map_or(&[], |index| self.pieces.vertices(index))
    }

    /// Returns the minimum distance of two solid pieces \[m\]; `None` for sheets and cavities.
    fn thickness_of(&self, pieces: [PieceId; 2]) -> Option<f64> {
        let mut least = f64::INFINITY;
        for piece in pieces {
            let (body, motion) = self.body_of(piece)?;
            let shape = body.piece_shapes().get(piece.number);
            if shape.is_sheet || shape.is_cavity {
                return None;
            }
            least = least.min(motion.piece_thickness(piece.number));
        }
        Some(least)
    }

    /// Returns the shortest way out of the second piece from a point of the first one \[m\].
    ///
    /// The first piece is displaced by `shift` \[m\]. `None` outside and where contacts act.
    pub(super) fn way_out(&self, pair: [PieceId; 2], point: Point, shift: Vec3) -> Option<Vec3> {
        let surface = self.body_of(pair[0])?.0.surface();
        let at = point.position(surface);
        let clearance = MARGIN * self.thickness_of(pair)?;
        let Point::Below(v) = point else {
            return self.way_out_from(pair[1], at + shift, clearance);
        };
        // Coincident bodies have all of their vertices on each other.
        let inward = -outward_normal(surface, v).try_normalize(0.0)?;
        let below = at + inward * (2.0 * clearance);
        let way = self.way_out_from(pair[1], below + shift, clearance)?;
        let in_own = self.way_out_from(pair[0], below, clearance);
        in_own.map(|_| way)
    }

    /// Returns the way from a point in a piece to its surface \[m\].
    ///
    /// `None` outside of it and on ways shorter than `clearance`. Its cavities are outside, and so
    /// is the space around a part that is inside out.
    fn way_out_from(&self, other: PieceId, at: Vec3, clearance: f64) -> Option<Vec3> {
        let (body, motion) = self.body_of(other)?;
        let (surface, bvh, shapes) = (body.surface(), body.bvh(), body.piece_shapes());
        let counts = |piece| piece == other.number || shapes.get(piece).is_cavity;
        if bvh.winding_number(surface, at, |t| counts(surface.piece(t))) < 1 {
            return None;
        }
        let nearest = bvh.nearest_of_pieces(surface, at, &motion.bounds, counts)?;
        Some(nearest.point - at).filter(|way| way.norm() >= clearance)
    }

    /// Returns ways out of the second piece from deep points of the first one \[m\].
    ///
    /// The first piece is displaced by `shift` \[m\]. All vertices are tested. A search samples
    /// vertices at which it also tests other points. `None` for pieces that do not take part.
    pub(super) fn ways_out(
        &self,
        pieces: [PieceId; 2],
        search: usize,
        shift: Vec3,
    ) -> Option<impl Iterator<Item = Vec3>> {
        let surface = self.body_of(pieces[0])?.0.surface();
        let other = self.pieces.get(self.index_of(pieces[1])?);
        let vertices = self.vertices(pieces[0]);
        let sampled = sampled(vertices, (MEASURED, search));
        let points = sampled.flat_map(move |v| points_at(surface, v));
        let points = points.chain(vertices.iter().copied().map(Point::Vertex));
        let inside =
            points.filter(move |point| other.contains(point.position(surface) + shift, 0.0));
        Some(inside.filter_map(move |point| self.way_out(pieces, point, shift)))
    }
}
