//! Errors that end a stress case.

use incise_cut::CutError;
use incise_mesh::{TopologyError, UndoError};
use incise_pbd_gpu::{ConstraintError, StepError};
use incise_scene::SceneError;

/// An error that ends a run; where the invariant allows none, the case fails.
#[derive(Debug, thiserror::Error)]
pub(super) enum StressError {
    #[error(transparent)]
    Topology(#[from] TopologyError),
    #[error(transparent)]
    Constraint(#[from] ConstraintError),
    #[error(transparent)]
    Step(#[from] StepError),
    #[error(transparent)]
    Cut(#[from] CutError),
    #[error(transparent)]
    Undo(#[from] UndoError),
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// An error of the GPU.
    #[cfg(feature = "gpu")]
    #[error("{0}")]
    Device(String),
    /// An invariant of the surface or of its constraints.
    #[error("{0}")]
    Invariant(String),
}

#[cfg(feature = "gpu")]
impl From<incise_pbd_gpu::GpuError> for StressError {
    fn from(error: incise_pbd_gpu::GpuError) -> Self {
        match error {
            incise_pbd_gpu::GpuError::Step(error) => Self::Step(error),
            other => Self::Device(other.to_string()),
        }
    }
}
