//! Why a scene cannot go on.

use crate::body::BodyId;
use incise_mesh::UndoError;
use incise_pbd_gpu::{ConstraintError, StepError};

/// Why a scene cannot go on.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The body cannot be simulated, or its constraints cannot follow a cut.
    #[error("constraints: {0}")]
    Constraint(#[from] ConstraintError),
    /// The frame's parameters are out of range, or not for the device that bodies live on. Nothing has moved.
    #[error("the frame: {0}")]
    Frame(StepError),
    /// A number that says when bodies sleep is out of its range.
    #[error("sleep: {name} is {value}; give a finite number that is not negative")]
    BadSleep {
        /// Which number.
        name: &'static str,
        /// Its value.
        value: f32,
    },
    /// A cut cannot be taken back; nothing has changed.
    #[error("undo: {0}")]
    Undo(#[from] UndoError),
    /// A thickness that keeps nothing apart, or everything.
    #[error(
        "a thickness of contacts of {value} edges is not above 0 and at most {}",
        crate::ContactParams::THICKEST
    )]
    BadContacts {
        /// What was asked for.
        value: f32,
    },
    /// A body cannot be stepped.
    #[error("body {}: {error}", .body.0)]
    Step {
        /// The body.
        body: BodyId,
        /// Why.
        error: StepError,
    },
    /// The device cannot be had, or has failed. Bodies are where they were when they were last read;
    /// [`crate::Scene::fall_back`] goes on with them on the processor.
    #[cfg(feature = "gpu")]
    #[error("the scene's device: {0}")]
    Gpu(#[from] incise_pbd_gpu::GpuError),
    /// A device was asked for, and this build cannot use any.
    #[error(
        "this build has no backend for devices; build with the feature gpu, or choose the backend cpu or auto"
    )]
    NoGpuBackend,
}

impl SceneError {
    /// Whether the device is to blame, not a body.
    pub(crate) fn is_of_device(&self) -> bool {
        match self {
            #[cfg(feature = "gpu")]
            Self::Gpu(_) => true,
            _ => false,
        }
    }

    /// Whether the device has no room for a body, and is well otherwise.
    pub(crate) fn is_no_room(&self) -> bool {
        match self {
            #[cfg(feature = "gpu")]
            Self::Gpu(
                incise_pbd_gpu::GpuError::BufferTooLarge { .. }
                | incise_pbd_gpu::GpuError::OutOfMemory { .. },
            ) => true,
            _ => false,
        }
    }
}
