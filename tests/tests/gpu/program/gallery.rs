//! Tests of `incise gallery`: every figure, its index and determinism.

use super::image::pixels;
use super::{incise, text};
use incise_pbd_gpu::Context;
use incise_render::FigureGrid;
use serde_json::Value;
use std::path::Path;

/// Names of all figures: those of the paper that show models, then textures.
const NAMES: [&str; 13] = [
    "fig1", "fig4", "fig5", "fig6", "fig7", "fig8", "fig9", "fig10", "figA1", "figA2", "figA3",
    "figA4", "texture",
];

/// Figures that take a fraction of a second.
const FEW: [&str; 3] = ["fig1", "fig5", "fig7"];

/// Width and height of a panel \[px\].
const SIZE: u32 = 96;

/// Index entry and pixels of a panel.
type Panel = (Value, Vec<[u8; 4]>);

/// Draws figures with panels of `size` by `size` pixels and returns the index.
fn gallery(folder: &Path, size: u32, only: &str) -> Value {
    let size = size.to_string();
    let mut arguments = vec!["gallery", "-o", text(folder), "--size", &size, "--json"];
    if !only.is_empty() {
        arguments.extend(["--only", only]);
    }
    let output = incise(&arguments);
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{error}");
    let file = std::fs::read(folder.join("index.json")).expect("an index");
    assert_eq!(file, output.stdout, "what is printed is what is written");
    serde_json::from_slice(&file).expect("JSON")
}

/// Returns the rows of panels of a figure.
fn panels(folder: &Path, size: u32, figure: &Value) -> Vec<Vec<Panel>> {
    let rows = figure["rows"].as_array().expect("rows");
    let row = |row: &Value| row.as_array().expect("panels").clone();
    let rows: Vec<Vec<Value>> = rows.iter().map(row).collect();
    let count = |n: usize| u32::try_from(n).expect("a few");
    let columns = count(rows.iter().map(Vec::len).max().expect("a row"));
    let file = figure["file"].as_str().expect("a name");
    let (width, height, all) = pixels(&folder.join(file));
    let promised = FigureGrid::size([size; 2], columns, count(rows.len()));
    assert_eq!([width, height], promised, "{file}");
    assert_eq!(
        (&figure["width"], &figure["height"]),
        (&width.into(), &height.into())
    );
    let sheet = FigureGrid::new([size; 2], columns, count(rows.len())).expect("a size");
    let cut = |c: usize, r: usize| {
        let [left, top] = sheet
            .corner(count(c), count(r))
            .map(|x| usize::try_from(x).expect("inside"));
        let rows = (top..top + size as usize).map(|y| y * width as usize + left);
        rows.flat_map(|at| all[at..at + size as usize].to_vec())
            .collect()
    };
    let with_pixels = |r: usize, row: Vec<Value>| {
        let panels = row.into_iter().enumerate();
        panels.map(|(c, panel)| (panel, cut(c, r))).collect()
    };
    let rows = rows.into_iter().enumerate();
    rows.map(|(r, row)| with_pixels(r, row)).collect()
}

/// Returns the number of pixels that differ from the background.
fn drawn(panel: &[[u8; 4]]) -> usize {
    panel.iter().filter(|&&pixel| pixel != [255; 4]).count()
}

/// A few figures of small models have their panels, and a second run writes the same bytes.
pub(crate) fn few(_: Context) {
    let (folder, again) = (tempdir(), tempdir());
    figures_are_made(folder.path(), "fig1,FIG5,fig7", &FEW);
    gallery(again.path(), SIZE, "fig1,fig5,fig7");
    for entry in std::fs::read_dir(folder.path()).expect("a folder") {
        let name = entry.expect("an entry").file_name();
        let [first, second] = [&folder, &again].map(|folder| folder.path().join(&name));
        let [first, second] = [first, second].map(|path| std::fs::read(path).expect("a figure"));
        assert!(first == second, "{}", name.display());
    }
}

/// Every figure has its panels.
pub(crate) fn all(_: Context) {
    figures_are_made(tempdir().path(), "", &NAMES);
}

fn tempdir() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

/// Asserts that figures of these names are made, with panels that differ.
fn figures_are_made(folder: &Path, only: &str, expected: &[&str]) {
    let index = gallery(folder, SIZE, only);
    let figures = index["figures"].as_array().expect("figures");
    let names: Vec<&str> = figures.iter().filter_map(|f| f["name"].as_str()).collect();
    assert_eq!(names, expected);
    let files = std::fs::read_dir(folder).expect("a folder").count();
    assert_eq!(files, names.len() + 1, "a picture each, and the index");
    for figure in figures {
        let name = figure["name"].as_str().expect("a name");
        let rows = panels(folder, SIZE, figure);
        for (panel, pixels) in rows.iter().flatten() {
            assert!(drawn(pixels) > pixels.len() / 60, "{name} {panel}");
        }
        for row in rows.iter().filter(|row| row.len() == 5) {
            levels_differ(name, row);
        }
    }
}

/// Asserts that finer levels of the paper's method have more triangles, and that all panels show
/// the same half of the body.
fn levels_differ(name: &str, row: &[Panel]) {
    let number = |panel: &Panel, key: &str| panel.0[key].as_u64().expect("a number");
    let caps: Vec<u64> = row
        .iter()
        .map(|panel| number(panel, "cap_triangles"))
        .collect();
    let command = row[0].0["command"].as_str().expect("a command");
    if command.contains("--method paper") {
        assert!(caps.is_sorted_by(|a, b| a <= b), "{name} {caps:?}");
        assert!(caps[0] < caps[4], "{name} {caps:?}");
    }
    let skin = |panel: &Panel| number(panel, "triangles") - number(panel, "cap_triangles");
    for panel in row {
        assert_eq!(number(panel, "pieces"), 2, "{name}");
        assert!(number(panel, "cap_triangles") > 0, "{name}");
        assert_eq!(skin(panel), skin(&row[0]), "{name}");
    }
}
