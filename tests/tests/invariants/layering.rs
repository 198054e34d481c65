//! Checks the dependencies between crates against the list of the architecture.

use serde_json::Value;
use std::collections::BTreeSet;
use std::process::Command;

/// Packages with the workspace packages that each may depend on, of any kind of dependency; all may
/// have [`FIXTURES`] as dev-dependencies.
///
/// A new package needs a line here.
const ALLOWED: [(&str, &[&str]); 21] = [
    ("incise-params", &[]),
    ("incise-mesh", &[]),
    ("incise-refine", &["incise-mesh", "incise-params"]),
    (
        "incise-cut",
        &["incise-mesh", "incise-params", "incise-refine"],
    ),
    // Its tests cut bodies.
    ("incise-lattice", &["incise-mesh", "incise-cut"]),
    (
        "incise-paper",
        &[
            "incise-mesh",
            "incise-params",
            "incise-refine",
            "incise-cut",
        ],
    ),
    (
        "incise-pbd-gpu",
        &["incise-lattice", "incise-mesh", "incise-params"],
    ),
    ("incise-reference", &["incise-mesh", "incise-pbd-gpu"]),
    ("incise-render", &["incise-mesh"]),
    (
        "incise-scene",
        &[
            "incise-mesh",
            "incise-params",
            "incise-cut",
            "incise-pbd-gpu",
        ],
    ),
    // The scenes are an optional feature of the models.
    (
        MODELS,
        &[
            "incise-mesh",
            "incise-cut",
            "incise-pbd-gpu",
            "incise-scene",
        ],
    ),
    (TEST_SUPPORT, &["incise-mesh", "incise-pbd-gpu"]),
    ("incise-progress", &[]),
    (
        "incise-cli",
        &[
            "incise-mesh",
            "incise-models",
            "incise-params",
            "incise-refine",
            "incise-cut",
            "incise-paper",
            "incise-pbd-gpu",
            "incise-render",
            "incise-scene",
            "incise-progress",
        ],
    ),
    (
        "incise-view",
        &[
            "incise-mesh",
            "incise-models",
            "incise-params",
            "incise-refine",
            "incise-cut",
            "incise-pbd-gpu",
            "incise-render",
            "incise-scene",
            "incise-cli",
        ],
    ),
    ("incise", LIBRARIES),
    ("incise-ffi", &["incise-models", "incise"]),
    ("incise-web", &["incise", "incise-models"]),
    ("incise-python", &["incise", "incise-mesh", "incise-models"]),
    (
        "incise-tests",
        &[
            "incise-mesh",
            "incise-models",
            "incise-params",
            "incise-refine",
            "incise-cut",
            "incise-paper",
            "incise-pbd-gpu",
            "incise-render",
            "incise-scene",
            "incise",
            TEST_SUPPORT,
            "incise-cli",
        ],
    ),
    (
        "incise-bench",
        &[
            "incise-mesh",
            "incise-models",
            "incise-refine",
            "incise-cut",
            "incise-paper",
            "incise-params",
            "incise-pbd-gpu",
            "incise-scene",
            "incise-progress",
            "incise-reference",
            "incise-tests",
        ],
    ),
];

const MODELS: &str = "incise-models";
const TEST_SUPPORT: &str = "incise-test-support";

/// Models and test fixtures, which every package may use as dev-dependencies.
const FIXTURES: [&str; 2] = [MODELS, TEST_SUPPORT];

const LIBRARIES: &[&str] = &[
    "incise-mesh",
    "incise-models",
    "incise-params",
    "incise-refine",
    "incise-cut",
    "incise-paper",
    "incise-pbd-gpu",
    "incise-render",
    "incise-scene",
];

/// Returns every workspace package with kind and name of its dependencies in the workspace.
fn dependencies(metadata: &Value) -> Vec<(&str, Vec<(&str, &str)>)> {
    let packages = metadata["packages"].as_array().expect("cargo's format");

    let members: BTreeSet<String> = packages
        .iter()
        .filter_map(|p| p["name"].as_str().map(str::to_owned))
        .collect();
    packages
        .iter()
        .map(|package| {
            let dependencies = package["dependencies"].as_array().expect("cargo's format");
            let inner = dependencies
                .iter()
                .map(|d| {
                    let kind = d["kind"].as_str().unwrap_or("normal");
                    (kind, d["name"].as_str().expect("cargo's format"))
                })
                .filter(|(_, to)| members.contains(*to))
                .collect();
            (package["name"].as_str().expect("cargo's format"), inner)
        })
        .collect()
}

/// Returns the dependencies that are not allowed, as text.
fn not_allowed(metadata: &Value) -> Vec<String> {
    let mut out = Vec::new();
    for (from, found) in dependencies(metadata) {
        let allowed = ALLOWED.iter().find(|(name, _)| *name == from);
        let Some((_, allowed)) = allowed else {
            out.push(format!("{from} is not in the list"));
            continue;
        };
        for (kind, to) in found {
            let is_fixture = kind == "dev" && FIXTURES.contains(&to);
            if !allowed.contains(&to) && !is_fixture {
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
        .expect("cargo runs");
    assert!(
        output.status.success(),
        "cargo metadata: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    serde_json::from_slice(&output.stdout).expect("cargo writes JSON")
}

#[test]
fn dependencies_are_allowed() {
    let metadata = metadata();
    let found: BTreeSet<&str> = dependencies(&metadata)
        .iter()
        .map(|(name, _)| *name)
        .collect();
    let listed: BTreeSet<&str> = ALLOWED.iter().map(|(name, _)| *name).collect();
    assert_eq!(found, listed, "packages of the workspace and of the list");
    assert_eq!(not_allowed(&metadata), Vec::<String>::new());
}

/// Returns the names of all packages of a build of the workspace, including tests.
fn packages_built(options: &[&str]) -> BTreeSet<String> {
    let output = Command::new(env!("CARGO"))
        .args(["tree", "--workspace", "--offline"])
        .args(["--prefix", "none", "--format", "{p}"])
        .args(options)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs");
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
fn no_package_depends_on_wgpu_without_the_feature_gpu() {
    let with = packages_built(&[]);
    assert!(with.contains("wgpu"), "the feature gpu is on by default");
    let without = packages_built(&["--no-default-features"]);
    assert!(without.contains("incise-pbd-gpu"), "{without:?}");
    let wgpu: Vec<&String> = without.iter().filter(|p| p.starts_with("wgpu")).collect();
    assert!(wgpu.is_empty(), "{wgpu:?}");
}

#[test]
fn the_list_has_no_cycle() {
    let mut done: BTreeSet<&str> = BTreeSet::new();
    for (name, allowed) in ALLOWED {
        for to in allowed {
            assert!(done.contains(to), "{to} must be listed before {name}");
        }
        done.insert(name);
    }
}

#[test]
fn a_wrong_dependency_of_any_kind_is_found() {
    for kind in ["null", "\"dev\"", "\"build\""] {
        let text = format!(
            r#"{{"packages": [
                {{"name": "incise-mesh", "dependencies": [
                    {{"name": "incise-cut", "kind": {kind}}}
                ]}},
                {{"name": "incise-cut", "dependencies": [{{"name": "robust", "kind": null}}]}}
            ]}}"#
        );
        let metadata = serde_json::from_str(&text).expect("it is JSON");
        assert_eq!(not_allowed(&metadata).len(), 1, "{kind}");
    }
}
