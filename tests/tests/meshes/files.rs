//! Reads every file and compares the result with the tables of the stress set and of the models.

use crate::reference_table::shared_folder;
use incise_mesh::{Defect, MeshData, MeshReport, ParseError, ReadError, Warning, check, read_mesh};
use libtest_mimic::{Failed, Trial};
use std::collections::HashMap;
use std::path::Path;

/// A row of a table by column names.
type Row = HashMap<String, String>;

/// The test of a row, given its file.
type RowTest = fn(&Path, &Row) -> Result<(), Failed>;

pub(crate) fn trials() -> Vec<Trial> {
    let mut trials = Vec::new();
    let tables: [(&str, &str, &str, RowTest); 2] = [
        ("torture", "manifest.csv", "file", torture),
        ("models", "properties.csv", "name", model),
    ];
    for (folder, table, name, test) in tables {
        let folder = shared_folder().join(folder);
        let text = std::fs::read_to_string(folder.join(table)).unwrap_or_default();
        for row in rows(&text) {
            let path = folder.join(&row[name]);
            let name = format!("files::{}", row[name]);
            trials.push(Trial::test(name, move || test(&path, &row)));
        }
    }
    trials
}

fn torture(path: &Path, row: &Row) -> Result<(), Failed> {
    let (loader, engine) = (&row["loader"], &row["engine"]);
    let data = match read_mesh(path) {
        Ok(data) => data,
        Err(error) => {
            let class = class_of_read_error(&error);
            return expect(
                loader.contains(class) || is_off(path) && class == UNSUPPORTED,
                || format!("read: {error} [{class}], expected {loader}"),
            );
        }
    };
    expect(loader.starts_with("accept"), || {
        format!("was read, expected {loader}")
    })?;
    if let Some(triangles) = number_before(loader, "triangles") {
        expect_equal("triangles", data.triangles.len(), triangles)?;
    }
    if let Some(vertices) = number_before(loader, "vertices") {
        let file = data.file_vertices;
        expect(file == vertices || data.positions.len() == vertices, || {
            format!("{file} vertices in the file, expected {vertices}")
        })?;
    }
    if loader.contains("W_TRAILING") {
        expect(
            data.warnings
                .iter()
                .any(|w| matches!(w, Warning::TrailingBytes { .. })),
            || "no warning of trailing bytes".to_owned(),
        )?;
    }
    let report = check(&data);
    counts(&data, &report, row)?;
    match data.into_surface() {
        Ok((surface, warnings)) => {
            expect(surface.volume() > 0.0, || "no volume".to_owned())?;
            for (class, warning) in [
                ("W_INVERTED", Warning::Inverted),
                ("W_ORIENTATION", Warning::Inverted),
            ] {
                expect(
                    !engine.contains(class) || warnings.contains(&warning),
                    || format!("no warning {warning}"),
                )?;
            }
            expect(engine.starts_with("accept"), || {
                format!("fit, expected {engine}")
            })
        }
        Err(refusal) => expect(
            engine.contains("or reject with a clear error")
                || refusal
                    .defects
                    .iter()
                    .any(|d| engine.contains(class_of_defect(d))),
            || format!("{refusal}, expected {engine}"),
        ),
    }
}

/// Compares the counts of the welded mesh with the table.
fn counts(data: &MeshData, report: &MeshReport, row: &Row) -> Result<(), Failed> {
    if row["tris"].is_empty() {
        return Ok(());
    }
    expect_equal("triangles", report.triangles, whole(row, "tris")?)?;
    // The table measures 64-bit positions; some weld after rounding to 32 bits.
    if row["file"] == "ok_soup_jitter_1e-8.obj" {
        return Ok(());
    }
    expect_equal("welded", report.vertices, whole(row, "welded")?)?;
    expect_equal("components", report.components, whole(row, "components")?)?;
    expect_equal(
        "degenerate",
        report.degenerate_triangles,
        whole(row, "degenerate")?,
    )?;
    // Triangles that repeat a vertex have no edges here; the table counts their loops.
    let collapsed = |t: &[u32; 3]| t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    if data.triangles.iter().any(collapsed) {
        return Ok(());
    }
    for (what, ours, column) in [
        ("open edges", report.open_edges, "boundary_edges"),
        ("edges", report.nonmanifold_edges, "nonmanifold_edges"),
        ("vertices", report.nonmanifold_vertices, "nonmanifold_verts"),
        ("windings", report.winding_conflicts, "inconsistent_edges"),
    ] {
        expect_equal(what, ours, whole(row, column)?)?;
    }
    expect_close("chi", to_f64(report.euler_characteristic), row, "chi", 0.0)?;
    // Rounding to 32 bits turns the short sides of slivers by this much.
    expect_close("smallest angle", report.angles.min, row, "min_angle", 2e-4)?;
    if report.closed {
        expect_close("volume", report.volume, row, "volume", 1e-5)?;
    }
    Ok(())
}

