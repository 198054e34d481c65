//! [`SceneError`]: errors of a scene's methods, and [`FallbackReason`] of a scene on the CPU.

use crate::blade::BladeId;
use crate::body::BodyId;
use incise_cut::CutError;
use incise_mesh::{ChannelError, UndoError, VertexId};
use incise_params::OutOfRange;
use incise_pbd_gpu::{ConstraintError, StepError};

/// An error of a scene's method.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The id belongs to another scene, or the body was removed.
    #[error("body {body} is not in this scene; use an id that add_body of this scene returned")]
    UnknownBody {
        /// The id.
        body: BodyId,
    },
    /// The id belongs to another scene.
    #[error("blade {blade} is not in this scene; use an id that add_blade of this scene returned")]
    UnknownBlade {
        /// The id.
        blade: BladeId,
    },
    /// A blade's face was set to a vector that is not finite. The face is unchanged.
    #[error(
        "The face of blade {blade} is not finite. Give the vector from edge to back in meters."
    )]
    BladeFaceNotFinite {
        /// The blade.
        blade: BladeId,
    },
    /// The edge of a blade is not finite. The blade is unchanged.
    #[error("the edge of the blade has the coordinate {value}; give two finite points in meters")]
    BladeNotFinite {
        /// The first such coordinate \[m\].
        value: f32,
    },
    /// The origin or direction of a ray is not finite.
    #[error("the {name} of the ray has the coordinate {value}; give finite numbers in meters")]
    RayNotFinite {
        /// `origin` or `direction`.
        name: &'static str,
        /// The first such coordinate \[m\].
        value: f64,
    },
    /// The body cannot be simulated, or its constraints cannot follow a cut.
    #[error("constraints: {0}")]
    Constraint(#[from] ConstraintError),
    /// A substep is too short, or a parameter is not supported on the GPU. Nothing has moved.
    #[error("invalid frame: {0}")]
    Frame(StepError),
    /// A parameter is out of range. Nothing has moved.
    #[error(transparent)]
    Parameter(#[from] OutOfRange),
    /// A sweep or a cut is refused.
    #[error("cuts: {0}")]
    Cut(CutError),
    /// A cut cannot be undone; nothing has changed.
    #[error("undo: {0}")]
    Undo(#[from] UndoError),
    /// An undo stack has no cut of the body.
    #[error("body {body} has no cut to undo")]
    NothingToUndo {
        /// The body.
        body: BodyId,
    },
    /// An edit set a position that is not finite.
    #[error(
        "the position of vertex {vertex} of body {body} was set to NaN or infinity; set a finite \
         one with Scene::edit, or remove the body"
    )]
    PositionNotFinite {
        /// The body.
        body: BodyId,
        /// The first such vertex.
        vertex: VertexId,
    },
    /// An edit changed the triangles of a body's surface.
    #[error(
        "the triangles of body {body} were edited through Body::solver_mut, so its constraints do \
         not match; remove the body and add the edited surface as a new one"
    )]
    TopologyEdited {
        /// The body.
        body: BodyId,
    },
    /// A list of bodies to join is empty.
    #[error("there is no body to join; name at least one")]
    NothingToJoin,
    /// Bodies cannot be joined.
    #[error("body {body} cannot be joined: {reason}")]
    CannotJoin {
        /// The body.
        body: BodyId,
        /// The reason.
        reason: &'static str,
    },
    /// The surfaces of bodies cannot be joined.
    #[error("surfaces: {0}")]
    Channel(#[from] ChannelError),
    /// A body cannot be stepped.
    #[error("body {body}: {error}")]
    Step {
        /// The body.
        body: BodyId,
        /// The reason.
        error: StepError,
    },
    /// The GPU is not available or has failed.
    ///
    /// Bodies are where they were at their last readback; [`crate::Scene::fall_back`] continues
    /// with them on the CPU.
    #[cfg(feature = "gpu")]
    #[error("the scene's GPU: {0}")]
    Gpu(#[from] incise_pbd_gpu::GpuError),
    /// A GPU was requested in a build without GPU support.
    #[error(
        "this build has no GPU backend; build with the feature gpu, or choose the backend cpu or \
         auto"
    )]
    NoGpuBackend,
}

impl SceneError {
    /// Returns whether the GPU failed, not a body.
    pub(crate) fn is_gpu_failure(&self) -> bool {
        match self {
            #[cfg(feature = "gpu")]
            Self::Gpu(_) => true,
            _ => false,
        }
    }

    /// Returns whether the GPU has no memory for a body and works otherwise.
    pub(crate) fn is_out_of_gpu_memory(&self) -> bool {
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

/// The reason why the CPU steps bodies of a scene that was to use a GPU.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FallbackReason {
    /// There is no GPU, it has no memory for a body, or it failed.
    #[error("{0}")]
    Error(#[from] SceneError),
    /// The only adapter computes on the CPU.
    #[error("{adapter} computes on the CPU; the CPU solver is faster")]
    SoftwareAdapter {
        /// The adapter's name.
        adapter: String,
    },
    /// The GPU was slower than the CPU at every size that was measured.
    #[error("{adapter} was slower than the CPU at every size that was measured")]
    SlowerThanCpu {
        /// The adapter's name.
        adapter: String,
    },
    /// [`crate::Scene::fall_back`] was called.
    #[error("requested by Scene::fall_back")]
    Requested,
}
