//! Why there is no page.

use crate::output::OutputError;
use crate::picture::PictureError;
use std::path::PathBuf;

/// What can go wrong between results and a page.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PageError {
    /// A file of results or of the gallery cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file is not the JSON that it should be.
    #[error("{}: {source}", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// Where, and what was expected.
        source: serde_json::Error,
    },
    /// A table of cells does not have the numbers that it should have.
    #[error("{}: line {line} has no {column}, or it is no number", path.display())]
    Cell {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The column's name.
        column: &'static str,
    },
    /// A file has no rows.
    #[error("{}: there are no rows in it; name the file of a run that has ended", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// A file's rows are those of no bench that the page shows.
    #[error(
        "{}: its rows are none of {}",
        path.display(),
        super::rows::NAMES.join(", ")
    )]
    Unknown {
        /// The file.
        path: PathBuf,
    },
    /// The index of a gallery names a file that is not in its folder.
    #[error("{}: names '{file}', which is not a file's name", path.display())]
    Outside {
        /// The index.
        path: PathBuf,
        /// What it names.
        file: String,
    },
    /// A picture of a gallery is none.
    #[error("{}: is no PNG", path.display())]
    NoPng {
        /// The file.
        path: PathBuf,
    },
    /// A chart does not come about.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The page cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}
