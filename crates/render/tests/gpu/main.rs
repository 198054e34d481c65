//! Tests of rendered images, on every adapter.

#![expect(
    clippy::missing_assert_message,
    reason = "these are tests, which the lint knows by an attribute only"
)]

mod common;
mod images;
mod overlays;
mod surfaces;

use std::process::ExitCode;

fn main() -> ExitCode {
    let files = [images::TESTS, overlays::TESTS, surfaces::TESTS];
    common::run(files.into_iter().flatten().copied())
}
