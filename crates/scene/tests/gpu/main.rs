//! Tests of the contract of this crate, on the GPU.

#![expect(
    clippy::missing_assert_message,
    reason = "these are tests, which the lint knows by an attribute only"
)]

mod backend;
mod common;
mod scenes;
mod sleep;

use std::process::ExitCode;

fn main() -> ExitCode {
    let files = [backend::trials(), scenes::trials(), sleep::trials()];
    incise_test_support::gpu::run(files.into_iter().flatten().collect())
}
