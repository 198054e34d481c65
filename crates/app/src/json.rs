//! Paths in JSON.

use serde::Serializer;
use std::path::Path;

/// A path as text. JSON has no other: what is not Unicode in it becomes U+FFFD, as on a terminal.
pub(crate) fn lossy<S: Serializer>(
    path: impl AsRef<Path>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&path.as_ref().to_string_lossy())
}