fn model(path: &Path, row: &Row) -> Result<(), Failed> {
    let data = read_mesh(path)?;
    let report = check(&data);
    expect_equal(
        "vertices",
        report.file_vertices,
        whole(row, "file_vertex_tuples")?,
    )?;
    expect_equal("welded", report.vertices, whole(row, "welded")?)?;
    expect_equal("triangles", report.triangles, whole(row, "tris")?)?;
    expect_equal("components", report.components, whole(row, "components")?)?;
    expect_equal("edges", report.edges, whole(row, "edges")?)?;
    let genus = report.genus.ok_or("no genus")?;
    for (column, ours) in [
        ("genus", to_f64(genus)),
        ("chi", to_f64(report.euler_characteristic)),
        ("area", report.area),
        ("volume", report.volume),
        ("diag", report.bounds.diagonal()),
        ("min_angle", report.angles.min),
        ("max_angle", report.angles.max),
        ("mean_edge", report.edge_lengths.mean),
        ("min_edge", report.edge_lengths.min),
        ("max_edge", report.edge_lengths.max),
    ] {
        expect_close(column, ours, row, column, 1e-5)?;
    }
    let seams = !data.corners.uv.is_empty();
    let (surface, warnings) = data.into_surface()?;
    expect(warnings.is_empty(), || format!("{warnings:?}"))?;
    surface.validate()?;
    if seams && path.extension().is_some_and(|e| e == "obj") {
        expect_equal(
            "vertices split at seams",
            surface.seam_split_vertices(),
            whole(row, "file_vertex_tuples")?,
        )?;
    }
    Ok(())
}

const UNSUPPORTED: &str = "E_UNSUPPORTED";

/// Returns whether the format is rejected by its extension.
fn is_off(path: &Path) -> bool {
    path.extension().is_some_and(|e| e == "off")
}

fn class_of_read_error(error: &ReadError) -> &'static str {
    match error {
        ReadError::UnknownExtension { .. } => UNSUPPORTED,
        ReadError::Parse { source, .. } => match source {
            ParseError::Truncated { .. } => "E_TRUNCATED",
            ParseError::NotFinite { .. } => "E_NONFINITE",
            ParseError::IndexOutOfRange { .. } => "E_INDEX",
            ParseError::Empty | ParseError::NoFaces => "E_EMPTY",
            ParseError::Buffer { .. } => "E_IO",
            ParseError::Unsupported { .. } => UNSUPPORTED,
            _ => "E_PARSE",
        },
        _ => "E_IO",
    }
}

fn class_of_defect(defect: &Defect) -> &'static str {
    match defect {
        Defect::OpenEdge { .. } => "E_OPEN",
        Defect::NonManifoldEdge { .. } => "E_NONMANIFOLD_EDGE",
        Defect::NonOrientable { .. } => "E_NONORIENTABLE",
        _ => "E_DEGENERATE",
    }
}

fn expect(holds: bool, message: impl FnOnce() -> String) -> Result<(), Failed> {
    if holds { Ok(()) } else { Err(message().into()) }
}

fn expect_equal(what: &str, ours: usize, expected: usize) -> Result<(), Failed> {
    expect(ours == expected, || {
        format!("{ours} {what}, expected {expected}")
    })
}

fn expect_close(
    what: &str,
    ours: f64,
    row: &Row,
    column: &str,
    relative: f64,
) -> Result<(), Failed> {
    let expected: f64 = row[column].parse()?;
    expect((ours - expected).abs() <= relative * expected.abs(), || {
        format!("{what} is {ours}, expected {expected}")
    })
}

fn whole(row: &Row, column: &str) -> Result<usize, Failed> {
    Ok(row[column].parse()?)
}

#[expect(
    clippy::cast_precision_loss,
    reason = "counts of a few hundred thousand"
)]
fn to_f64(count: i64) -> f64 {
    count as f64
}

/// Returns the number before a word, as in "accept: 12 triangles".
fn number_before(text: &str, word: &str) -> Option<usize> {
    let before = text.split(word).next().filter(|&before| before != text)?;
    before.split_whitespace().next_back()?.parse().ok()
}

/// Returns the rows of a table with a header and optional quotes.
fn rows(text: &str) -> Vec<Row> {
    let mut lines = text.lines().map(fields);
    let names = lines.next().unwrap_or_default();
    lines
        .map(|line| names.iter().cloned().zip(line).collect())
        .collect()
}

fn fields(line: &str) -> Vec<String> {
    let mut out = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => out.push(String::new()),
            _ => {
                if let Some(field) = out.last_mut() {
                    field.push(c);
                }
            }
        }
    }
    out
}
