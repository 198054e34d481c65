//! Paths in JSON.

use serde::Serializer;
use serde::ser::SerializeSeq;
use std::path::{Path, PathBuf};

/// A path as text. JSON has no other: what is not Unicode in it becomes U+FFFD, as on a terminal.
pub(crate) fn lossy<S: Serializer>(
    path: impl AsRef<Path>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&path.as_ref().to_string_lossy())
}

/// Paths as [`lossy`] text.
pub(crate) fn all_lossy<S: Serializer>(
    paths: &[PathBuf],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let mut list = serializer.serialize_seq(Some(paths.len()))?;
    for path in paths {
        list.serialize_element(&path.to_string_lossy())?;
    }
    list.end()
}
