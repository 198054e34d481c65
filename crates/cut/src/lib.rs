//! Cuts a triangle surface with the sweep of a blade.
//!
//! A blade's edge in two frames spans a [`Sweep`] of two triangles. A [`Bvh`] finds the triangles
//! near it, exact signs tell which edges it crosses, and a [`CutMethod`] opens the surface there,
//! closes both lips and separates the pieces. The change comes back as an
//! [`incise_mesh::TopologyDelta`], which solvers and renderers follow. A [`Journal`] keeps cuts to do
//! them again.
//!
//! ```
//! use incise_cut::{CutParams, Cutter, Sweep};
//! use incise_mesh::Surface;
//!
//! let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
//! let mut body = Surface::from_triangles(&corners, &faces)?;
//! let sweep = Sweep::across_box([1.0, 0.1, 0.0], 0.4, &body.bounds())?;
//! let outcome = Cutter::new(&body).cut(&mut body, &sweep, &CutParams::default())?;
//! assert_eq!(outcome.delta.pieces_added.len(), 1);
//! assert!(body.topology().is_closed());
//! # Ok::<(), Box<dyn std::error::Error>>(())
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
