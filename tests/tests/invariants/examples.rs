//! Every library crate has a README that is its front page, and a short example.

use std::fs;
use std::path::{Path, PathBuf};

/// Libraries that are used alone.
const LIBRARIES: [&str; 11] = [
    "cut", "incise", "lattice", "mesh", "models", "paper", "pbd-gpu", "refine", "render", "scene",
    "view",
];
/// Bindings for other languages, whose READMEs begin with code in these.
const BINDINGS: [&str; 3] = ["ffi", "python", "web"];
/// Programs, and crates that only this workspace uses.
const OTHERS: [&str; 6] = [
    "app",
    "bench",
    "params",
    "progress",
    "reference",
    "test-support",
];

fn crates() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates")
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

#[test]
fn the_readme_of_a_library_is_its_front_page_and_begins_with_code() {
    for name in LIBRARIES {
        let library = read(&crates().join(name).join("src/lib.rs"));
        assert!(library.contains("include_str!(\"../README.md\")"), "{name}");
        let readme = read(&crates().join(name).join("README.md"));
        let first_screen: Vec<&str> = readme.lines().take(40).collect();
        assert!(
            first_screen.iter().any(|line| line.starts_with("```rust")),
            "{name}: an example on the first screen"
        );
    }
}

#[test]
fn a_library_has_one_short_example_that_its_readme_names() {
    for name in LIBRARIES.into_iter().filter(|&name| name != "models") {
        let folder = crates().join(name);
        let entries = fs::read_dir(folder.join("examples")).expect("a folder of examples");
        let files: Vec<PathBuf> = entries.map(|e| e.expect("an entry").path()).collect();
        let [file] = files.as_slice() else {
            panic!("{name}: one example, not {files:?}");
        };
        let line_count = read(file).lines().count();
        assert!(line_count < 60, "{}: {line_count} lines", file.display());
        let example = file.file_stem().expect("a file").to_string_lossy();
        let readme = read(&folder.join("README.md"));
        assert!(readme.contains(&format!("--example {example}")), "{name}");
    }
}

#[test]
fn every_crate_is_listed() {
    for entry in fs::read_dir(crates()).expect("the crates") {
        let name = entry.expect("an entry").file_name();
        let name = name.to_string_lossy();
        let known = LIBRARIES.iter().chain(&BINDINGS).chain(&OTHERS);
        assert!(
            known.into_iter().any(|k| *k == name),
            "{name}: list it here"
        );
    }
}
