//! Tests of `incise cut`: combinations of options, warnings, and files left by refused cuts.

use crate::bodies::hollow_sphere;
use crate::common::{cut, incise, text};
use incise_mesh::write_obj;
use incise_models::{Model, build_model};

fn sum_of_volumes(report: &serde_json::Value) -> f64 {
    let pieces = report["pieces"].as_array().unwrap().iter();
    pieces.map(|p| p["volume"].as_f64().unwrap()).sum()
}

#[test]
fn the_exact_method_supports_both_refinements_and_the_paper_method_one() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("hollow.obj");
    write_obj(&input, &hollow_sphere()).unwrap();
    let output = folder.path().join("out");
    let run = |more: &[&str]| {
        let plane = ["--plane", "1,0.1,0.2,0.01", "--level", "0.3"];
        cut(&input, &output, &[&plane[..], more].concat())
    };
    let mut caps = Vec::new();
    for (more, name) in [
        (&[][..], "delaunay"),
        (&["--refine-method", "delaunay"], "delaunay"),
        (&["--refine-method", "paper"], "paper"),
    ] {
        let (code, report, error) = run(more);
        assert_eq!(code, Some(0), "{error}");
        assert_eq!(report["refine_method"], name, "{more:?}");
        assert_eq!(report["pieces"].as_array().unwrap().len(), 2);
        let before = report["volume"].as_f64().unwrap();
        assert!((sum_of_volumes(&report) - before).abs() < 2e-3 * before);
        caps.push(report["cap_median_angle_deg"].as_f64().unwrap());
    }
    assert_eq!(caps[0], caps[1], "delaunay is the default");
    assert_ne!(caps[0], caps[2], "the paper's triangles are others");
    let (code, _, error) = run(&["--method", "paper", "--refine-method", "delaunay"]);
    assert_eq!(code, Some(2), "{error}");
    let said = "refine-method has no meaning with 'paper'";
    assert!(error.contains(said), "{error}");
    let ball = folder.path().join("sphere.obj");
    write_obj(&ball, &build_model(Model::Sphere80)).unwrap();
    let plane = ["--plane", "1,0.1,0.2,0.01", "--method", "paper"];
    for more in [&[][..], &["--refine-method", "paper"]] {
        let (code, report, error) = cut(&ball, &output, &[&plane[..], more].concat());
        assert_eq!(code, Some(0), "{error}");
        assert_eq!(report["refine_method"], "paper");
    }
}

#[test]
fn options_of_the_exact_method_are_refused_with_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("sphere.obj");
    write_obj(&input, &build_model(Model::Sphere80)).unwrap();
    let output = folder.path().join("out");
    for (options, said) in [
        (
            ["--method", "paper", "--snap", "0.1"],
            "snap has no meaning with 'paper'",
        ),
        (
            ["--method", "paper", "--caps", "none"],
            "caps has no meaning with 'paper'",
        ),
        (
            ["--method", "paper", "--grading", "0"],
            "grading has no meaning with 'paper'",
        ),
        (
            ["--refine-method", "paper", "--grading", "0.3"],
            "grading has no meaning with 'paper'",
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
    for refine in ["delaunay", "paper"] {
        let limit = ["--refine-method", refine, "--max-triangles", "100"];
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
