//! Saving and loading of surfaces, and the file format that scenes share.
//!
//! The types of a state implement `Serialize` and `Deserialize` themselves. Scratch memory and
//! fields that follow from others are skipped. A method `finish_load` makes these again and
//! validates everything that code relies on, so a file cannot break an invariant.
//!
//! **Versions.** [`FORMAT_VERSION`] is the version of the layout: of all saved fields, their types
//! and their order. A change of the layout needs a new version; there are no conversions. So a file
//! is read by programs of its version. Others refuse it and name both versions and the program that
//! wrote it. A test of `incise-scene` compares the layout with that of stored files, see
//! `crates/scene/tests/contract/save.rs`.

mod archive;
mod surface;

pub use archive::{
    Archive, ArchiveError, FORMAT_VERSION, FileKind, ProgramVersion, read_archive, write_archive,
};
