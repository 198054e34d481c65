//! Records the commit of the build, which every row of results names.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The crates of the program.
const CRATES: [&str; 7] = [
    "mesh", "refine", "cut", "pbd-gpu", "render", "scene", "bench",
];

fn main() {
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default()).join("../..");
    let sources = sources();
    // A change of any of them recompiles the program; asking git costs little beside it.
    for source in &sources {
        tell("rerun-if-changed", &root.join(source).display().to_string());
    }
    let commit = commit(&root, &sources).unwrap_or_else(|| "unknown".to_owned());
    tell("rustc-env", &format!("INCISE_COMMIT={commit}"));
}

/// Returns the sources of the program; other files of the workspace do not change it.
fn sources() -> Vec<String> {
    let of_crate = |name| ["src", "Cargo.toml"].map(|part| format!("crates/{name}/{part}"));
    let shared = ["Cargo.toml", "Cargo.lock", "crates/bench/build.rs"];
    let shared = shared.into_iter().map(str::to_owned);
    shared
        .chain(CRATES.into_iter().flat_map(of_crate))
        .collect()
}

fn tell(key: &str, value: &str) {
    println!("cargo::{key}={value}");
}

/// Returns the commit, marked for modified sources; none outside of a repository.
fn commit(root: &Path, sources: &[String]) -> Option<String> {
    // A copy without its history may lie in another repository.
    let top = git(root, &["rev-parse", "--show-toplevel"])?;
    if Path::new(&top).canonicalize().ok()? != root.canonicalize().ok()? {
        return None;
    }
    watch(root);
    let commit = git(root, &["rev-parse", "--short=12", "HEAD"])?;
    let sources = sources.iter().map(String::as_str);
    let changes: Vec<&str> = ["status", "--porcelain", "--"]
        .into_iter()
        .chain(sources)
        .collect();
    let is_changed = !git(root, &changes)?.is_empty();
    Some(if is_changed {
        format!("{commit}-dirty")
    } else {
        commit
    })
}

/// Reruns the script after a commit, a merge or a checkout.
fn watch(root: &Path) {
    let branch = git(root, &["symbolic-ref", "--quiet", "HEAD"]);
    let names = ["HEAD", "logs/HEAD"].map(str::to_owned);
    for name in names.into_iter().chain(branch) {
        let Some(path) = git(root, &["rev-parse", "--git-path", &name]) else {
            continue;
        };
        // An absent file counts as a change in every build.
        let path = root.join(path);
        if path.exists() {
            tell("rerun-if-changed", &path.display().to_string());
        }
    }
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
