//! Tests of the contract of this crate.

mod bits;
mod bvh;
mod patch;
mod refusals;
