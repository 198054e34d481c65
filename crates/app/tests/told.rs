//! What the binary says and where: progress on the error output, reports on the other, nothing if asked to be quiet.

use incise_mesh::{Model, build_model, write_obj};
use std::path::Path;
use std::process::{Command, Output};

fn incise(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_incise"));
    command.args(arguments).output().unwrap()
}

/// Both outputs of a run that has to succeed.
fn said(arguments: &[&str]) -> [String; 2] {
    let done = incise(arguments);
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    [done.stdout, done.stderr].map(|text| String::from_utf8(text).unwrap())
}

fn with_sphere() -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("sphere.obj");
    write_obj(&input, &build_model(Model::Sphere20)).unwrap();
    let input = input.to_str().unwrap().to_owned();
    (folder, input)
}

fn simulate<'a>(input: &'a str, out: &'a Path, more: &[&'a str]) -> Vec<&'a str> {
    let out = out.to_str().unwrap();
    let base = ["simulate", input, "--seconds", "2.5", "-o", out];
    base.iter().chain(more).copied().collect()
}

#[test]
fn long_work_says_how_far_it_is_without_a_terminal() {
    let (folder, input) = with_sphere();
    let out = folder.path().join("out");
    let [report, progress] = said(&simulate(&input, &out, &[]));
    assert!(report.contains("150 frames"), "{report}");
    let lines: Vec<&str> = progress.lines().collect();
    let expected = ["1/3 from 0.000 s", "2/3 from 1.000 s", "3/3 from 2.000 s"];
    assert_eq!(lines, expected);
}

#[test]
fn who_is_asked_to_be_quiet_says_only_what_is_asked_for() {
    let (folder, input) = with_sphere();
    let out = folder.path().join("out");
    for quiet in ["--quiet", "-q"] {
        let said = said(&simulate(&input, &out, &[quiet]));
        assert_eq!(said, ["", ""], "{quiet}");
        assert!(out.join("piece_000.obj").exists(), "it is done");
    }
    let [report, progress] = said(&simulate(&input, &out, &["--json", "--quiet"]));
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!((&report["frames"], progress.as_str()), (&150.into(), ""));
    for command in [&["check", &input][..], &["-q", "check", &input]] {
        let is_quiet = command[0] == "-q";
        assert_eq!(said(command)[0].is_empty(), is_quiet, "{command:?}");
    }
    let refused = incise(&["--quiet", "check", "/nonexistent.obj"]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(!refused.stderr.is_empty(), "errors are told");
}

#[test]
fn shells_complete_commands_and_options() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let [script, _] = said(&["completions", shell, "--quiet"]);
        for word in ["simulate", "refine-method", "quiet"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
}

#[test]
fn help_has_an_example_that_runs_and_a_line_for_every_command() {
    let [help, _] = said(&["--help"]);
    for command in ["check", "cut", "devices", "fill", "simulate", "completions"] {
        assert!(help.contains(&format!("\n  {command}")), "{help}");
        let [of, _] = said(&["help", command]);
        assert!(of.contains("Usage: "), "{of}");
    }
    let (folder, input) = with_sphere();
    let examples = help.lines().map(str::trim);
    let cut = examples.filter(|line| line.starts_with("incise cut"));
    let cut: Vec<Vec<&str>> = cut.map(|line| line.split(' ').skip(1).collect()).collect();
    assert_eq!(cut.len(), 1, "{help}");
    let out = folder.path().join("pieces");
    let words = cut[0].iter().map(|&word| match word {
        "bunny.obj" => input.as_str(),
        "pieces" => out.to_str().unwrap(),
        word => word,
    });
    said(&words.collect::<Vec<_>>());
    assert!(out.join("piece_001.obj").exists(), "two pieces");
}
