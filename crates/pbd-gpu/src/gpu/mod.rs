//! Stepping on any device that wgpu reaches.

mod adapter;
mod context;
mod error;
mod layout;
mod shaders;

pub use adapter::{AdapterKind, AdapterLimits, AdapterRequest, AdapterSummary, adapters};
pub use context::Context;
pub use error::GpuError;
