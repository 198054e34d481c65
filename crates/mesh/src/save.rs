//! Saving and loading of surfaces, and the file format that scenes share.
//!
//! A `Saved` type is the content of a file as plain data, apart from the structures in memory.
//! [`SavedSurface`] and [`SavedBvh`] are those of this crate; the solver, the cutter and the scene
//! have their own. They implement `Serialize` and `Deserialize`. Loading validates everything that
//! code relies on, so a file cannot break an invariant.
//!
//! **Versions.** A change of any `Saved` type, or of a type within one, needs a new
//! [`FORMAT_VERSION`]. Files of other versions are refused.

mod archive;
mod surface;

pub use crate::bvh::SavedBvh;
pub use archive::{Archive, ArchiveError, FORMAT_VERSION, FileKind, read_archive, write_archive};
pub use surface::SavedSurface;
