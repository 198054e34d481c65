//! [`SavedVolumes`]: the volume constraints of a body, for files.

use super::{PieceVolume, Spoke, VolumeSet};
use crate::constraints::validate::broken;
use crate::error::InvalidConstraints;
use incise_mesh::{HalfEdge, Surface, Topology, VertexId, index_u32};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A [`VolumeSet`], as it is saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct SavedVolumes<'a> {
    pieces: Vec<SavedPiece>,
    /// The vertices of all pieces, one piece after another.
    vertices: Vec<VertexId>,
    lambda: Cow<'a, [f32]>,
}

/// See [`PieceVolume`].
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct SavedPiece {
    piece: u32,
    rest: f32,
    reach: f32,
    vertices: u32,
}

impl VolumeSet {
    /// Returns the constraints as plain data for a file.
    pub(crate) fn to_saved(&self) -> SavedVolumes<'_> {
        let saved = |piece: &PieceVolume| SavedPiece {
            piece: piece.piece,
            rest: piece.rest,
            reach: piece.reach,
            vertices: index_u32(piece.vertices()),
        };
        SavedVolumes {
            pieces: self.pieces.iter().map(saved).collect(),
            vertices: self.spokes.iter().map(|spoke| spoke.vertex).collect(),
            lambda: (&self.lambda).into(),
        }
    }

    /// Returns saved constraints of a surface.
    ///
    /// # Errors
    /// [`InvalidConstraints`] unless pieces ascend, have closed fans, and share no vertex.
    pub(crate) fn from_saved(
        saved: SavedVolumes<'_>,
        surface: &Surface,
    ) -> Result<Self, InvalidConstraints> {
        let topology = surface.topology();
        let mut set = Self {
            lambda: saved.lambda.into_owned(),
            ..Self::default()
        };
        let mut first = 0;
        for &SavedPiece {
            piece,
            rest,
            reach,
            vertices,
        } in &saved.pieces
        {
            let end = first + vertices as usize;
            let is_next = set.pieces.last().is_none_or(|last| last.piece < piece);
            let of_piece = saved.vertices.get(first..end).unwrap_or_default();
            let is_own = |&v: &VertexId| {
                let h = topology.outgoing(v);
                !h.is_null() && surface.piece(h.triangle()) == piece && is_closed(topology, h)
            };
            // Ascending vertices of different pieces are all different.
            let is_valid = is_next
                && !of_piece.is_empty()
                && rest.is_normal()
                && reach.is_normal()
                && of_piece.is_sorted_by(|a, b| a < b)
                && of_piece.iter().all(is_own);
            if !is_valid {
                return broken("volumes are those of closed pieces", None);
            }
            let spoke = |&vertex: &VertexId| Spoke::new(vertex, topology.outgoing(vertex));
            set.spokes.extend(of_piece.iter().map(spoke));
            set.pieces.push(PieceVolume {
                piece,
                rest,
                reach,
                first,
                end,
            });
            first = end;
        }
        let is_finite = set.lambda.iter().all(|lambda| lambda.is_finite());
        if first != saved.vertices.len() || set.lambda.len() != set.pieces.len() || !is_finite {
            return broken("a piece has vertices and one multiplier", None);
        }
        set.displacements.resize(set.pieces.len(), [0.0; 3]);
        set.find_rings(topology);
        Ok(set)
    }
}

/// Returns whether the triangles around the origin of `first` form a closed fan.
fn is_closed(topology: &Topology, first: HalfEdge) -> bool {
    let mut at = first;
    loop {
        at = topology.twin(at.prev());
        if at.is_null() || at == first {
            return at == first;
        }
    }
}
