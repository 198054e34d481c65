//! The file format of saved states: a header of 32 bytes, then the content in `postcard`.
//!
//! | bytes | content |
//! |---|---|
//! | 0 to 7 | `\x89incise\n` |
//! | 8 to 11 | [`FileKind`] |
//! | 12 to 15 | version |
//! | 16 to 23 | length of the content |
//! | 24 to 27 | CRC-32 of bytes 0 to 23 and of the content |
//! | 28 to 31 | zero |
//!
//! All numbers of the header are little-endian.

use crate::bvh::InvalidBvh;
use crate::surface::{ChannelError, InvalidSurface};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// The version of the format. Files of other versions are refused.
pub const FORMAT_VERSION: u32 = 2;

const MAGIC: [u8; 8] = *b"\x89incise\n";
const HEADER: usize = 32;
/// The bytes before the checksum.
const CHECKED: usize = 24;

/// The content of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum FileKind {
    /// A surface.
    Surface,
    /// A body: a surface and its solver.
    Body,
    /// A scene.
    Scene,
}

impl FileKind {
    const fn tag(self) -> [u8; 4] {
        match self {
            Self::Surface => *b"SURF",
            Self::Body => *b"BODY",
            Self::Scene => *b"SCEN",
        }
    }
}

/// An error of saving or loading a state.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ArchiveError {
    /// The file is not one of this format.
    #[error("this is no file of a saved surface, body or scene; load one that incise has saved")]
    UnknownFormat,
    /// The file has another content.
    #[error("the file has no {expected:?}; load it as what it was saved from")]
    WrongKind {
        /// The requested content.
        expected: FileKind,
    },
    /// The file is of another version.
    #[error("the file has version {version}; this program reads version {FORMAT_VERSION}")]
    UnknownVersion {
        /// The version of the file.
        version: u32,
    },
    /// The file has another length than it was saved with.
    #[error("the content has {found} bytes instead of {expected}; the file is incomplete")]
    WrongLength {
        /// The saved length.
        expected: u64,
        /// The length of the file.
        found: u64,
    },
    /// The content was changed since it was saved.
    #[error("the checksum of the file is wrong: its content is damaged")]
    WrongChecksum,
    /// The content is not of the format.
    #[error("the content of the file does not have the format of its version")]
    Malformed,
    /// A file needs a feature that this build does not have.
    #[error("the file needs the feature {feature}, which this build does not have")]
    MissingFeature {
        /// The name of the feature.
        feature: &'static str,
    },
    /// A surface is invalid.
    #[error("surface: {0}")]
    Surface(#[from] InvalidSurface),
    /// A channel is invalid.
    #[error(transparent)]
    Channel(#[from] ChannelError),
    /// The upper bound of piece numbers is too high for the number of triangles.
    #[error("piece numbers up to {bound} for {triangles} triangles; renumber the pieces")]
    PieceBound {
        /// The upper bound of piece numbers, exclusive.
        bound: u32,
        /// Number of triangle slots.
        triangles: usize,
    },
    /// A BVH is invalid.
    #[error("BVH: {0}")]
    Bvh(#[from] InvalidBvh),
}

/// The content of a file with a valid header and checksum.
#[derive(Debug, Clone, Copy)]
pub struct Archive<'a> {
    version: u32,
    content: &'a [u8],
}

/// Writes a header and a content.
///
/// # Errors
/// [`ArchiveError::Malformed`] if a `Serialize` implementation fails; that of no `Saved` type does.
pub fn write_archive(kind: FileKind, content: &impl Serialize) -> Result<Vec<u8>, ArchiveError> {
    let header = vec![0; HEADER];
    let written = postcard::to_extend(content, header);
    let mut bytes: Vec<u8> = written.map_err(|_| ArchiveError::Malformed)?;
    let length = (bytes.len() - HEADER) as u64;
    bytes[..8].copy_from_slice(&MAGIC);
    bytes[8..12].copy_from_slice(&kind.tag());
    bytes[12..16].copy_from_slice(&FORMAT_VERSION.to_le_bytes());
    bytes[16..24].copy_from_slice(&length.to_le_bytes());
    let sum = checksum(&bytes);
    bytes[24..28].copy_from_slice(&sum.to_le_bytes());
    Ok(bytes)
}

/// Reads the header of a file and validates its length and checksum.
///
/// # Errors
/// [`ArchiveError`] with the first part of the header that does not fit.
pub fn read_archive(kind: FileKind, bytes: &[u8]) -> Result<Archive<'_>, ArchiveError> {
    let Some((header, content)) = bytes.split_first_chunk::<HEADER>() else {
        return Err(ArchiveError::UnknownFormat);
    };
    if header[..8] != MAGIC || header[28..] != [0; 4] {
        return Err(ArchiveError::UnknownFormat);
    }
    if header[8..12] != kind.tag() {
        return Err(ArchiveError::WrongKind { expected: kind });
    }
    let number = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| header[at + i]));
    let version = number(12);
    if version != FORMAT_VERSION {
        return Err(ArchiveError::UnknownVersion { version });
    }
    let expected = u64::from_le_bytes(std::array::from_fn(|i| header[16 + i]));
    let found = content.len() as u64;
    if found != expected {
        return Err(ArchiveError::WrongLength { expected, found });
    }
    if number(24) != checksum(bytes) {
        return Err(ArchiveError::WrongChecksum);
    }
    Ok(Archive { version, content })
}

/// Returns the checksum of a file of at least the length of a header.
fn checksum(bytes: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&bytes[..CHECKED]);
    hasher.update(&bytes[HEADER..]);
    hasher.finalize()
}

impl Archive<'_> {
    /// Returns the version of the file.
    #[must_use]
    pub fn version(&self) -> u32 {
        self.version
    }

    /// Decodes the first part of the content, for example a flag that decides about the others.
    ///
    /// # Errors
    /// [`ArchiveError::Malformed`].
    pub fn first<T: DeserializeOwned>(&self) -> Result<T, ArchiveError> {
        let decoded = postcard::take_from_bytes(self.content);
        decoded.map_or(Err(ArchiveError::Malformed), |(first, _)| Ok(first))
    }

    /// Decodes the content, which must be of the file's version.
    ///
    /// Memory is proportional to the length of the file.
    ///
    /// # Errors
    /// [`ArchiveError::Malformed`].
    pub fn content<T: DeserializeOwned>(&self) -> Result<T, ArchiveError> {
        match postcard::take_from_bytes(self.content) {
            Ok((content, [])) => Ok(content),
            _ => Err(ArchiveError::Malformed),
        }
    }
}
