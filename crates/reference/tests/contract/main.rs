//! Tests of the reference solver.

mod bending;
mod bodies;
mod common;
mod laws;
mod shipped;
mod volumes;
