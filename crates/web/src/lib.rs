#![doc = include_str!("../README.md")]

mod arguments;
mod colliders;
mod error;
mod flat_arrays;
mod memory_views;
mod mesh;
mod report;
mod scene;

pub use error::WebError;
pub use mesh::Mesh;
pub use report::MeshReport;
pub use scene::{Incision, IncisionState, Pick, Scene};
