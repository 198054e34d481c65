//! The benchmarks of incise: the paper's table, time, error, stability, and a report of all.

use std::process::ExitCode;

fn main() -> ExitCode {
    incise_bench::program()
}
