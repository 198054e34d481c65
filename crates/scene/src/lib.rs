#![doc = include_str!("../README.md")]

mod backend;
mod blade;
mod body;
mod colliders;
mod contacts;
mod error;
mod find_contacts;
mod follow_cut;
mod frame;
mod gpu_bodies;
mod interior_springs;
mod islands;
mod join_split;
mod params;
mod piece_shapes;
mod render_buffers;
mod residency;
#[cfg(feature = "serde")]
mod save;
mod scene;
mod sleep;
mod stats;
mod undo_stack;

pub use backend::{BackendChoice, BackendReport, BackendRequest};
pub use blade::{Blade, BladeId, BladeMode};
pub use body::{Body, BodyId};
pub use contacts::ContactParams;
pub use error::{FallbackReason, SceneError};
pub use follow_cut::follow_cut;
pub use params::SceneParams;
pub use render_buffers::BufferChange;
pub use residency::Residency;
#[cfg(feature = "serde")]
pub use save::{LoadError, SaveError};
pub use scene::{FailedCut, Scene, SweepResult};
pub use sleep::SleepParams;
pub use stats::FrameStats;
pub use undo_stack::UndoStack;

/// The example of the README, compiled and run with the documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
