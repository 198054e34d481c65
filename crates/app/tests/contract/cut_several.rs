//! Tests of `incise cut` with several inputs and several planes.

use crate::common::{incise, messages, text};
use incise_mesh::{read_mesh, write_obj};
use incise_models::{Model, build_model};
use serde_json::Value;
use std::path::Path;

/// Cuts two built-in models; returns the exit code, the reports and the messages.
fn cut(output: &Path, more: &[&str]) -> (Option<i32>, Value, String) {
    let arguments = ["cut", "Sphere80", "Octopus", "-o", text(output), "--json"];
    let output = incise(&[&arguments[..], more].concat());
    let reports = serde_json::from_slice(&output.stdout).unwrap_or_default();
    (output.status.code(), reports, messages(&output))
}

#[test]
fn several_inputs_get_the_same_cut_and_their_pieces_are_numbered_through() {
    let folder = tempfile::tempdir().unwrap();
    let (code, reports, error) = cut(folder.path(), &["--plane", "1,0.1,0.2,0.03"]);
    assert_eq!(code, Some(0), "{error}");
    let mut files = Vec::new();
    for (report, model) in reports
        .as_array()
        .unwrap()
        .iter()
        .zip([Model::Sphere80, Model::Octopus])
    {
        assert_eq!(report["input"], model.name());
        assert!(report["cut"]["hits"].as_u64() > Some(0));
        let mut volume = 0.0;
        for piece in report["pieces"].as_array().unwrap() {
            volume += piece["volume"].as_f64().unwrap();
            files.push(piece["file"].as_str().unwrap().to_owned());
        }
        let whole = build_model(model).volume();
        assert!((volume / whole - 1.0).abs() < 2e-3, "{volume} of {whole}");
    }
    let all: Vec<_> = (0..files.len())
        .map(|i| folder.path().join(format!("piece_{i:03}.obj")))
        .map(|path| text(&path).to_owned())
        .collect();
    assert_eq!(files, all);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), all.len());
    // The pieces of one input are those of a run with it alone.
    let alone = tempfile::tempdir().unwrap();
    let arguments = ["cut", "Sphere80", "--plane", "1,0.1,0.2,0.03", "-o"];
    let output = incise(&[&arguments[..], &[text(alone.path())]].concat());
    assert_eq!(output.status.code(), Some(0));
    for i in 0..2 {
        let read = |folder: &Path| std::fs::read(folder.join(format!("piece_{i:03}.obj"))).unwrap();
        assert!(read(folder.path()) == read(alone.path()), "piece {i}");
    }
    let glb = folder.path().join("all.glb");
    let (code, _, error) = cut(&glb, &["--plane", "1,0.1,0.2,0.03"]);
    assert_eq!(code, Some(0), "{error}");
    assert!(read_mesh(&glb).is_ok());
}

#[test]
fn an_input_that_is_missed_is_named_and_written_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let far = folder.path().join("far.obj");
    let mut sphere = build_model(Model::Sphere80);
    for p in sphere.positions_mut() {
        p[0] += 10.0;
    }
    write_obj(&far, &sphere).unwrap();
    let out = folder.path().join("out");
    let run = |plane: &str| {
        let arguments = ["cut", "Sphere80", text(&far), "-o", text(&out)];
        let output = incise(&[&arguments[..], &["--plane", plane]].concat());
        (output.status.code(), messages(&output))
    };
    let (code, warnings) = run("1,0,0,0.03");
    assert_eq!(code, Some(0), "{warnings}");
    assert!(warnings.contains("far.obj: the cut misses"), "{warnings}");
    assert!(!warnings.contains("Sphere80: the cut misses"), "{warnings}");
    let uncut = read_mesh(&out.join("piece_002.obj")).unwrap();
    assert_eq!(uncut.triangles.len(), 80);
    let (code, error) = run("1,0,0,30");
    assert_eq!(code, Some(4), "{error}");
    assert!(error.contains("Sphere80"), "{error}");
}

#[test]
fn a_plane_that_misses_beside_others_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let planes = [
        "--plane",
        "1,0,0,0.03",
        "--plane",
        "0,1,0,30",
        "--plane",
        "0,0,1,0.02",
    ];
    let arguments = ["cut", "Sphere80", "-o", text(folder.path())];
    let output = incise(&[&arguments[..], &planes].concat());
    assert_eq!(output.status.code(), Some(0));
    let warnings = messages(&output);
    assert!(warnings.contains("plane 2 misses"), "{warnings}");
    assert_eq!(warnings.matches("misses").count(), 1, "{warnings}");
    let output = incise(&[&arguments[..], &planes, &["--json"]].concat());
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["missed_planes"], serde_json::json!([2]));
    assert_eq!(report["pieces"].as_array().unwrap().len(), 4);
}
