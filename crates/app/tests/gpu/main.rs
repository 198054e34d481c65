//! Tests of images that the program draws on the GPU.

#![expect(
    clippy::missing_assert_message,
    reason = "these are tests, which the lint knows by an attribute only"
)]

#[path = "../common/mod.rs"]
mod common;
mod gallery;
mod image;
mod render;
mod simulate;

use std::process::ExitCode;

fn main() -> ExitCode {
    let files = [gallery::trials(), render::trials(), simulate::trials()];
    incise_test_support::gpu::run(files.into_iter().flatten().collect())
}
