//! Tests of the reference solver.

mod bending;
mod bodies;
mod common;
mod global;
mod laws;
mod shipped;
mod volumes;
