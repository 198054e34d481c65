#![doc = include_str!("../README.md")]

mod cutting;
pub mod exports;
mod handles;
mod memory;
mod mesh;
pub mod params;
mod simulation;
mod status;

pub use cutting::CutResult;
pub use handles::incise_live_handles;
pub use mesh::Mesh;
pub use simulation::Scene;
pub use status::{
    INCISE_ABI_VERSION, Status, incise_abi_version, incise_last_error, incise_version,
};
