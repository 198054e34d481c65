//! Cuts a triangle surface with the sweep of a blade.
//!
//! A blade's edge in two frames spans a [`Sweep`] of two triangles. A [`Bvh`] finds the triangles
//! near it, exact signs tell which edges it crosses, and a [`CutMethod`] opens the surface there,
//! closes both lips and separates the pieces. The change comes back as an
//! [`incise_mesh::TopologyDelta`], which solvers and renderers follow. A [`Journal`] keeps cuts to do
//! them again.
//!
//! How `examples/slice_sphere.rs` begins:
//!
//! ```
//! use incise_cut::{CutParams, Cutter, Sweep};
//! use incise_mesh::{cube_sphere, write_obj};
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let mut body = cube_sphere(16, 0.5);
//!     let mut cutter = Cutter::new(&body);
//!     let plane = Sweep::across_box([0.0, 1.0, 0.2], 0.1, &body.bounds())?; // a blade larger than the body
//!     let outcome = cutter.cut(&mut body, &plane, &CutParams::default())?;
//!     println!("{} cap triangles", outcome.cap.len());
//!     assert_eq!(body.piece_volumes().len(), 2, "two pieces");
//!     assert!(body.topology().is_closed(), "both lips are closed");
//!     // and on
//! # Ok(())
//! }
//! ```

mod bvh;
mod cutter;
mod error;
mod exact;
mod inside;
mod journal;
mod params;
mod rebuild;
mod sweep;

pub use bvh::{Bvh, InvalidBvh, NearestPoint, NodeReaches, RayHit};
pub use cutter::{CutOutcome, CutReport, Cutter};
pub use error::CutError;
pub use inside::starts_inside;
pub use journal::{Journal, ReplayError};
pub use params::{CutMethod, CutParams};
pub use sweep::Sweep;
