//! Errors of the report.

use super::sources::NAMES;
use crate::output::OutputError;
use crate::picture::PictureError;
use std::path::PathBuf;

/// An error of reading results or of writing the report.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ReportError {
    /// A file cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// A file is not the expected JSON.
    #[error("{}: {source}", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// The parser's error.
        source: serde_json::Error,
    },
    /// A file is not the expected CSV.
    #[error("{}: {source}", path.display())]
    Csv {
        /// The file.
        path: PathBuf,
        /// The parser's error.
        source: csv::Error,
    },
    /// A file has no rows of a bench.
    #[error("{}: has no rows of {}", path.display(), NAMES.join(", "))]
    NoRows {
        /// The file.
        path: PathBuf,
    },
    /// No file has rows.
    #[error("none of the files has rows; name files that --json or --plot wrote")]
    NothingTaken,
    /// The index of a gallery names a file outside of its folder.
    #[error("{}: names '{file}', which is not a file's name", path.display())]
    Outside {
        /// The index.
        path: PathBuf,
        /// The name.
        file: String,
    },
    /// An image of a gallery is not a PNG.
    #[error("{}: is not a PNG", path.display())]
    NoPng {
        /// The file.
        path: PathBuf,
    },
    /// A chart cannot be drawn.
    #[error(transparent)]
    Image(#[from] PictureError),
    /// The report cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

impl ReportError {
    /// Returns whether a file was read but has no rows.
    pub(super) fn is_other_file(&self) -> bool {
        matches!(
            self,
            Self::Json { .. } | Self::Csv { .. } | Self::NoRows { .. }
        )
    }
}
