//! Records the commit of the build, which every row of results names.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The crates of the program.
const CRATES: [&str; 11] = [
    "params",
    "mesh",
    "models",
    "reference",
    "refine",
    "cut",
    "paper",
    "pbd-gpu",
    "scene",
    "progress",
    "bench",
];

fn main() {
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default()).join("../..");
    let sources = CRATES.map(|name| format!("crates/{name}/src"));
    // A change of any of them recompiles the program; asking git costs little beside it.
    for source in &sources {
        println!("cargo::rerun-if-changed=../../{source}");
    }
    println!("cargo::rerun-if-changed=../../Cargo.lock");
    let commit = commit(&root, &sources).unwrap_or_else(|| "unknown".to_owned());
    println!("cargo::rustc-env=INCISE_COMMIT={commit}");
}

/// Returns the commit, marked for modified sources; none outside of a repository.
fn commit(root: &Path, sources: &[String]) -> Option<String> {
    // A copy without its history may lie in another repository.
    let top = git(root, &["rev-parse", "--show-toplevel"])?;
    if Path::new(&top).canonicalize().ok()? != root.canonicalize().ok()? {
        return None;
    }
    // A commit changes the log, if there is one: an absent file counts as a change in every build.
    let log = root.join(git(root, &["rev-parse", "--git-path", "logs/HEAD"])?);
    if log.exists() {
        println!("cargo::rerun-if-changed={}", log.display());
    }
    let mut commit = git(root, &["rev-parse", "--short=12", "HEAD"])?;
    let mut status = vec!["status", "--porcelain", "--", "Cargo.toml", "Cargo.lock"];
    status.extend(sources.iter().map(String::as_str));
    if !git(root, &status)?.is_empty() {
        commit.push_str("-dirty");
    }
    Some(commit)
}

/// Returns the output of git; none on an error.
fn git(root: &Path, arguments: &[&str]) -> Option<String> {
    // Other processes may use the repository.
    let answer = Command::new("git")
        .arg("--no-optional-locks")
        .arg("-C")
        .arg(root)
        .args(arguments)
        .output()
        .ok()?;
    let text = String::from_utf8(answer.stdout).ok()?;
    (answer.status.success()).then(|| text.trim().to_owned())
}
