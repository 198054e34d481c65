//! Why a case could not be run to its end.

use incise_cut::CutError;
use incise_mesh::{TopologyError, UndoError};
use incise_pbd_gpu::{ConstraintError, StepError};
use incise_scene::SceneError;

/// Why a case could not be run to its end. Where its law allows none of these, that is a verdict.
#[derive(Debug, thiserror::Error)]
pub(super) enum Failure {
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
    /// The device's own.
    #[error("{0}")]
    Device(String),
    /// A law of the surface or of its constraints.
    #[error("{0}")]
    Law(String),
}

#[cfg(feature = "gpu")]
impl From<incise_pbd_gpu::GpuError> for Failure {
    fn from(error: incise_pbd_gpu::GpuError) -> Self {
        match error {
            incise_pbd_gpu::GpuError::Step(error) => Self::Step(error),
            other => Self::Device(other.to_string()),
        }
    }
}
