//! Tests of `incise check`: report, JSON fields, errors and exit codes.

use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output};
use tempfile::TempDir;

const TETRAHEDRON: &str =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

fn incise(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_incise"))
        .args(arguments)
        .output()
        .unwrap()
}

fn file(text: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.obj");
    std::fs::write(&path, text).unwrap();
    (folder, path)
}

fn check(text: &str, options: &[&str]) -> (Option<i32>, String, String) {
    let (_folder, path) = file(text);
    let mut arguments = vec!["check", path.to_str().unwrap()];
    arguments.extend(options);
    let output = incise(&arguments);
    (
        output.status.code(),
        String::from_utf8(output.stdout).unwrap(),
        String::from_utf8(output.stderr).unwrap(),
    )
}

/// The tetrahedron without its last face.
fn open() -> &'static str {
    TETRAHEDRON.trim_end().rsplit_once('\n').unwrap().0
}

#[test]
fn a_cuttable_mesh_is_described() {
    let (code, out, err) = check(TETRAHEDRON, &[]);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    for (name, value) in [
        ("vertices", "4"),
        ("triangles", "4"),
        ("edges", "6"),
        ("genus", "0"),
        ("closed", "yes"),
        ("volume", "0.1666667"),
        ("cuttable", "yes"),
    ] {
        assert!(
            out.lines().any(|line| line
                .trim()
                .strip_prefix(name)
                .is_some_and(|rest| rest.trim() == value)),
            "{name} {value} in\n{out}"
        );
    }
}

#[test]
fn defects_of_an_open_mesh_are_listed() {
    let (code, out, err) = check(open(), &[]);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    assert!(out.contains("open edges: 3"), "{out}");
    assert!(
        out.contains("cuttable              yes, as a sheet"),
        "{out}"
    );
}

/// Two tetrahedra that share an edge and its two vertices.
const TWO: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nv 0 0 -1\nf 1 3 2\nf 1 2 4\n\
                   f 2 3 4\nf 3 1 4\nf 1 5 2\nf 1 2 6\nf 2 5 6\nf 5 1 6\n";

#[test]
fn bodies_that_share_an_edge_are_separated_unless_repair_is_off() {
    let (code, out, err) = check(TWO, &[]);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    assert!(
        out.contains("edges with more than two triangles, split: 1, first v0-v1"),
        "{out}"
    );
    assert!(out.contains("non-manifold edges    1"), "{out}");
    let (code, _, err) = check(TWO, &["--no-repair"]);
    assert_eq!(code, Some(1));
    assert!(
        err.contains("edges with more than two triangles: 1"),
        "{err}"
    );
    let (folder, path) = file(TWO);
    let pieces = folder.path().join("pieces");
    let (path, pieces) = (path.to_str().unwrap(), pieces.to_str().unwrap());
    let arguments = ["cut", path, "--plane", "1,0,0,0.4", "-o", pieces];
    let output = incise(&arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert_eq!(std::fs::read_dir(pieces).unwrap().count(), 4);
    let output = incise(&[&arguments[..], &["--no-repair"]].concat());
    assert_eq!(output.status.code(), Some(1), "{output:?}");
}

#[test]
fn json_has_every_field_under_its_name() {
    let (code, out, _) = check(TETRAHEDRON, &["--json"]);
    assert_eq!(code, Some(0));
    let json: Value = serde_json::from_str(&out).unwrap();
    let names: Vec<&str> = json
        .as_object()
        .unwrap()
        .keys()
        .map(String::as_str)
        .collect();
    let mut expected = [
        "file",
        "cuttable",
        "vertices",
        "file_vertices",
        "triangles",
        "edges",
        "components",
        "euler_characteristic",
        "genus",
        "closed",
        "manifold",
        "oriented",
        "open_edges",
        "nonmanifold_edges",
        "nonmanifold_vertices",
        "winding_conflicts",
        "degenerate_triangles",
        "area",
        "volume",
        "bounds",
        "angles",
        "edge_lengths",
        "warnings",
        "defects",
        "repaired",
    ];
    expected.sort_unstable();
    let mut names = names;
    names.sort_unstable();
    assert_eq!(names, expected);
    assert_eq!(json["cuttable"], true);
    assert_eq!(json["bounds"]["max"], serde_json::json!([1.0, 1.0, 1.0]));
    assert_eq!(json["edge_lengths"]["min"], 1.0);
    assert_eq!(json["repaired"]["genus"], 0);

    let (code, out, err) = check(open(), &["--json"]);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let json: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(json["cuttable"], true);
    assert_eq!(json["closed"], false);
    assert_eq!(json["genus"], Value::Null);
    assert_eq!(json["repaired"], Value::Null);
    assert_eq!(json["defects"][0]["kind"], "open_edge");
    assert_eq!(json["defects"][0]["count"], 3);
}

#[test]
fn a_broken_file_names_the_line() {
    let (code, out, err) = check("v 0 0 0\nf 1 2 3\n", &[]);
    assert_eq!((code, out.as_str()), (Some(1), ""));
    assert!(
        err.contains("mesh.obj: line 2: index 2 is out of range"),
        "{err}"
    );
}

#[test]
fn a_missing_file_is_named() {
    let output = incise(&["check", "not_there.ply"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        String::from_utf8(output.stderr)
            .unwrap()
            .contains("not_there.ply")
    );
}

#[test]
fn a_built_in_model_needs_no_file() {
    let output = incise(&["check", "bunny", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&json["triangles"], &json["cuttable"]),
        (&1500.into(), &true.into())
    );
}

#[test]
fn inputs_that_are_no_meshes_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("empty.ply"), "").unwrap();
    std::fs::create_dir(path("folder.obj")).unwrap();
    for (name, said) in [
        ("empty.ply", "the file is empty"),
        ("folder.obj", "this is a folder"),
    ] {
        let output = incise(&["check", path(name).to_str().unwrap()]);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{error}");
        assert!(error.contains(said), "{error}");
    }
    let error = String::from_utf8(incise(&["check", "Bunny.obj"]).stderr).unwrap();
    assert!(
        error.contains("the built-in model is called Bunny"),
        "{error}"
    );
}

#[test]
fn a_wrong_command_line_is_2() {
    assert_eq!(incise(&[]).status.code(), Some(2));
    assert_eq!(incise(&["check"]).status.code(), Some(2));
    assert_eq!(incise(&["peel", "mesh.obj"]).status.code(), Some(2));
    assert_eq!(incise(&["--version"]).status.code(), Some(0));
}
