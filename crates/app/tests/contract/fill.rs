//! Tests of `incise fill`: reports, fairing, limits and errors.

use incise_mesh::{Surface, TriangleId, check, icosphere, read_mesh, write_obj};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

fn incise(folder: &TempDir, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_incise"))
        .current_dir(folder.path())
        .args(arguments)
        .output()
        .unwrap()
}

/// Writes a sphere with two holes, a large cap and one triangle, to a new folder.
fn open_sphere() -> (TempDir, Surface) {
    let mut body = icosphere(3, 1.0);
    let topology = body.topology();
    let is_cap = |t: &TriangleId| body.triangle_positions(*t).iter().all(|p| p.z > 0.8);
    let mut gone: Vec<TriangleId> = topology.triangles().filter(is_cap).collect();
    assert!(gone.len() > 50, "a cap of {} triangles", gone.len());
    let lower = |t: &TriangleId| body.triangle_positions(*t).iter().all(|p| p.z < -0.5);
    gone.extend(topology.triangles().find(lower));
    let unused = body.remove_triangles(&gone);
    body.remove_vertices(&unused);
    let folder = tempfile::tempdir().unwrap();
    write_obj(&folder.path().join("open.obj"), &body).unwrap();
    (folder, body)
}

fn json(folder: &TempDir, arguments: &[&str]) -> Value {
    let output = incise(folder, arguments);
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{error}");
    assert!(error.is_empty(), "{error}");
    serde_json::from_slice(&output.stdout).unwrap()
}

fn refusal(folder: &TempDir, arguments: &[&str], code: i32) -> String {
    let output = incise(folder, arguments);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{error}");
    assert!(
        !folder.path().join("out.obj").exists(),
        "nothing is written"
    );
    error
}

fn is_fit(path: &Path) -> bool {
    check(&read_mesh(path).unwrap()).is_cuttable().is_ok()
}

#[test]
fn the_report_lists_every_closed_hole() {
    let (folder, body) = open_sphere();
    let output = incise(&folder, &["fill", "open.obj", "-o", "out.obj"]);
    assert_eq!(output.status.code(), Some(0));
    let text = String::from_utf8(output.stdout).unwrap();
    let before = body.topology().triangle_count();
    let head = format!("open.obj: {before} triangles, 2 holes closed, 0 left open");
    assert_eq!(text.lines().next(), Some(head.as_str()));
    assert!(
        text.lines()
            .any(|l| l.starts_with("  3 edges at [") && l.contains(", planar,")),
        "{text}"
    );
    assert!(text.contains("closed, volume"), "{text}");
    assert!(!is_fit(&folder.path().join("open.obj")) && is_fit(&folder.path().join("out.obj")));
}

#[test]
fn a_faired_cap_is_rounder_and_either_format_is_written() {
    let (folder, body) = open_sphere();
    let flat = json(&folder, &["fill", "open.obj", "-o", "flat.ply", "--json"]);
    let fair = json(
        &folder,
        &["fill", "open.obj", "-o", "fair.OBJ", "--fair", "--json"],
    );
    let finer = [
        "fill",
        "open.obj",
        "-o",
        "finer.obj",
        "--level",
        "2x-finer",
        "--json",
    ];
    let finer = json(&folder, &finer);
    for report in [&flat, &fair, &finer] {
        let file = folder.path().join(report["output"].as_str().unwrap());
        assert!(is_fit(&file), "{}", file.display());
        let holes = report["holes"].as_array().unwrap();
        assert_eq!(holes.len(), 2);
        let patches: u64 = holes.iter().map(|h| h["triangles"].as_u64().unwrap()).sum();
        let before = u64::try_from(body.topology().triangle_count()).unwrap();
        assert_eq!(report["triangles"], before + patches);
        assert_eq!(report["closed"], true);
        let data = read_mesh(&file).unwrap();
        assert_eq!(data.triangles.len() as u64, before + patches);
    }
    let volume = |report: &Value| report["volume"].as_f64().unwrap();
    let whole = icosphere(3, 1.0).volume();
    let missing = |report: &Value| (whole - volume(report)).abs();
    assert!(
        missing(&fair) < 0.3 * missing(&flat),
        "{} {}",
        missing(&fair),
        missing(&flat)
    );
    assert!(finer["triangles"].as_u64() > flat["triangles"].as_u64());
}

#[test]
fn holes_above_max_rim_edges_stay_open() {
    let (folder, _) = open_sphere();
    let report = json(
        &folder,
        &[
            "fill",
            "open.obj",
            "-o",
            "out.obj",
            "--max-rim-edges",
            "3",
            "--json",
        ],
    );
    assert_eq!(
        (&report["left_open"], &report["closed"]),
        (&Value::from(1), &Value::from(false))
    );
    assert_eq!(report["holes"][0]["rim_edges"], 3);
}

