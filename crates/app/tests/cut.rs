//! The binary's `cut`, as a user runs it.

use incise_mesh::{Model, build_model, write_obj};
use std::path::Path;
use std::process::{Command, Output};

fn incise(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_incise"))
        .args(arguments)
        .output()
        .unwrap()
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

#[test]
fn a_plane_makes_two_closed_pieces_at_every_level() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("sphere.obj");
    write_obj(&input, &build_model(Model::Sphere768)).unwrap();
    let levels = [
        "2x-coarser",
        "1.5x-coarser",
        "original",
        "1.5x-finer",
        "2x-finer",
        "0.8",
    ];
    for level in levels {
        let pieces = folder.path().join(level);
        let arguments = [
            "cut",
            text(&input),
            "--plane",
            "-1,0.2,0.1,0.05",
            "--level",
            level,
            "-o",
            text(&pieces),
            "--json",
        ];
        let output = incise(&arguments);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(report["pieces"].as_array().unwrap().len(), 2);
        let volumes = report["pieces"].as_array().unwrap().iter();
        let sum: f64 = volumes.map(|p| p["volume"].as_f64().unwrap()).sum();
        let before = report["volume"].as_f64().unwrap();
        assert!((sum - before).abs() < 0.03 * before, "{sum} of {before}");
        for piece in ["piece_000.obj", "piece_001.obj"] {
            let check = incise(&["check", text(&pieces.join(piece))]);
            assert_eq!(check.status.code(), Some(0), "{piece} is closed");
        }
    }
}

#[test]
fn a_blade_cuts_what_it_sweeps_and_not_half() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("sphere.obj");
    write_obj(&input, &build_model(Model::Sphere80)).unwrap();
    let output = folder.path().join("out");
    let cut = |to| {
        incise(&[
            "cut",
            text(&input),
            "--blade",
            "-2,0.1,-2,-2,0.1,2",
            "--to",
            to,
            "-o",
            text(&output),
        ])
    };
    let half = cut("0,0.1,-2,0,0.1,2");
    assert_eq!(half.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&half.stderr).contains("ends inside the body"));
    assert!(!output.exists(), "nothing is written");
    assert_eq!(cut("2,0.1,-2,2,0.1,2").status.code(), Some(0));
    assert!(output.join("piece_001.obj").exists());
}

#[test]
fn a_wrong_command_line_exits_with_2_and_a_wrong_input_with_1() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("sphere.obj");
    write_obj(&input, &build_model(Model::Sphere20)).unwrap();
    let output = folder.path().join("out");
    let code = |more: &[&str]| {
        let mut arguments = vec!["cut", text(&input), "-o", text(&output)];
        arguments.extend(more);
        incise(&arguments).status.code()
    };
    assert_eq!(code(&[]), Some(2), "neither plane nor blade");
    assert_eq!(code(&["--plane", "1,0,0"]), Some(2), "three numbers");
    assert_eq!(code(&["--plane", "0,0,0,1"]), Some(2), "no normal");
    assert_eq!(code(&["--plane", "1,0,0,nan"]), Some(2), "not finite");
    assert_eq!(code(&["--blade", "0,0,0,1,1,1"]), Some(2), "to nowhere");
    assert_eq!(code(&["--plane", "1,0,0,0", "--level", "0"]), Some(2));
    assert!(!output.exists(), "nothing is written");
    let missing = folder.path().join("missing.obj");
    let status = incise(&[
        "cut",
        text(&missing),
        "--plane",
        "1,0,0,0",
        "-o",
        text(&output),
    ]);
    assert_eq!(status.status.code(), Some(1));
    assert_eq!(code(&["--plane", "1,0,0,9"]), Some(0), "a miss is no error");
}
