//! Why a scene cannot go on.

use crate::body::BodyId;
use incise_pbd_gpu::{ConstraintError, StepError};

/// Why a scene cannot go on.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The body cannot be simulated, or its constraints cannot follow a cut.
    #[error("constraints: {0}")]
    Constraint(#[from] ConstraintError),
    /// A body cannot be stepped.
    #[error("body {}: {error}", .body.0)]
    Step {
        /// The body.
        body: BodyId,
        /// Why.
        error: StepError,
    },
}
