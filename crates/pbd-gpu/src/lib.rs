//! Position based dynamics of triangle surfaces.
//!
//! A [`Solver`] moves one [`Surface`](incise_mesh::Surface): it keeps edges at their lengths, angles
//! between triangles at theirs and closed pieces at their volume, in Gauss-Seidel order by color, and follows edits through their
//! [`TopologyDelta`](incise_mesh::TopologyDelta). A [`StepPlan`] is the step as a list; a [`Backend`]
//! executes it.
//!
//! Units are SI and the y axis points up. The result has the same bits on any number of threads.
//!
//! How `examples/drop_icosahedron.rs` begins:
//!
//! ```
//! use incise_mesh::icosphere;
//! use incise_pbd_gpu::{Density, Material, Solver, SolverParams};
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let mut body = icosphere(0, 0.5);
//!     let mut solver = Solver::new(&mut body, &Material::default())?;
//!     let params = SolverParams {
//!         ground: Some(-2.0),
//!         ..SolverParams::default()
//!     };
//!     solver.step(&mut body, 1.0 / 60.0, &params)?; // a frame
//!     // and on
//! # Ok(())
//! }
//! ```

mod backend;
mod changes;
mod colliders;
mod coloring;
#[cfg(test)]
#[path = "../tests/common/mod.rs"]
mod common;
mod concerned;
mod constraints;
mod contacts;
mod delta;
mod edges;
mod error;
#[cfg(feature = "gpu")]
mod gpu;
mod inherit;
mod keepsake;
mod kernels;
mod mass;
mod material;
mod missing;
mod momentum;
mod params;
mod patches;
mod plan;
mod prepare;
mod rest;
mod second_order;
mod solver;
mod state;
mod struts;
mod sweep;
mod tethers;
mod validate;
mod volumes;

pub use backend::{Backend, CpuBackend};
pub use colliders::Collider;
pub use coloring::{LAYERS, MAX_COLORS};
pub use constraints::{Batch, BendingSet, ConstraintSet, StretchSet};
pub use contacts::{Above, Contact, ContactSet};
pub use error::{ConstraintError, InvalidConstraints, StepError};
#[cfg(feature = "gpu")]
pub use gpu::{
    AdapterKind, AdapterLimits, AdapterRequest, AdapterSummary, Context, GpuBackend, GpuBody,
    GpuError, GpuMemory, GpuStats, Schedule, adapters,
};
pub use material::{Density, Material, Projection, Stiffness, Struts, Volume, VolumeProjection};
pub use params::{Integrator, SolverParams, StepStats};
pub use patches::{PATCH_VERTICES, PatchParams};
pub use plan::{Body, Pass, Pin, StepConstants, StepPlan};
pub use solver::Solver;
pub use tethers::Tether;
pub use volumes::{PieceVolume, VolumeSet};
#[cfg(feature = "gpu")]
pub use wgpu;
