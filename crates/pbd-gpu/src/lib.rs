#![doc = include_str!("../README.md")]

mod constraints;
mod error;
mod follow;
#[cfg(feature = "gpu")]
mod gpu;
mod interior;
mod kernels;
mod mass;
mod material;
mod parallel;
mod particles;
mod patches;
mod rigid_frame;
mod solver;
mod step;

pub use constraints::attachments::LongRangeAttachment;
pub use constraints::batches::{Batch, BatchId, BendingSet, ConstraintSet, StretchSet};
pub use constraints::colliders::{Collider, MovingCollider};
pub use constraints::coloring::{LAYERS, MAX_COLORS};
pub use constraints::contacts::{
    Contact, ContactKind, ContactSet, FrictionAnchor, LoadRatio, SupportedSide,
};
pub use constraints::volumes::{PieceVolume, VolumeSet};
pub use error::{ConstraintError, InvalidConstraints, StepError};
#[cfg(feature = "serde")]
pub use error::{InvalidSolver, LoadError};
#[cfg(feature = "gpu")]
pub use gpu::{
    AdapterKind, AdapterLimits, AdapterRequest, AdapterSummary, Context, GpuBackend, GpuBody,
    GpuError, GpuMemory, GpuStats, Schedule, adapters,
};
pub use interior::SolidState;
pub use material::{Density, InteriorSprings, Material, Solid, Stiffness, Volume};
pub use particles::Pin;
pub use patches::{PATCH_VERTICES, PatchParams};
pub use solver::Solver;
pub use step::constants::{Projection, StepConstants, VolumeProjection};
pub use step::island::{Island, IslandBody, IslandError};
pub use step::params::{Integrator, SolverParams, StepStats};
pub use step::pass::{ConstraintKind, Pass};
pub use step::plan::StepPlan;
#[cfg(feature = "gpu")]
pub use wgpu;
