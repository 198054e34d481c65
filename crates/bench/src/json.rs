//! Rows as JSON files.

use crate::output::{OutputError, OutputFile};
use serde::{Deserialize, Deserializer, Serialize};
use std::path::Path;

/// The file of `--json`, if any.
#[derive(Debug)]
pub(crate) struct Json(Option<OutputFile>);

impl Json {
    /// Opens the file, before anything is measured.
    ///
    /// # Errors
    /// As [`OutputFile::open`].
    pub(crate) fn open(path: Option<&Path>) -> Result<Self, OutputError> {
        Ok(Self(path.map(OutputFile::open).transpose()?))
    }

    /// Writes rows; they replace those written before.
    ///
    /// # Errors
    /// As [`OutputFile::write`].
    pub(crate) fn write<T: Serialize>(&mut self, rows: &[T]) -> Result<(), OutputError> {
        let Some(file) = &mut self.0 else {
            return Ok(());
        };
        let text = serde_json::to_string_pretty(rows);
        let mut text = text.map_err(|source| file.lost(source.into()))?;
        text.push('\n');
        file.write(text)
    }
}

/// Reads a number; `null` stands for one that is not finite and becomes NaN.
pub(crate) fn nan_if_null<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::NAN))
}
