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
//! How `examples/fill_hole.rs` begins:
//!
//! ```
//! use incise_mesh::geometry::{area_vector, corner_angles};
//! use incise_refine::{RefineParams, RefinementLevel, fill};
//! use nalgebra::Vector3;
//! use std::f64::consts::TAU;
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let angles = (0..60).map(|i| f64::from(i) * TAU / 60.0);
//!     let wave = |a: f64| Vector3::new(a.cos(), a.sin(), 0.1 * (2.0 * a).sin());
//!     let rim: Vec<_> = angles.map(wave).collect(); // counterclockwise seen from above
//!     let patch = fill(&rim, Vector3::z(), &RefineParams::default(), |_, _| false)?;
//!     assert_eq!(patch.points[..60], rim[..], "the rim stays, in its order");
//!     // and on
//! # Ok(())
//! }
//! ```
//!
//! [`fill_holes`] closes every hole of a surface, whatever the shape of its rim, with triangles of the
//! size of those around it, and as smoothly as it can if asked to.
//!
//! [`cover`] fills a whole cross-section in the plane: any number of loops, nested to any depth, with
//! a core of equilateral triangles and a band between it and the loops. It decides by exact signs,
//! so loops that touch or cross still give a manifold with exactly them as its boundary.
//!
//! ```
//! use incise_refine::{CoverParams, CoverScratch, CoverSize, Section, cover};
//!
//! let ring = |n: u32, radius: f64, turn: f64| {
//!     (0..n).map(move |i| {
//!         let a = turn * f64::from(i) * std::f64::consts::TAU / f64::from(n);
//!         [radius * a.cos(), radius * a.sin()]
//!     })
//! };
//! // A disc with a hole: the inside is on the left of both loops.
//! let points: Vec<_> = ring(60, 1.0, 1.0).chain(ring(30, 0.5, -1.0)).collect();
//! let loops = [(0..60).collect(), (60..90).collect()];
//! let section = Section { points: &points, loops: &loops, crease: false };
//! let params = CoverParams { size: CoverSize::Uniform(0.1), ..CoverParams::default() };
//! let cover = cover(&section, &params, |_, _| false, &mut CoverScratch::default())?;
//! cover.validate(&section, 1e-12)?;
//! // Euler's formula for a ring: as many triangles as points on the loops, and two for each inside.
//! assert_eq!(cover.triangles.len(), 90 + 2 * cover.inner.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cover;
mod edge_dictionary;
mod harmonic;
mod holes;
mod level;
mod patch;
mod refine;
mod swap;
mod triangulate;

pub use cover::{
    Cover, CoverFault, CoverParams, CoverQuality, CoverReport, CoverScratch, CoverSize, InnerPoint,
    Section, cover,
};
pub use harmonic::{Harmonic, HarmonicScratch, harmonic};
pub use holes::{Filled, FilledHole, HoleError, HoleParams, fill_hole, fill_holes};
pub use level::{ParseLevelError, RefinementLevel};
pub use patch::{Patch, RefineError, RefineMethod, RefineParams, RefineReport, fill};
pub use refine::{mean_rim_length, refine};
pub use triangulate::triangulate;
