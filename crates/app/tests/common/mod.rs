//! What tests of the program share.

use incise_mesh::{Model, Surface, build_model};
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

/// Cuts and returns the exit code, the report and what the program complained about.
pub(crate) fn cut(
    input: &Path,
    output: &Path,
    more: &[&str],
) -> (Option<i32>, serde_json::Value, String) {
    let mut arguments = vec!["cut", text(input), "-o", text(output), "--json"];
    arguments.extend(more);
    let output = incise(&arguments);
    let report = serde_json::from_slice(&output.stdout).unwrap_or_default();
    let error = String::from_utf8(output.stderr).unwrap();
    (output.status.code(), report, error)
}

/// A sphere of 80 triangles and, inside it, one a fifth as large and inside out.
pub(crate) fn hollow_sphere() -> Surface {
    let sphere = build_model(Model::Sphere80);
    let topology = sphere.topology();
    let mut points: Vec<[f32; 3]> = sphere
        .positions
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
