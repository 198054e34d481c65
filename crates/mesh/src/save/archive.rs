//! The file format of saved states: a header of 32 bytes, then the content in `postcard`.
//!
//! | bytes | content |
//! |---|---|
//! | 0 to 7 | `\x89incise\n` |
//! | 8 to 11 | [`FileKind`] |
//! | 12 to 15 | version |
//! | 16 to 23 | length of the content |
//! | 24 to 27 | CRC-32 of all other bytes |
//! | 28 to 31 | [`ProgramVersion`] |
//!
//! All numbers of the header are little-endian.

use crate::bvh::InvalidBvh;
use crate::surface::{ChannelError, InvalidSurface};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt;
use std::ops::Range;

/// The version of the layout of files. [`read_archive`] refuses every other one.
pub const FORMAT_VERSION: u32 = 9;

const MAGIC: [u8; 8] = *b"\x89incise\n";
const HEADER: usize = 32;
/// The bytes of the checksum.
const CHECKSUM: Range<usize> = 24..28;

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

/// The version of the program that wrote a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ProgramVersion([u8; 4]);

impl ProgramVersion {
    /// The version of this program.
    const PRESENT: Self = Self([
        number(env!("CARGO_PKG_VERSION_MAJOR")),
        number(env!("CARGO_PKG_VERSION_MINOR")),
        number(env!("CARGO_PKG_VERSION_PATCH")),
        0,
    ]);
}

impl fmt::Display for ProgramVersion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            // Format version 1 does not have it.
            [0, 0, 0, _] => f.write_str("an earlier incise"),
            [major, minor, patch, _] => write!(f, "incise {major}.{minor}.{patch}"),
        }
    }
}

/// Returns a part of a version; 255 is the maximum.
const fn number(text: &str) -> u8 {
    match u8::from_str_radix(text, 10) {
        Ok(number) => number,
        Err(_) => u8::MAX,
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
    /// The file has another format version than [`FORMAT_VERSION`].
    #[error(
        "the file has format version {version} and this program reads version {FORMAT_VERSION}; \
         load it with {program}, which wrote it"
    )]
    UnknownVersion {
        /// The format version of the file.
        version: u32,
        /// The program that wrote the file.
        program: ProgramVersion,
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
    content: &'a [u8],
}

/// Writes a header and a content.
///
/// # Errors
/// [`ArchiveError::Malformed`] if a `Serialize` implementation fails; that of no state does.
pub fn write_archive(kind: FileKind, content: &impl Serialize) -> Result<Vec<u8>, ArchiveError> {
    let header = vec![0; HEADER];
    let written = postcard::to_extend(content, header);
    let mut bytes: Vec<u8> = written.map_err(|_| ArchiveError::Malformed)?;
    let length = (bytes.len() - HEADER) as u64;
    bytes[..8].copy_from_slice(&MAGIC);
    bytes[8..12].copy_from_slice(&kind.tag());
    bytes[12..16].copy_from_slice(&FORMAT_VERSION.to_le_bytes());
    bytes[16..24].copy_from_slice(&length.to_le_bytes());
    bytes[28..32].copy_from_slice(&ProgramVersion::PRESENT.0);
    let sum = checksum(&bytes);
    bytes[CHECKSUM].copy_from_slice(&sum.to_le_bytes());
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
    if header[..8] != MAGIC {
        return Err(ArchiveError::UnknownFormat);
    }
    if header[8..12] != kind.tag() {
        return Err(ArchiveError::WrongKind { expected: kind });
    }
    let number = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| header[at + i]));
    let version = number(12);
    if version != FORMAT_VERSION {
        let program = ProgramVersion(std::array::from_fn(|i| header[28 + i]));
        return Err(ArchiveError::UnknownVersion { version, program });
    }
    let expected = u64::from_le_bytes(std::array::from_fn(|i| header[16 + i]));
    let found = content.len() as u64;
    if found != expected {
        return Err(ArchiveError::WrongLength { expected, found });
    }
    if number(24) != checksum(bytes) {
        return Err(ArchiveError::WrongChecksum);
    }
    Ok(Archive { content })
}

/// Returns the checksum of a file of at least the length of a header.
fn checksum(bytes: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&bytes[..CHECKSUM.start]);
    hasher.update(&bytes[CHECKSUM.end..]);
    hasher.finalize()
}

impl Archive<'_> {
    /// Decodes the content.
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
