//! Position based dynamics of triangle surfaces.
//!
//! A [`Solver`] moves one [`Surface`](incise_mesh::Surface): it keeps edges at their lengths, angles
//! between triangles at theirs and closed pieces at their volume, in Gauss-Seidel order by color, and follows edits through their
//! [`TopologyDelta`](incise_mesh::TopologyDelta). A [`StepPlan`] is the step as a list; a [`Backend`]
//! executes it.
//!
//! Units are SI and the y axis points up. The result has the same bits on any number of threads.
//!
//! ```
//! use incise_mesh::Surface;
//! use incise_pbd_gpu::{Material, Solver, SolverParams};
//!
//! let corners = [[0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 2.0, 0.0], [0.0, 1.0, 1.0]];
//! let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
//! let mut body = Surface::from_triangles(&corners, &faces)?;
//! let mut solver = Solver::new(&mut body, &Material::default())?;
//! let params = SolverParams { ground: Some(0.0), ..SolverParams::default() };
//! for _ in 0..120 {
//!     solver.step(&mut body, 1.0 / 60.0, &params)?;
//! }
//! assert!(body.bounds().min[1].abs() < 1e-3, "it lies on the ground");
//! assert!(solver.stretch_error(&body) < 0.01, "it has kept its shape");
//! # Ok::<(), Box<dyn std::error::Error>>(())
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
