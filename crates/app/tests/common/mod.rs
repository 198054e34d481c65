//! Fixtures that the tests of the program share.

use std::path::Path;
use std::process::{Command, Output};

/// Runs the program.
pub(crate) fn incise(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_incise"))
        .args(arguments)
        .output()
        .unwrap()
}

/// A path as an argument.
pub(crate) fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// Cuts and returns the exit code, the report, and the messages on the standard error.
pub(crate) fn cut(
    input: &Path,
    output: &Path,
    more: &[&str],
) -> (Option<i32>, serde_json::Value, String) {
    let mut arguments = vec!["cut", text(input), "-o", text(output), "--json"];
    arguments.extend(more);
    let output = incise(&arguments);
    let report = serde_json::from_slice(&output.stdout).unwrap_or_default();
    (output.status.code(), report, messages(&output))
}

/// Returns the standard error of a run with `--json`, with the error's text in place of its JSON.
pub(crate) fn messages(output: &Output) -> String {
    let text = String::from_utf8(output.stderr.clone()).unwrap();
    let line = |line: &str| {
        let json = serde_json::from_str::<serde_json::Value>(line).ok();
        let error = json.and_then(|json| Some(json["error"].as_str()?.to_owned()));
        error.unwrap_or_else(|| line.to_owned())
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}
