//! Tests across crates on the GPU.

#![expect(
    clippy::missing_assert_message,
    reason = "these are tests, which the lint knows by an attribute only"
)]

mod images;
mod models;

use std::process::ExitCode;

fn main() -> ExitCode {
    let files = [images::trials(), models::trials()];
    incise_test_support::gpu::run(files.into_iter().flatten().collect())
}