#[test]
fn refusals_name_the_reason() {
    let (folder, _) = open_sphere();
    let error = refusal(
        &folder,
        &["fill", "open.obj", "-o", "out.obj", "--max-triangles", "10"],
        1,
    );
    assert!(error.contains("more than 10 triangles"), "{error}");
    let error = refusal(
        &folder,
        &["fill", "open.obj", "-o", "out.obj", "--level", "1e-6"],
        1,
    );
    assert!(error.contains("choose a coarser level"), "{error}");
    let error = refusal(
        &folder,
        &["fill", "open.obj", "-o", "out.obj", "--level", "0"],
        2,
    );
    assert!(error.contains("level.z is 0; it must be"), "{error}");
    let error = refusal(&folder, &["fill", "open.obj", "-o", "out.3mf"], 2);
    assert!(
        error.contains("out.3mf") && error.contains(".ply"),
        "{error}"
    );
    let error = refusal(&folder, &["fill", "open.obj", "-o", "./open.obj"], 3);
    assert!(error.contains("overwrite the input"), "{error}");
    let error = refusal(&folder, &["fill", "none.obj", "-o", "out.obj"], 1);
    assert!(error.contains("none.obj"), "{error}");
    let three = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 1 2 4\nf 2 1 5\n";
    std::fs::write(folder.path().join("three.obj"), three).unwrap();
    let fill = ["fill", "three.obj", "-o", "out.obj"];
    let error = refusal(&folder, &[&fill[..], &["--no-repair"]].concat(), 1);
    assert!(error.contains("more than two triangles: 1"), "{error}");
    // Three sheets by default, whose common edge is no gap to weld.
    let output = incise(&folder, &fill);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{error}");
    assert!(error.contains("detached: 3"), "{error}");
    assert!(!error.contains("weld"), "{error}");
}

/// Gaps between nearly coincident vertices are not holes: the error recommends to weld them.
#[test]
fn welding_is_recommended_for_an_unwelded_body() {
    let body = icosphere(2, 1.0);
    let topology = body.topology();
    let mut text = String::new();
    for (i, t) in (0u32..).zip(topology.triangles()) {
        for p in body.triangle_positions(t) {
            let x = p.x + 1e-5 * f64::from(i % 7);
            text += &format!("v {x} {} {}\n", p.y, p.z);
        }
        text += "f -3 -2 -1\n";
    }
    let (folder, _) = open_sphere();
    std::fs::write(folder.path().join("soup.obj"), text).unwrap();
    let output = incise(&folder, &["fill", "soup.obj", "-o", "out.obj"]);
    assert_eq!(output.status.code(), Some(0));
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(text.contains("weld vertices"), "{text}");
    let text = incise(&folder, &["fill", "open.obj", "-o", "out.obj"]).stderr;
    let text = String::from_utf8(text).unwrap();
    assert!(!text.contains("weld vertices"), "{text}");
}

/// A patch on a collinear rim has no area; the report counts its triangles.
#[test]
fn triangles_without_area_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    // A tetrahedron with a T-junction: a vertex on an edge that only one of its triangles has.
    let text = "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\nv 1 0 0\n\
                f 1 3 5\nf 5 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    std::fs::write(folder.path().join("crack.obj"), text).unwrap();
    let output = incise(&folder, &["fill", "crack.obj", "-o", "out.obj"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains("1 hole closed") && text.contains("1 triangle without area"),
        "{text}"
    );
    let report = json(&folder, &["fill", "crack.obj", "-o", "out.obj", "--json"]);
    assert_eq!(report["holes"][0]["flat_triangles"], 1);
    assert_eq!(report["closed"], true);
}

/// A filled mesh is written with outward normals, and components without volume are counted.
#[test]
fn the_filled_mesh_points_outward_and_flat_components_are_warned_of() {
    let (folder, _) = open_sphere();
    let text = std::fs::read_to_string(folder.path().join("open.obj")).unwrap();
    let turned = text.lines().map(|line| {
        let mut parts: Vec<&str> = line.split(' ').collect();
        if parts[0] == "f" {
            parts.swap(1, 2);
        }
        parts.join(" ") + "\n"
    });
    let turned: String = turned.collect();
    std::fs::write(folder.path().join("turned.obj"), &turned).unwrap();
    let report = json(&folder, &["fill", "turned.obj", "-o", "out.obj", "--json"]);
    assert!(report["volume"].as_f64().unwrap() > 0.0, "{report}");
    assert_eq!(report["warnings"][0]["kind"], "inverted", "{report}");
    let written = read_mesh(&folder.path().join("out.obj")).unwrap();
    let (written, warnings) = written.into_surface().unwrap();
    assert!(written.volume() > 0.0 && warnings.is_empty());

    let with_sheet = text + "v 5 0 0\nv 6 0 0\nv 6 1 0\nv 5 1 0\nf -4 -3 -2 -1\n";
    std::fs::write(folder.path().join("sheet.obj"), with_sheet).unwrap();
    let report = json(&folder, &["fill", "sheet.obj", "-o", "out.obj", "--json"]);
    let last = report["warnings"].as_array().unwrap().last().unwrap();
    assert_eq!(
        *last,
        serde_json::json!({ "kind": "zero_volume", "count": 1 })
    );
    let quiet = incise(&folder, &["-q", "fill", "sheet.obj", "-o", "out.obj"]);
    let told = String::from_utf8(quiet.stderr).unwrap();
    assert!(told.contains("components without volume"), "{told}");
}
