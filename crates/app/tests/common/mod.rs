//! Fixtures that the tests of the program share.

use incise_mesh::Surface;
use incise_models::{Model, build_model};
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

/// A sphere of 80 triangles and, inside it, one a fifth as large and inside out.
pub(crate) fn hollow_sphere() -> Surface {
    let sphere = build_model(Model::Sphere80);
    let topology = sphere.topology();
    let mut points: Vec<[f32; 3]> = sphere
        .positions()
        .iter()
        .map(|&[x, y, z, _]| [x, y, z])
        .collect();
    let mut faces: Vec<[u32; 3]> = topology
        .triangles()
        .map(|t| topology.triangle(t).map(|v| v.0))
        .collect();
    let offset = u32::try_from(points.len()).unwrap();
    points.extend(points.clone().iter().map(|p| p.map(|c| c / 5.0)));
    faces.extend(
        faces
            .clone()
            .iter()
            .map(|&[a, b, c]| [a, c, b].map(|v| v + offset)),
    );
    Surface::from_triangles(&points, &faces).unwrap()
}
