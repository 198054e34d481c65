//! Tests of the contract of this crate, on the GPU.

#![expect(
    clippy::missing_assert_message,
    reason = "these are tests, which the lint knows by an attribute only"
)]

mod bodies;
mod closed_forms;
mod contacts;
mod deltas;
mod errors;
mod kernels;
mod matches_cpu;
mod motion;
mod pipelines;
mod timestamps;

use std::process::ExitCode;

fn main() -> ExitCode {
    let files = [
        bodies::trials(),
        closed_forms::trials(),
        contacts::trials(),
        deltas::trials(),
        errors::trials(),
        kernels::trials(),
        matches_cpu::trials(),
        motion::trials(),
        pipelines::trials(),
        timestamps::trials(),
    ];
    incise_test_support::gpu::run(files.into_iter().flatten().collect())
}
