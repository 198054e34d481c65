//! Tests of `incise cut`: combinations of options, warnings, and files left by refused cuts.

use crate::common::{cut, incise, text};
use incise_mesh::write_obj;
use incise_models::{Model, build_model};

#[test]
fn options_of_one_method_are_refused_with_the_other() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("sphere.obj");
    write_obj(&input, &build_model(Model::Sphere80)).unwrap();
    let output = folder.path().join("out");
    for (options, said) in [
        (
            ["--method", "paper", "--snap", "0.1"],
            "--snap cannot be combined with --method paper",
        ),
        (
            ["--method", "paper", "--caps", "none"],
            "--caps cannot be combined with --method paper",
        ),
        (
            ["--method", "paper", "--grading", "0"],
            "--grading cannot be combined with --method paper",
        ),
        (
            ["--method", "exact", "--beta", "0.1"],
            "--beta cannot be combined with --method exact",
        ),
    ] {
        let plane = ["--plane", "1,0.1,0.2,0.01"];
        let (code, _, error) = cut(&input, &output, &[&plane[..], &options].concat());
        assert_eq!(code, Some(2), "{error}");
        assert!(error.contains(said), "{error}");
        assert!(!output.exists(), "nothing is written");
    }
}

#[test]
fn repairs_are_warned_of_and_reported() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("inverted.obj");
    write_obj(&input, &build_model(Model::Sphere80)).unwrap();
    let turned: String = (std::fs::read_to_string(&input).unwrap().lines())
        .map(|line| {
            let mut parts: Vec<&str> = line.split(' ').collect();
            if parts[0] == "f" {
                parts.swap(1, 2);
            }
            parts.join(" ") + "\n"
        })
        .collect();
    std::fs::write(&input, turned).unwrap();
    let output = folder.path().join("out");
    let (code, report, said) = cut(&input, &output, &["--plane", "1,0.1,0.2,0.01"]);
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(said, "", "the report has the warnings");
    assert_eq!(report["warnings"][0]["kind"], "inverted", "{report}");
    let checked = incise(&["check", text(&input), "--json"]);
    let checked: serde_json::Value = serde_json::from_slice(&checked.stdout).unwrap();
    assert_eq!(report["warnings"], checked["warnings"]);
    let plane = ["--plane", "1,0.1,0.2,9", "-o", text(&output)];
    let told = incise(&[&["cut", text(&input)], &plane[..]].concat()).stderr;
    let flipped = "the mesh was inside out and was flipped";
    assert!(String::from_utf8(told).unwrap().contains(flipped));
    let told = incise(&[&["--json", "cut", text(&input)], &plane[..]].concat()).stderr;
    let told: serde_json::Value = serde_json::from_slice(&told).unwrap();
    assert!(
        told["warnings"][0].as_str().unwrap().contains(flipped),
        "{told}"
    );
}

#[test]
fn a_refused_cut_leaves_earlier_pieces_and_a_limit_of_triangles_refuses() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("sphere.obj");
    write_obj(&input, &build_model(Model::Sphere80)).unwrap();
    let output = folder.path().join("out");
    let plane = ["--plane", "1,0.1,0.2,0.01", "--level", "0.2"];
    let (code, report, error) = cut(&input, &output, &plane);
    assert_eq!(code, Some(0), "{error}");
    let cap = report["cap_triangles"].as_u64().unwrap() / 2;
    let bytes =
        || ["piece_000.obj", "piece_001.obj"].map(|name| std::fs::read(output.join(name)).unwrap());
    let before = bytes();
    for method in ["exact", "paper"] {
        let limit = ["--method", method, "--max-triangles", "100"];
        let (code, _, error) = cut(&input, &output, &[&plane[..], &limit].concat());
        assert_eq!(code, Some(1), "{error}");
        assert!(error.contains("more than 100 triangles"), "{error}");
        assert_eq!(bytes(), before, "earlier pieces are as they were");
    }
    let limit = cap.to_string();
    let (code, ..) = cut(
        &input,
        &output,
        &[&plane[..], &["--max-triangles", &limit]].concat(),
    );
    assert_eq!(code, Some(0), "as many as it needs are enough");
}
