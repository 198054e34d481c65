//! Why the program stops.

use incise_mesh::{NotFit, ReadError};
use std::path::PathBuf;

/// Why a command could not be done.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// The input is not a mesh.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The input is no body that can be cut.
    #[error("{}: {source}", path.display())]
    NotFit {
        /// The file.
        path: PathBuf,
        /// Why.
        source: NotFit,
    },
    /// The standard output cannot be written to.
    #[error("standard output: {0}")]
    Output(#[from] std::io::Error),
}
