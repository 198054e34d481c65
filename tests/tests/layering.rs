//! Arrows between crates run one way. Any that the architecture does not allow fails here.

use serde_json::Value;
use std::collections::BTreeSet;
use std::process::Command;

/// Every package and all of this workspace that it may use, of any kind of dependency. What is not
/// listed here may not exist: a new package needs a line.
const ALLOWED: [(&str, &[&str]); 11] = [
    ("incise-mesh", &[]),
    ("incise-refine", &["incise-mesh"]),
    ("incise-cut", &["incise-mesh", "incise-refine"]),
    ("incise-pbd-gpu", &["incise-mesh"]),
    ("incise-render", &["incise-mesh"]),
    (
        "incise-scene",
        &["incise-mesh", "incise-cut", "incise-pbd-gpu"],
    ),
    ("incise-view", BELOW_PROGRAMS),
    ("incise-progress", &[]),
    (
        "incise-bench",
        &[
            "incise-mesh",
            "incise-refine",
            "incise-cut",
            "incise-pbd-gpu",
            "incise-render",
            "incise-scene",
            "incise-progress",
        ],
    ),
    (
        "incise",
        &[
            "incise-mesh",
            "incise-refine",
            "incise-cut",
            "incise-pbd-gpu",
            "incise-render",
            "incise-scene",
            "incise-view",
            "incise-progress",
        ],
    ),
    ("incise-tests", BELOW_PROGRAMS),
];

const BELOW_PROGRAMS: &[&str] = &[
    "incise-mesh",
    "incise-refine",
    "incise-cut",
    "incise-pbd-gpu",
    "incise-render",
    "incise-scene",
];

/// Of every workspace package its name and, for each arrow into the workspace, the kind and the name.
fn arrows(metadata: &Value) -> Vec<(&str, Vec<(&str, &str)>)> {
    let packages = metadata["packages"].as_array().expect("cargo's format");

    let members: BTreeSet<String> = packages
        .iter()
        .filter_map(|p| p["name"].as_str().map(str::to_owned))
        .collect();
    packages
        .iter()
        .map(|package| {
            let dependencies = package["dependencies"].as_array().expect("cargo's format");
            let arrows = dependencies
                .iter()
                .map(|d| {
                    let kind = d["kind"].as_str().unwrap_or("normal");
                    (kind, d["name"].as_str().expect("cargo's format"))
                })
                .filter(|(_, to)| members.contains(*to))
                .collect();
            (package["name"].as_str().expect("cargo's format"), arrows)
        })
        .collect()
}

/// Arrows that are not allowed, as text.
fn broken(metadata: &Value) -> Vec<String> {
    let mut out = Vec::new();
    for (from, arrows) in arrows(metadata) {
        let allowed = ALLOWED.iter().find(|(name, _)| *name == from);
        let Some((_, allowed)) = allowed else {
            out.push(format!("{from} has no place in the architecture"));
            continue;
        };
        for (kind, to) in arrows {
            if !allowed.contains(&to) {
                out.push(format!("{from} -> {to} ({kind})"));
            }
        }
    }
    out
}

fn metadata() -> Value {
    let output = Command::new(env!("CARGO"))
        .args([
            "metadata",
            "--no-deps",
            "--offline",
            "--format-version",
            "1",
        ])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs where its tests run");
    assert!(
        output.status.success(),
        "cargo metadata: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    serde_json::from_slice(&output.stdout).expect("cargo writes JSON")
}

#[test]
fn arrows_run_one_way() {
    let metadata = metadata();
    let found: BTreeSet<&str> = arrows(&metadata).iter().map(|(name, _)| *name).collect();
    let listed: BTreeSet<&str> = ALLOWED.iter().map(|(name, _)| *name).collect();
    assert_eq!(found, listed, "the workspace and the list differ");
    assert_eq!(broken(&metadata), Vec::<String>::new());
}

/// The names of all packages that a build of the workspace takes, tests included.
fn packages_built(options: &[&str]) -> BTreeSet<String> {
    let output = Command::new(env!("CARGO"))
        .args(["tree", "--workspace", "--offline"])
        .args(["--prefix", "none", "--format", "{p}"])
        .args(options)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs where its tests run");
    assert!(
        output.status.success(),
        "cargo tree: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8_lossy(&output.stdout)
        .lines()
        .filter_map(|line| line.split(' ').next())
        .map(str::to_owned)
        .collect()
}

#[test]
fn without_the_feature_nothing_takes_wgpu() {
    let with = packages_built(&[]);
    assert!(with.contains("wgpu"), "the feature gpu is on by default");
    let without = packages_built(&["--no-default-features"]);
    assert!(without.contains("incise-pbd-gpu"), "{without:?}");
    let wgpu: Vec<&String> = without.iter().filter(|p| p.starts_with("wgpu")).collect();
    assert!(wgpu.is_empty(), "{wgpu:?}");
}

#[test]
fn the_list_itself_has_no_circle() {
    let mut done: BTreeSet<&str> = BTreeSet::new();
    for (name, allowed) in ALLOWED {
        for to in allowed {
            assert!(done.contains(to), "{name} stands before {to}");
        }
        done.insert(name);
    }
}

#[test]
fn a_wrong_arrow_of_any_kind_is_seen() {
    for kind in ["null", "\"dev\"", "\"build\""] {
        let text = format!(
            r#"{{"packages": [
                {{"name": "incise-mesh", "dependencies": [{{"name": "incise-cut", "kind": {kind}}}]}},
                {{"name": "incise-cut", "dependencies": [{{"name": "robust", "kind": null}}]}}
            ]}}"#
        );
        let metadata = serde_json::from_str(&text).expect("it is JSON");
        assert_eq!(broken(&metadata).len(), 1, "{kind}");
    }
}
