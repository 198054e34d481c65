//! Fuzz cases: a body with cuts, undos and deformations, decoded from bytes.
//!
//! After every step the invariants of `incise-tests` hold, and only sweeps that end inside the body
//! may fail.
#![forbid(unsafe_code)]
#![warn(missing_docs, clippy::missing_assert_message)]

mod case;
mod run;

pub use case::{Case, Step, SweepCase};
