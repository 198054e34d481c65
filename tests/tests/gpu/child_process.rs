//! Processes of this program that call one function instead of running tests.

use crate::device::processes::{exhaust, no_adapters};
use std::process::{Command, ExitCode};

/// Environment variable with the name of the function.
const KEY: &str = "INCISE_TEST_CHILD";

/// The function of a process that runs no tests.
type Function = fn() -> ExitCode;

/// The functions by name.
const FUNCTIONS: [(&str, Function); 3] = [
    ("exhaust", exhaust),
    ("incise", incise_cli::program),
    ("no_adapters", no_adapters),
];

/// Returns a command that starts this program.
pub(crate) fn this_program() -> Command {
    Command::new(std::env::current_exe().expect("the path of this program"))
}

/// Returns a command that calls a function in a process of its own.
pub(crate) fn child(name: &str) -> Command {
    let mut command = this_program();
    command.env(KEY, name);
    command
}

/// Calls the function that this process was started for; `None` if it is to run tests.
pub(crate) fn call() -> Option<ExitCode> {
    let name = std::env::var(KEY).ok()?;
    let (_, function) = FUNCTIONS.iter().find(|(known, _)| *known == name)?;
    Some(function())
}
