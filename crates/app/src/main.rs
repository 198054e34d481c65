//! The program `incise`.

use std::process::ExitCode;

fn main() -> ExitCode {
    incise_cli::program()
}
