//! Tests of `incise simulate --path`: a blade that moves through a body in motion.

use incise_mesh::{Surface, read_mesh, write_obj};
use incise_models::{Model, build_model};
use serde_json::Value;
use std::path::{Path, PathBuf};
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

/// Writes a blade along z in one pose per frame, from x = -0.71 m to `end`.
///
/// It falls with bodies, which fall since `start` frames before the first pose.
fn knife(folder: &Path, end: f64, start: u32, frames: u32) -> PathBuf {
    let pose = |frame: u32| {
        let time = f64::from(start + frame) / 60.0;
        let x = -0.71 + (end + 0.71) * f64::from(frame) / f64::from(frames - 1);
        let y = 0.013 - 0.5 * 9.81 * time * time;
        format!("{x} {y} -2 {x} {y} 2\n")
    };
    let path = folder.join("knife.txt");
    std::fs::write(&path, (0..frames).map(pose).collect::<String>()).unwrap();
    path
}

/// Simulates a ball of radius 0.5 m and returns the exit code, the report and the messages.
fn simulate(folder: &Path, path: &Path, more: &[&str]) -> (Option<i32>, Value, String) {
    let out = folder.join("out");
    let arguments = [
        "simulate",
        "Sphere768",
        "--path",
        text(path),
        "-o",
        text(&out),
    ];
    let done = incise(&[&arguments[..], &["--json"], more].concat());
    let report = serde_json::from_slice(&done.stdout).unwrap_or_default();
    (
        done.status.code(),
        report,
        String::from_utf8(done.stderr).unwrap(),
    )
}

fn piece(folder: &Path, number: u32) -> Surface {
    let data = read_mesh(&folder.join(format!("out/piece_{number:03}.obj"))).unwrap();
    data.into_surface().unwrap().0
}

#[test]
fn a_falling_ball_is_cut_in_two_by_a_blade_that_falls_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = knife(folder.path(), 0.73, 0, 40);
    let more = ["--seconds", "1"];
    let (code, report, error) = simulate(folder.path(), &path, &more);
    assert_eq!(code, Some(0), "{error}");
    assert_eq!(
        (&report["frames"], &report["steps"]),
        (&60.into(), &39.into())
    );
    assert!(report["cutting_steps"].as_u64() > Some(3), "{report}");
    let pieces = report["pieces"].as_array().unwrap();
    assert_eq!(pieces.len(), 2, "{report}");
    let volumes = pieces.iter().map(|piece| piece["volume"].as_f64().unwrap());
    let whole = build_model(Model::Sphere768).volume();
    assert!(
        (volumes.sum::<f64>() / whole - 1.0).abs() < 0.02,
        "{report}"
    );
    for number in 0..2 {
        assert!(piece(folder.path(), number).topology().is_closed());
    }
}

#[test]
fn a_blade_that_stops_inside_leaves_one_piece_with_walls() {
    let folder = tempfile::tempdir().unwrap();
    let path = knife(folder.path(), 0.07, 6, 20);
    for contacts in [&[][..], &["--no-contacts"]] {
        let more = [&["--seconds", "1", "--at", "0.1"], contacts].concat();
        let (code, report, error) = simulate(folder.path(), &path, &more);
        assert_eq!(code, Some(0), "{error}");
        let pieces = report["pieces"].as_array().unwrap();
        assert_eq!(pieces.len(), 1, "{report}");
        assert_eq!(pieces[0]["euler_characteristic"], 2);
        let surface = piece(folder.path(), 0);
        let is_wall = |&t: &_| surface.material(t) == 1;
        assert!(surface.topology().triangles().any(|t| is_wall(&t)));
        let volume = surface.volume() / build_model(Model::Sphere768).volume();
        assert!((volume - 1.0).abs() < 0.02, "{volume}");
    }
}

#[test]
fn a_body_far_from_the_origin_is_cut_in_the_coordinates_of_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let mut ball = build_model(Model::Sphere768);
    ball.set_origin([1e6, 0.0, 0.0]);
    let input = folder.path().join("ball.obj");
    write_obj(&input, &ball).unwrap();
    let path = folder.path().join("knife.txt");
    std::fs::write(
        &path,
        "999999 0.1 -1 999999 0.1 1\n1000001 0.1 -1 1000001 0.1 1\n",
    )
    .unwrap();
    let out = folder.path().join("out");
    let arguments = [
        "simulate",
        text(&input),
        "--path",
        text(&path),
        "-o",
        text(&out),
    ];
    let done = incise(&[&arguments[..], &["--seconds", "0.1", "--json"]].concat());
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    let report: Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(report["pieces"].as_array().unwrap().len(), 2);
    assert_eq!(report["cutting_steps"], 1);
}

#[test]
fn a_step_that_cannot_be_cut_is_skipped() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("turned");
    // The second step turns into a wall of the first one's incision.
    let lines = "-0.8 0 -1 -0.8 0 1\n0.1 0 -1 0.1 0 1\n-0.3 0.2 -1 -0.3 -0.2 1\n";
    std::fs::write(&path, lines).unwrap();
    let (code, report, error) = simulate(folder.path(), &path, &["--seconds", "0.2"]);
    assert_eq!(code, Some(0), "{error}");
    let refused = report["failed_cuts"].as_array().unwrap();
    assert_eq!(refused.len(), 1);
    let refused = refused[0].as_str().unwrap();
    assert!(refused.contains("line 3, at 0.033 s: "), "{refused}");
    assert!(refused.contains("goes on without this step"), "{refused}");
    assert_eq!(report["cutting_steps"], 1);
    assert_eq!(report["pieces"].as_array().unwrap().len(), 1);
}

#[test]
fn refusals_name_the_reason_and_write_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, lines: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, lines).unwrap();
        path
    };
    let straight = write("straight", "-1 0 -1 -1 0 1\n1 0 -1 1 0 1\n");
    let curved = write("curved", "-1 0 -1 -1 0 1 -1 0 2\n1 0 -1 1 0 1 1 0 2\n");
    let inside = write("inside", "0 0 -0.1 0 0 0.1\n\n0.1 0 -0.1 0.1 0 0.1\n");
    let beside = write("beside", "3 0 -1 3 0 1\n4 0 -1 4 0 1\n");
    let second = ["--seconds", "1"];
    for (path, more, exit, said) in [
        (
            &straight,
            &["--seconds", "0.02"][..],
            2,
            "give --seconds 0.03",
        ),
        (
            &straight,
            &["--seconds", "1", "--at", "1"],
            2,
            "--at is not before the end",
        ),
        (
            &straight,
            &["--seconds", "1", "--plane", "1,0,0,0"],
            2,
            "cannot be used with",
        ),
        (&curved, &second, 1, "line 1: the blade has 3 points"),
        (
            &inside,
            &second,
            1,
            "line 3: the blade moves inside the body",
        ),
        (&beside, &second, 4, "the cut misses the mesh"),
    ] {
        let (code, _, error) = simulate(folder.path(), path, more);
        assert_eq!(code, Some(exit), "{error}");
        assert!(error.contains(said), "{error}");
        assert_eq!(folder.path().join("out").exists(), exit == 4, "{error}");
    }
}
