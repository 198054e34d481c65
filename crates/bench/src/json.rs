//! Rows as JSON.

use serde::Serialize;
use std::path::Path;

/// Writes rows to a file, in the place of what was there.
pub(crate) fn write<T: Serialize>(path: &Path, rows: &[T]) -> Result<(), String> {
    let failed = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let mut text = serde_json::to_string_pretty(rows).map_err(|error| failed(&error))?;
    text.push('\n');
    std::fs::write(path, text).map_err(|error| failed(&error))
}
