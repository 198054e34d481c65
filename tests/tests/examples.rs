//! Every library crate has a short example, and the front page of its documentation begins as that does.

use std::fs;
use std::path::{Path, PathBuf};

/// Libraries that are taken alone. The programs and what only they share have no example.
const LIBRARIES: [&str; 7] = [
    "mesh", "refine", "cut", "pbd-gpu", "render", "scene", "view",
];

fn crates() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates")
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// The lines of an example's code, without its head and without empty ones.
fn code(text: &str) -> Vec<&str> {
    let is_code =
        |line: &&str| !line.is_empty() && !line.starts_with("//!") && !line.starts_with("#!");
    text.lines().filter(is_code).collect()
}

/// The lines that readers see of the first code in a crate's documentation.
fn front(text: &str) -> Vec<&str> {
    let is_fence = |line: &&str| line.starts_with("//! ```") || line.contains("doc = \"```");
    let lines = text.lines().skip_while(|line| !is_fence(line));
    let block = lines
        .skip_while(is_fence)
        .take_while(|line| !is_fence(line));
    let seen = block.map(|line| line.trim_start_matches("//!"));
    let seen = seen.map(|line| line.strip_prefix(' ').unwrap_or(line));
    seen.filter(|line| !line.is_empty() && !line.starts_with("# "))
        .collect()
}

#[test]
fn every_library_has_a_short_example_that_its_front_page_shows() {
    for name in LIBRARIES {
        let folder = crates().join(name);
        let entries = fs::read_dir(folder.join("examples")).expect("a folder of examples");
        let files: Vec<PathBuf> = entries.map(|e| e.expect("it is there").path()).collect();
        let [file] = files.as_slice() else {
            panic!("{name}: one example, not {files:?}");
        };
        let text = read(file);
        assert!(text.lines().count() < 60, "{}: too long", file.display());
        let page = read(&folder.join("src/lib.rs"));
        let shown = front(&page);
        let [begin @ .., end, brace] = shown.as_slice() else {
            panic!("{name}: nothing is shown");
        };
        assert_eq!([end.trim(), brace.trim()], ["// and on", "}"], "{name}");
        assert!(begin.len() >= 10, "{name}: ten lines, not {begin:#?}");
        assert_eq!(begin, &code(&text)[..begin.len()], "{name}");
        let base = file.file_name().expect("a file").to_string_lossy();
        assert!(
            page.contains(&format!("`examples/{base}`")),
            "{name} names it"
        );
    }
}

#[test]
fn no_library_is_forgotten() {
    let programs = ["app", "bench", "progress"];
    for entry in fs::read_dir(crates()).expect("the crates") {
        let name = entry.expect("it is there").file_name();
        let name = name.to_string_lossy();
        let known = LIBRARIES.iter().chain(&programs);
        assert!(
            known.into_iter().any(|k| *k == name),
            "{name}: list it here"
        );
    }
}
