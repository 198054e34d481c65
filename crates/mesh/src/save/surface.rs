//! [`SavedSurface`]: the arrays of a surface, for files.

use super::archive::{ArchiveError, FileKind, read_archive, write_archive};
use crate::history::History;
use crate::ids::{HalfEdge, TriangleId, VertexId};
use crate::pieces::Pieces;
use crate::surface::{Blend, Channel, CornerAttributes, Domain, InvalidSurface, Surface};
use crate::topology::Topology;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Piece numbers that a small surface may have in addition to four per triangle slot.
///
/// Arrays by piece number would otherwise take more memory than the file.
const EXTRA_PIECES: usize = 1 << 16;

/// The arrays of a [`Surface`], as they are saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SavedSurface<'a> {
    corners: Cow<'a, [VertexId]>,
    twins: Cow<'a, [HalfEdge]>,
    outgoing: Cow<'a, [HalfEdge]>,
    free_triangles: Cow<'a, [TriangleId]>,
    free_vertices: Cow<'a, [VertexId]>,
    positions: Cow<'a, [[f32; 4]]>,
    rest: Cow<'a, [[f32; 3]]>,
    origin: [f64; 3],
    uv: Cow<'a, [[f32; 2]]>,
    normal: Cow<'a, [[f32; 3]]>,
    channels: Vec<SavedChannel<'a>>,
    piece: Cow<'a, [u32]>,
    material: Cow<'a, [u32]>,
    piece_bound: u32,
    fingerprint: u64,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
struct SavedChannel<'a> {
    name: Cow<'a, str>,
    /// Whether it has a row per corner instead of per vertex.
    is_of_corners: bool,
    is_skin: bool,
    width: u32,
    values: Cow<'a, [f32]>,
}

impl Surface {
    /// Saves the surface as a file: all arrays, free slots and the history of edits.
    ///
    /// # Errors
    /// [`ArchiveError`] if [`Surface::load`] would refuse the file.
    pub fn save(&self) -> Result<Vec<u8>, ArchiveError> {
        write_archive(FileKind::Surface, &self.to_saved()?)
    }

    /// Loads a surface of [`Surface::save`].
    ///
    /// It equals the saved one, and later edits give the same bits.
    ///
    /// # Errors
    /// [`ArchiveError`].
    pub fn load(bytes: &[u8]) -> Result<Self, ArchiveError> {
        let saved: SavedSurface<'_> = read_archive(FileKind::Surface, bytes)?.content()?;
        saved.into_surface()
    }

    /// Returns the surface as plain data for a file.
    ///
    /// # Errors
    /// [`ArchiveError`] if [`SavedSurface::into_surface`] would refuse it.
    pub fn to_saved(&self) -> Result<SavedSurface<'_>, ArchiveError> {
        self.validate()?;
        check_piece_bound(self.piece_bound(), self.topology.triangle_slots())?;
        Ok(SavedSurface {
            corners: (&self.topology.origin).into(),
            twins: (&self.topology.twin).into(),
            outgoing: (&self.topology.outgoing).into(),
            free_triangles: (&self.topology.free_triangles).into(),
            free_vertices: (&self.topology.free_vertices).into(),
            positions: (&self.positions).into(),
            rest: (&self.rest).into(),
            origin: self.origin,
            uv: (&self.corners.uv).into(),
            normal: (&self.corners.normal).into(),
            channels: self.channels.iter().map(SavedChannel::new).collect(),
            piece: (&self.piece).into(),
            material: (&self.material).into(),
            piece_bound: self.piece_bound(),
            fingerprint: self.fingerprint(),
        })
    }
}

impl SavedSurface<'_> {
    /// Validates the arrays and returns their surface.
    ///
    /// # Errors
    /// [`ArchiveError::Surface`], [`ArchiveError::Channel`] and [`ArchiveError::PieceBound`].
    pub fn into_surface(self) -> Result<Surface, ArchiveError> {
        let mut surface = Surface {
            topology: Topology {
                origin: self.corners.into_owned(),
                twin: self.twins.into_owned(),
                outgoing: self.outgoing.into_owned(),
                free_triangles: self.free_triangles.into_owned(),
                free_vertices: self.free_vertices.into_owned(),
            },
            positions: self.positions.into_owned(),
            origin: self.origin,
            rest: self.rest.into_owned(),
            corners: CornerAttributes {
                uv: self.uv.into_owned(),
                normal: self.normal.into_owned(),
            },
            channels: Vec::new(),
            piece: self.piece.into_owned(),
            material: self.material.into_owned(),
            pieces: Pieces::default(),
            history: History::from_value(self.fingerprint),
            motion: 0,
        };
        for channel in self.channels {
            surface.set_channel(channel.into_channel()?)?;
        }
        surface.topology.validate().map_err(InvalidSurface::from)?;
        let (vertices, triangles) = (
            surface.topology.vertex_slots(),
            surface.topology.triangle_slots(),
        );
        check_piece_bound(self.piece_bound, triangles)?;
        surface.pieces = surface.counted_pieces();
        if surface.pieces.bound() > self.piece_bound {
            return Err(InvalidSurface::PieceCounts.into());
        }
        surface.pieces.set_bound(self.piece_bound);
        surface.validate()?;
        // A new stamp: no other surface of this process has these positions.
        let _ = surface.positions_mut();
        surface.reserve(vertices / 4, triangles / 4);
        Ok(surface)
    }
}

fn check_piece_bound(bound: u32, triangles: usize) -> Result<(), ArchiveError> {
    if bound as usize <= 4 * triangles + EXTRA_PIECES {
        Ok(())
    } else {
        Err(ArchiveError::PieceBound { bound, triangles })
    }
}

impl<'a> SavedChannel<'a> {
    fn new(channel: &'a Channel) -> Self {
        Self {
            name: channel.name().into(),
            is_of_corners: channel.domain() == Domain::Corner,
            is_skin: channel.blend() == Blend::Skin,
            width: crate::ids::index_u32(channel.width()),
            values: channel.values().into(),
        }
    }

    fn into_channel(self) -> Result<Channel, ArchiveError> {
        let domain = if self.is_of_corners {
            Domain::Corner
        } else {
            Domain::Vertex
        };
        let blend = if self.is_skin {
            Blend::Skin
        } else {
            Blend::Linear
        };
        let (width, values) = (self.width as usize, self.values.into_owned());
        Ok(Channel::new(&*self.name, domain, blend, width, values)?)
    }
}
