//! Validation of a surface: the invariants that every edit keeps.
//!
//! Tests, benches and the fuzz target call [`Surface::validate`] or [`Surface::validate_closed`]
//! after every edit.

use super::Surface;
use crate::ids::{HalfEdge, VertexId};
use crate::pieces::Pieces;
use crate::topology::InvalidTopology;

/// A broken invariant of a [`Surface`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidSurface {
    /// The corner table is inconsistent.
    #[error(transparent)]
    Topology(#[from] InvalidTopology),
    /// An array has the wrong length.
    #[error("the array {array} has {found} entries for {expected} slots")]
    ArrayLength {
        /// Name of the array.
        array: &'static str,
        /// Number of slots.
        expected: usize,
        /// Length of the array.
        found: usize,
    },
    /// A coordinate or an inverse mass of a vertex in use is not finite.
    #[error("{vertex} has a value in {array} that is not finite")]
    NotFinite {
        /// The vertex.
        vertex: VertexId,
        /// Name of the array.
        array: &'static str,
    },
    /// The stored triangle count of some piece, or the piece bound, is wrong.
    #[error("the stored triangle counts of pieces differ from the pieces of triangles")]
    PieceCounts,
    /// An edge of a closed surface has only one triangle.
    #[error("the surface is open at {half_edge}")]
    Open {
        /// A half-edge without a twin.
        half_edge: HalfEdge,
    },
    /// Two half-edges have the same origin and target.
    #[error("two half-edges run from {a} to {b}")]
    RepeatedEdge {
        /// The origin.
        a: VertexId,
        /// The target.
        b: VertexId,
    },
    /// The triangles around a vertex do not form one fan of at least three.
    #[error("the {triangles} triangles around {vertex} are not one closed fan of three or more")]
    Fan {
        /// The vertex.
        vertex: VertexId,
        /// Number of triangles at the vertex.
        triangles: usize,
    },
    /// A piece is not exactly one connected component.
    #[error("piece {piece} is not exactly one connected component")]
    PieceComponents {
        /// The piece.
        piece: u32,
    },
}

impl Surface {
    /// Checks every invariant that an edit keeps. O(n log p) for p pieces.
    ///
    /// - The corner table is valid: twins have opposite directions, `outgoing` starts at its
    ///   vertex, free slots are listed once (see
    ///   [`Topology::validate`](crate::Topology::validate)).
    /// - Every array has the length of its slots.
    /// - Positions, rest positions and inverse masses of vertices in use are finite.
    /// - Triangle counts of pieces are correct.
    ///
    /// Boundaries and vertices with several fans are allowed.
    ///
    /// # Errors
    /// The first broken invariant.
    pub fn validate(&self) -> Result<(), InvalidSurface> {
        self.topology.validate()?;
        let (vertices, triangles) = (self.topology.vertex_slots(), self.topology.triangle_slots());
        let optional = |length: usize| if length == 0 { 0 } else { 3 * triangles };
        let (uvs, normals) = (self.corners.uv.len(), self.corners.normal.len());
        for (array, expected, found) in [
            ("positions", vertices, self.positions.len()),
            ("rest positions", vertices, self.rest.len()),
            ("pieces", triangles, self.piece.len()),
            ("materials", triangles, self.material.len()),
            ("corner uvs", optional(uvs), uvs),
            ("corner normals", optional(normals), normals),
        ] {
            if expected != found {
                return Err(InvalidSurface::ArrayLength {
                    array,
                    expected,
                    found,
                });
            }
        }
        for channel in &self.channels {
            let expected = self.slots(channel.domain()) * channel.width();
            let found = channel.values.len();
            if expected != found {
                return Err(InvalidSurface::ArrayLength {
                    array: "channels",
                    expected,
                    found,
                });
            }
        }
        for vertex in self.topology.vertices() {
            let (position, rest) = (self.positions[vertex.index()], self.rest[vertex.index()]);
            let arrays = [("positions", &position[..]), ("rest positions", &rest[..])];
            for (array, values) in arrays {
                if !values.iter().all(|x| x.is_finite()) {
                    return Err(InvalidSurface::NotFinite { vertex, array });
                }
            }
        }
        let mut pieces = self.counted_pieces();
        if pieces.bound() > self.pieces.bound() {
            return Err(InvalidSurface::PieceCounts);
        }
        pieces.set_bound(self.pieces.bound());
        if pieces != self.pieces {
            return Err(InvalidSurface::PieceCounts);
        }
        Ok(())
    }

