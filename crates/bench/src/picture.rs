//! Pictures as files.

use crate::output::{OutputError, OutputFile};
use std::path::Path;

/// Where a picture goes.
#[derive(Debug)]
pub(crate) struct PictureFile {
    svg: OutputFile,
}

impl PictureFile {
    /// Opens the file before there is anything to draw; it ends with `svg` in any case.
    ///
    /// # Errors
    /// As [`OutputFile::open`].
    pub(crate) fn open(path: &Path) -> Result<Self, OutputError> {
        Ok(Self {
            svg: OutputFile::open(&path.with_extension("svg"))?,
        })
    }

    /// Writes a picture, in the place of what was there.
    ///
    /// # Errors
    /// As [`OutputFile::write`].
    pub(crate) fn write(&mut self, svg: &str) -> Result<(), OutputError> {
        self.svg.write(svg)
    }
}
