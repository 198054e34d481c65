//! Images that the program `incise` draws.

pub(crate) mod gallery;
mod image;
pub(crate) mod render;
pub(crate) mod simulate;

use crate::child_process::child;
use std::path::Path;
use std::process::{Command, Output};

/// Returns a command that starts the program.
fn program() -> Command {
    child("incise")
}

/// Runs the program.
fn incise(arguments: &[&str]) -> Output {
    program().args(arguments).output().expect("it runs")
}

/// Returns a path as an argument.
fn text(path: &Path) -> &str {
    path.to_str().expect("a name without odd characters")
}
