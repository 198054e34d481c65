//! Stress tests of the solver: inputs and motions that break solvers, with the invariant that each
//! must keep.
//!
//! [`crate::stability`] has scenes, and cases that take minutes or fail today.
#![allow(
    clippy::cast_possible_truncation,
    clippy::missing_panics_doc,
    missing_debug_implementations,
    reason = "tests: positions as they are stored, and panics where an invariant fails"
)]

mod motions;
mod runner;
mod shapes;
mod volumes;

pub use runner::{Body, Case, Runner, ball, largest_offset};

/// Returns all stress tests with their names.
pub fn cases() -> impl Iterator<Item = Case> {
    let all: [&[Case]; 3] = [&shapes::CASES, &motions::CASES, &volumes::CASES];
    all.into_iter().flatten().copied()
}
