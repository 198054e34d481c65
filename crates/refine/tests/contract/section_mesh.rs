//! Section meshes: invariants of all of them, quality, and cases with a known answer.

mod cases;
mod properties;
mod quality;
mod sections;
mod sizes;