    /// Counts the triangles of every piece. Triangles without a piece number are not counted.
    pub(crate) fn counted_pieces(&self) -> Pieces {
        let mut pieces = Pieces::default();
        for t in self.topology.triangles() {
            if let Some(&piece) = self.piece.get(t.index()) {
                pieces.add(piece);
            }
        }
        pieces
    }

    /// Checks [`Self::validate`] and that the surface is a closed manifold of whole pieces.
    ///
    /// Every edge has two triangles and is the only one between its vertices. The triangles around
    /// a vertex form one fan of at least three. Every piece is one connected component. O(n log n).
    ///
    /// # Errors
    /// The first broken invariant.
    pub fn validate_closed(&self) -> Result<(), InvalidSurface> {
        self.validate()?;
        let topology = &self.topology;
        let mut valence = vec![0; topology.vertex_slots()];
        let mut directed = Vec::with_capacity(3 * topology.triangle_count());
        for half_edge in topology.triangles().flat_map(|t| t.half_edges()) {
            if topology.twin(half_edge).is_null() {
                return Err(InvalidSurface::Open { half_edge });
            }
            valence[topology.origin(half_edge).index()] += 1;
            directed.push((topology.origin(half_edge), topology.target(half_edge)));
        }
        // Twins have opposite directions, so unique directions mean unique edges.
        directed.sort_unstable();
        if let Some(pair) = directed.windows(2).find(|pair| pair[0] == pair[1]) {
            let (a, b) = pair[0];
            return Err(InvalidSurface::RepeatedEdge { a, b });
        }
        for vertex in topology.vertices() {
            let triangles = valence[vertex.index()];
            if triangles < 3 || topology.outgoing_fan(vertex).count() != triangles {
                return Err(InvalidSurface::Fan { vertex, triangles });
            }
        }
        self.validate_components()
    }

    /// Checks that pieces are the connected components.
    fn validate_components(&self) -> Result<(), InvalidSurface> {
        let labels = self.topology.component_labels();
        let pairs = |t: crate::ids::TriangleId| (self.piece(t), labels[t.index()]);
        let mut pairs: Vec<(u32, u32)> = self.topology.triangles().map(pairs).collect();
        for by_component in [false, true] {
            pairs.sort_unstable_by_key(|&(piece, label)| {
                if by_component {
                    (label, piece)
                } else {
                    (piece, label)
                }
            });
            pairs.dedup();
            let key = |pair: &(u32, u32)| if by_component { pair.1 } else { pair.0 };
            if let Some(twice) = pairs.windows(2).find(|w| key(&w[0]) == key(&w[1])) {
                let piece = twice[0].0;
                return Err(InvalidSurface::PieceComponents { piece });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::InvalidSurface;
    use crate::ids::TriangleId;
    use crate::shapes::icosphere;

    #[test]
    fn each_broken_invariant_is_found() {
        let whole = icosphere(1, 1.0);
        whole.validate_closed().unwrap();
        let mut open = whole.clone();
        open.remove_triangles(&[TriangleId(3)]);
        open.validate().unwrap();
        assert!(matches!(
            open.validate_closed(),
            Err(InvalidSurface::Open { .. })
        ));
        let mut infinite = whole.clone();
        infinite.rest_positions_mut()[5][1] = f32::INFINITY;
        assert!(matches!(
            infinite.validate(),
            Err(InvalidSurface::NotFinite { .. })
        ));
        let mut short = whole.clone();
        short.positions.pop();
        assert!(matches!(
            short.validate(),
            Err(InvalidSurface::ArrayLength { .. })
        ));
        let mut miscounted = whole.clone();
        miscounted.pieces.add(0);
        assert_eq!(miscounted.validate(), Err(InvalidSurface::PieceCounts));
        let mut split = whole.clone();
        split.set_piece(TriangleId(0), 1);
        split.validate().unwrap();
        let error = InvalidSurface::PieceComponents { piece: 0 };
        assert_eq!(split.validate_closed(), Err(error));
    }
}
