//! Saving and loading of surfaces.

use super::archive::{ArchiveError, FileKind, read_archive, write_archive};
use crate::surface::{Channel, ChannelError, InvalidSurface, Surface};

/// Piece numbers that a small surface may have in addition to four per triangle slot.
///
/// Arrays by piece number would otherwise take more memory than the file.
const EXTRA_PIECES: usize = 1 << 16;

impl Surface {
    /// Saves the surface as a file: all arrays, free slots and the history of edits.
    ///
    /// # Errors
    /// [`ArchiveError`] if [`Surface::load`] would refuse the file.
    pub fn save(&self) -> Result<Vec<u8>, ArchiveError> {
        self.check_save()?;
        write_archive(FileKind::Surface, self)
    }

    /// Loads a surface of [`Surface::save`].
    ///
    /// It equals the saved one, and later edits give the same bits.
    ///
    /// # Errors
    /// [`ArchiveError`].
    pub fn load(bytes: &[u8]) -> Result<Self, ArchiveError> {
        let mut surface: Self = read_archive(FileKind::Surface, bytes)?.content()?;
        surface.finish_load()?;
        Ok(surface)
    }

    /// Checks a surface before it is written as a part of a file.
    ///
    /// # Errors
    /// [`ArchiveError`] if [`Self::finish_load`] would refuse the surface.
    pub fn check_save(&self) -> Result<(), ArchiveError> {
        self.validate()?;
        self.check_piece_bound()
    }

    /// Completes and validates a surface that was read with serde.
    ///
    /// # Errors
    /// [`ArchiveError::Surface`], [`ArchiveError::Channel`] and [`ArchiveError::PieceBound`].
    pub fn finish_load(&mut self) -> Result<(), ArchiveError> {
        self.topology.validate().map_err(InvalidSurface::from)?;
        check_channels(&self.channels)?;
        self.check_piece_bound()?;
        let mut pieces = self.counted_pieces();
        if pieces.bound() > self.pieces.bound() {
            return Err(InvalidSurface::PieceCounts.into());
        }
        pieces.set_bound(self.pieces.bound());
        self.pieces = pieces;
        self.validate()?;
        // A new stamp: no other surface of this process has these positions.
        let _ = self.positions_mut();
        let topology = &self.topology;
        let (vertices, triangles) = (topology.vertex_slots(), topology.triangle_slots());
        self.reserve(vertices / 4, triangles / 4);
        Ok(())
    }

    fn check_piece_bound(&self) -> Result<(), ArchiveError> {
        let (bound, triangles) = (self.piece_bound(), self.topology.triangle_slots());
        if bound as usize <= 4 * triangles + EXTRA_PIECES {
            Ok(())
        } else {
            Err(ArchiveError::PieceBound { bound, triangles })
        }
    }
}

/// Checks that channels have allowed widths and different names.
fn check_channels(channels: &[Channel]) -> Result<(), ChannelError> {
    for channel in channels {
        channel.check_width()?;
    }
    let mut names: Vec<&str> = channels.iter().map(Channel::name).collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(ChannelError::Repeated {
            name: pair[0].into(),
        }),
        None => Ok(()),
    }
}
