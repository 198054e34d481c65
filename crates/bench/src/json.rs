//! Rows as JSON.

use crate::output::{OutputError, OutputFile};
use serde::Serialize;
use std::path::Path;

/// The file of `--json`, if there is one.
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

    /// Writes rows, in the place of those that were written before.
    ///
    /// # Errors
    /// As [`OutputFile::write`].
    pub(crate) fn write<T: Serialize>(&mut self, rows: &[T]) -> Result<(), OutputError> {
        let Some(file) = &mut self.0 else {
            return Ok(());
        };
        let text = serde_json::to_string_pretty(rows);
        let mut text = text.map_err(|fault| file.lost(fault.into()))?;
        text.push('\n');
        file.write(text)
    }
}
