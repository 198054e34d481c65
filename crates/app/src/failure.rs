//! Why the program stops.

use incise_cut::CutError;
use incise_mesh::{NotFit, ReadError, WriteError};
use incise_scene::SceneError;
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
    /// The plane or the blade is none: the command line is wrong.
    #[error("the cut: {0}")]
    Sweep(CutError),
    /// The input cannot be cut there.
    #[error("{}: {source}", path.display())]
    Cut {
        /// The file.
        path: PathBuf,
        /// Why.
        source: CutError,
    },
    /// The body is to be cut when everything is over: the command line is wrong.
    #[error("--at is not before the end; raise --seconds")]
    CutAfterEnd,
    /// The body cannot be moved, or there is no device to move it.
    #[error("{}: {source}", path.display())]
    Scene {
        /// The file.
        path: PathBuf,
        /// Why.
        source: SceneError,
    },
    /// The output folder cannot be made.
    #[error("{}: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A piece would take the input's place.
    #[error("{}: a piece would overwrite the input; choose another folder", path.display())]
    TargetIsInput {
        /// The piece's file.
        path: PathBuf,
    },
    /// Where a piece is to go there is a folder.
    #[error("{}: a piece is to go here, and it is a folder; choose another output", path.display())]
    TargetIsFolder {
        /// The piece's file.
        path: PathBuf,
    },
    /// A piece cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The program was built without the feature `gpu`.
    #[cfg(not(feature = "gpu"))]
    #[error("this build has no GPU support; build it with the feature gpu")]
    NoGpuSupport,
    /// The standard output cannot be written to.
    #[error("standard output: {0}")]
    Output(#[from] std::io::Error),
}
