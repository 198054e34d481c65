//! Notes the commit that the program is built from, for what it measures to be found again.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The crates that the program is made of.
const CRATES: [&str; 7] = [
    "mesh", "refine", "cut", "pbd-gpu", "render", "scene", "bench",
];

fn main() {
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default()).join("../..");
    let sources = sources();
    // Any of them makes another program, which is compiled again then: to ask git costs nothing beside it.
    for source in &sources {
        tell("rerun-if-changed", &root.join(source).display().to_string());
    }
    let commit = commit(&root, &sources).unwrap_or_else(|| "unknown".to_owned());
    tell("rustc-env", &format!("INCISE_COMMIT={commit}"));
}

/// What the program is built from, of the workspace. Another file, as the README, makes no other program.
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

/// The commit, with a mark where sources differ from it; none where the workspace is no repository.
fn commit(root: &Path, sources: &[String]) -> Option<String> {
    // A copy without its history may lie in a repository of something else.
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

/// Has the commit asked for again when it is another: after a commit, a merge, a checkout.
fn watch(root: &Path) {
    let branch = git(root, &["symbolic-ref", "--quiet", "HEAD"]);
    let names = ["HEAD", "logs/HEAD"].map(str::to_owned);
    for name in names.into_iter().chain(branch) {
        let Some(path) = git(root, &["rev-parse", "--git-path", &name]) else {
            continue;
        };
        // A file that is not there would be looked for in every build, and taken for a change.
        let path = root.join(path);
        if path.exists() {
            tell("rerun-if-changed", &path.display().to_string());
        }
    }
}

/// What git answers; nothing where it is not there or refuses.
fn git(root: &Path, arguments: &[&str]) -> Option<String> {
    // Others may be at work in the same repository.
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
