//! Tests of commands that cut meshes with a boundary, and of `--caps`.

use crate::common::{cut, incise, text};
use incise_mesh::{TriangleId, icosphere, sheet, write_obj};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Writes a square cloth of 1 m in the plane z = 0.
fn cloth(folder: &Path) -> PathBuf {
    let path = folder.join("cloth.obj");
    write_obj(&path, &sheet([1.0, 1.0], [8, 8])).unwrap();
    path
}

/// Writes a ball of radius 0.5 m with a hole at one triangle.
fn scan(folder: &Path) -> PathBuf {
    let path = folder.join("scan.obj");
    let mut ball = icosphere(2, 0.5);
    let top = |t: &TriangleId| ball.triangle_positions(*t).iter().all(|p| p.y > 0.4);
    let top: Vec<TriangleId> = ball.topology().triangles().filter(top).take(1).collect();
    ball.remove_triangles(&top);
    write_obj(&path, &ball).unwrap();
    path
}

fn numbers(report: &Value, field: &str) -> Vec<u64> {
    let pieces = report["pieces"].as_array().unwrap().iter();
    pieces.map(|piece| piece[field].as_u64().unwrap()).collect()
}

#[test]
fn a_sheet_is_cut_in_two_without_caps() {
    let folder = tempfile::tempdir().unwrap();
    let (input, out) = (cloth(folder.path()), folder.path().join("out"));
    let (code, report, error) = cut(&input, &out, &["--plane", "1,0.1,0,0.03"]);
    assert_eq!((code, error.as_str()), (Some(0), ""));
    assert_eq!(
        (&report["boundary_edges"], &report["caps"]),
        (&32.into(), &"bodies".into())
    );
    assert_eq!(
        (&report["volume"], &report["cap_triangles"]),
        (&0.0.into(), &0.into())
    );
    assert!(
        numbers(&report, "boundary_edges")
            .iter()
            .all(|&edges| edges > 20)
    );
    assert_eq!(numbers(&report, "euler_characteristic"), [1, 1]);
    let areas = report["pieces"].as_array().unwrap().iter();
    let area: f64 = areas.map(|piece| piece["area"].as_f64().unwrap()).sum();
    assert!((area - 1.0).abs() < 1e-6, "{area}");
    let plane = ["--plane", "1,0.1,0,0.03", "-o", text(&out)];
    let told = incise(&[&["cut", text(&input)], &plane[..]].concat()).stdout;
    let told = String::from_utf8(told).unwrap();
    assert!(
        told.contains("32 boundary edges: parts with a boundary"),
        "{told}"
    );
    let (code, _, error) = cut(
        &input,
        &out,
        &["--plane", "1,0,0,0.03", "--method", "paper"],
    );
    assert_eq!(code, Some(1), "{error}");
    let (code, _, error) = cut(&input, &out, &["--plane", "0,0,1,3"]);
    assert_eq!(code, Some(4), "{error}");
}

#[test]
fn caps_close_the_chosen_curves() {
    let folder = tempfile::tempdir().unwrap();
    let (input, out) = (scan(folder.path()), folder.path().join("out"));
    let mut edges = Vec::new();
    for caps in ["bodies", "all-loops", "none"] {
        let (code, report, error) = cut(&input, &out, &["--plane", "0,1,0,0.03", "--caps", caps]);
        assert_eq!(code, Some(0), "{error}");
        assert_eq!(report["caps"], caps);
        let has_caps = report["cap_triangles"].as_u64() > Some(0);
        assert_eq!(has_caps, caps == "all-loops", "{caps}");
        let mut open = numbers(&report, "boundary_edges");
        open.sort_unstable();
        edges.push(open);
    }
    assert_eq!(edges[0], edges[2]);
    assert_eq!(edges[1], [0, 3], "only the hole stays open");
    let ball = folder.path().join("ball.obj");
    write_obj(&ball, &icosphere(2, 0.5)).unwrap();
    let (code, report, error) = cut(&ball, &out, &["--plane", "0,1,0,0.03", "--caps", "none"]);
    assert_eq!(code, Some(0), "{error}");
    assert_eq!(report["cap_triangles"], 0);
    assert!(
        numbers(&report, "boundary_edges")
            .iter()
            .all(|&edges| edges > 0)
    );
}

/// Writes a blade across the sheet that moves along x, from outside to `end` \[m\].
fn knife(folder: &Path, end: f64) -> PathBuf {
    let path = folder.join("knife.txt");
    let pose = |i: u32| {
        let x = -0.6 + (end + 0.6) * f64::from(i) / 12.0;
        format!("{x} 0.013 -1 {x} 0.013 1\n")
    };
    std::fs::write(&path, (0..=12).map(pose).collect::<String>()).unwrap();
    path
}

#[test]
fn a_path_slits_a_sheet() {
    let folder = tempfile::tempdir().unwrap();
    let (input, out) = (cloth(folder.path()), folder.path().join("out"));
    for (end, pieces) in [(0.1, 1), (0.6, 2)] {
        let path = knife(folder.path(), end);
        let (code, report, error) = cut(&input, &out, &["--path", text(&path)]);
        assert_eq!(code, Some(0), "{error}");
        assert_eq!(numbers(&report, "euler_characteristic"), vec![1; pieces]);
        assert_eq!(report["tips"].as_u64() > Some(0), pieces == 1);
        assert_eq!(report["wall_triangles"], 0);
    }
}

#[test]
fn a_falling_sheet_is_cut() {
    let folder = tempfile::tempdir().unwrap();
    let (input, out) = (cloth(folder.path()), folder.path().join("out"));
    let simulate = [
        "simulate",
        text(&input),
        "--seconds",
        "0.2",
        "--json",
        "-o",
        text(&out),
    ];
    for more in [
        &["--plane", "1,0.1,0,0.03"][..],
        &["--plane", "1,0.1,0,0.03", "--material", "shell"],
    ] {
        let done = incise(&[&simulate[..], more].concat());
        assert_eq!(done.status.code(), Some(0), "{done:?}");
        let report: Value = serde_json::from_slice(&done.stdout).unwrap();
        assert_eq!(numbers(&report, "euler_characteristic"), [1, 1]);
        assert!(
            numbers(&report, "boundary_edges")
                .iter()
                .all(|&edges| edges > 20)
        );
    }
    let done = incise(&[&simulate[..], &["--caps", "none"]].concat());
    assert_eq!(done.status.code(), Some(2), "without a cut");
}
