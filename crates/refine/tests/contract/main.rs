//! Tests of the contract of this crate.

mod harmonic;
mod holes;
mod section_mesh;
