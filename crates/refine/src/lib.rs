//! A rim in, a triangulated and refined patch out.
//!
//! A hole in a surface is closed in two steps, which are also public on their own: [`triangulate`]
//! covers the rim's polygon with its vertices alone (the paper's Algorithm A2), [`refine`] inserts
//! vertices and swaps edges until the triangles are as long as the rim's edges times z (Algorithms
//! 4 and A3, Formulas 1 and 2). [`fill`] does both.
//!
//! The paper is "Cutting Simulation in Unity 3D Using Position Based Dynamics with Various
//! Refinement Levels", Applied Sciences 2022.
//!
//! ```
//! use incise_refine::{RefineParams, RefinementLevel, fill};
//! use nalgebra::Vector3;
//!
//! let rim: Vec<_> = (0..24)
//!     .map(|i| f64::from(i) * std::f64::consts::TAU / 24.0)
//!     .map(|a| Vector3::new(a.cos(), a.sin(), 0.0))
//!     .collect();
//! let params = RefineParams { level: RefinementLevel::Original, ..RefineParams::default() };
//! let patch = fill(&rim, Vector3::z(), &params, |_, _| false)?;
//! assert_eq!(&patch.points[..24], &rim[..]);
//! assert_eq!(patch.triangles.len(), 24 - 2 + 2 * patch.inner.len());
//! # Ok::<(), incise_refine::RefineError>(())
//! ```

mod cover;
mod edge_dictionary;
mod level;
mod patch;
mod refine;
mod swap;
mod triangulate;

pub use cover::{
    Cover, CoverFault, CoverParams, CoverReport, CoverScratch, InnerPoint, Section, cover,
};
pub use level::{ParseLevelError, RefinementLevel};
pub use patch::{Patch, RefineError, RefineParams, RefineReport, fill};
pub use refine::{mean_rim_length, refine};
pub use triangulate::triangulate;
