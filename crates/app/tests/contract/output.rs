//! Output of the program: reports on the standard output, messages on the standard error.

use incise_mesh::write_obj;
use incise_models::{Model, build_model};
use std::path::Path;
use std::process::{Command, Output};

fn incise(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_incise"));
    command.args(arguments).output().unwrap()
}

/// Returns standard output and standard error of a run that must succeed.
fn outputs(arguments: &[&str]) -> [String; 2] {
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
fn long_commands_print_progress_lines_without_a_terminal() {
    let (folder, input) = with_sphere();
    let out = folder.path().join("out");
    let [report, progress] = outputs(&simulate(&input, &out, &[]));
    assert!(report.contains("150 frames"), "{report}");
    let lines: Vec<&str> = progress.lines().collect();
    let expected = ["1/3 from 0.000 s", "2/3 from 1.000 s", "3/3 from 2.000 s"];
    assert_eq!(lines, expected);
}

#[test]
fn quiet_commands_print_json_and_errors_only() {
    let (folder, input) = with_sphere();
    let out = folder.path().join("out");
    for quiet in ["--quiet", "-q"] {
        let printed = outputs(&simulate(&input, &out, &[quiet]));
        assert_eq!(printed, ["", ""], "{quiet}");
        assert!(out.join("piece_000.obj").exists(), "it is done");
    }
    let [report, progress] = outputs(&simulate(&input, &out, &["--json"]));
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!((&report["frames"], progress.as_str()), (&150.into(), ""));
    for command in [&["check", &input][..], &["-q", "check", &input]] {
        let is_quiet = command[0] == "-q";
        assert_eq!(outputs(command)[0].is_empty(), is_quiet, "{command:?}");
    }
    let refused = incise(&["--quiet", "check", "/nonexistent.obj"]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(!refused.stderr.is_empty(), "errors are printed");
}

#[test]
fn completions_name_commands_and_options() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let [script, _] = outputs(&["completions", shell, "--quiet"]);
        for word in ["simulate", "max-triangles", "quiet"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
}

#[test]
fn help_lists_every_command_and_its_example_runs() {
    let [help, _] = outputs(&["--help"]);
    for command in ["check", "cut", "devices", "fill", "simulate", "completions"] {
        assert!(help.contains(&format!("\n  {command}")), "{help}");
        let [of, _] = outputs(&["help", command]);
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
    outputs(&words.collect::<Vec<_>>());
    assert!(out.join("piece_001.obj").exists(), "two pieces");
}

/// The one line of JSON on the standard error of a run that must fail.
fn error(arguments: &[&str]) -> (Option<i32>, serde_json::Value) {
    let done = incise(arguments);
    let stderr = String::from_utf8(done.stderr).unwrap();
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
    (done.status.code(), serde_json::from_str(&stderr).unwrap())
}

#[test]
fn errors_are_json_with_the_option() {
    let (folder, input) = with_sphere();
    let out = folder.path().join("out");
    let cut = ["cut", &input, "-o", out.to_str().unwrap(), "--json"];
    for (more, code, message) in [
        (&["--plane", "1,0,0,9"][..], 4, "misses the mesh"),
        (&["--plane", "0,0,0,1"], 2, "no area"),
        (&["--plane", "1,0,0"], 2, "found 3 numbers"),
        (&[], 2, "--plane"),
    ] {
        let (exit_code, json) = error(&[&cut[..], more].concat());
        assert_eq!((exit_code, &json["exit_code"]), (Some(code), &code.into()));
        let text = json["error"].as_str().unwrap();
        assert!(text.contains(message), "{more:?}: {text}");
        assert!(
            !text.starts_with("error") && !text.contains("For more"),
            "{text}"
        );
    }
    let (code, json) = error(&["--json", "check", "/nonexistent.obj"]);
    assert_eq!((code, &json["exit_code"]), (Some(1), &1.into()));
}

#[test]
fn a_dash_is_not_an_output() {
    let (_folder, input) = with_sphere();
    for command in [
        &["cut", &input, "--plane", "1,0,0,0"][..],
        &["fill", &input],
        &["simulate", &input, "--seconds", "0.1"],
        #[cfg(feature = "gpu")]
        &["render", &input],
        #[cfg(feature = "gpu")]
        &["gallery"],
    ] {
        let (code, json) = error(&[command, &["-o", "-", "--json"]].concat());
        assert_eq!(code, Some(2), "{command:?}: {json}");
        let text = json["error"].as_str().unwrap();
        assert!(text.contains("standard output is not supported"), "{text}");
        assert!(!Path::new("-").exists(), "{command:?} writes nothing");
    }
}
