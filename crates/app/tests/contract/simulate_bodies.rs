//! Tests of `incise simulate` with several bodies and several planes.

use incise_mesh::{Vec3, read_mesh, write_obj};
use incise_models::{Model, build_model};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

/// Runs `incise simulate` with words and the output folder `out`.
fn simulate(folder: &Path, words: &str) -> Output {
    let out = folder.join("out");
    Command::new(env!("CARGO_BIN_EXE_incise"))
        .current_dir(folder)
        .arg("simulate")
        .args(words.split_whitespace())
        .args(["--json", "-o"])
        .arg(out)
        .output()
        .unwrap()
}

fn report(done: &Output) -> Value {
    serde_json::from_slice(&done.stdout).unwrap()
}

/// Returns the body of every piece.
fn bodies(report: &Value) -> Vec<u64> {
    let pieces = report["pieces"].as_array().unwrap().iter();
    pieces
        .map(|piece| piece["body"].as_u64().unwrap())
        .collect()
}

/// Returns the center of a written piece, in the coordinates of its file.
fn center(folder: &Path, number: u32) -> Vec3 {
    let file = folder.join(format!("out/piece_{number:03}.obj"));
    let (surface, _) = read_mesh(&file).unwrap().into_surface().unwrap();
    Vec3::from(surface.origin()) + surface.bounds().center()
}

#[test]
fn pieces_of_every_body_are_written_in_the_order_of_the_inputs() {
    let folder = tempfile::tempdir().unwrap();
    let words = "Sphere80 Sphere20 --offset 0,0,0 --offset 3,1,0 --seconds 0.2 --plane 0,1,0,0.05";
    let done = simulate(folder.path(), words);
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    let report = report(&done);
    assert_eq!(
        bodies(&report),
        [0, 0, 1],
        "the plane is below the second body"
    );
    assert_eq!(report["inputs"][1]["file"], "Sphere20");
    let center = |number| center(folder.path(), number);
    let fall = 0.5 * 9.81 * 0.2_f64.powi(2);
    assert!((center(2).x - 3.0).abs() < 0.01, "{}", center(2));
    assert!((center(2).y - 1.0 + fall).abs() < 0.02, "{}", center(2));
}

#[test]
fn planes_cut_in_their_order_at_once_or_each_at_its_time() {
    let folder = tempfile::tempdir().unwrap();
    let planes = "--plane 1,0,0,0.03 --plane 0,0,1,0.02";
    for (times, exit) in [
        ("", 0),
        ("--at 0.1", 0),
        ("--at 0 --at 0.2", 0),
        ("--at 0.1 --at 0.2 --at 0.25", 2),
        ("--at 0.1 --at 0.4", 2),
    ] {
        let words = format!("Sphere80 --seconds 0.3 {planes} {times}");
        let done = simulate(folder.path(), &words);
        assert_eq!(done.status.code(), Some(exit), "{times}: {done:?}");
        if exit == 0 {
            assert_eq!(bodies(&report(&done)), [0; 4], "{times}");
        }
    }
}

#[test]
fn a_plane_that_misses_is_named_and_all_that_miss_are_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let base = "Sphere80 --seconds 0.1 --plane 1,0,0,9";
    let done = simulate(folder.path(), base);
    assert_eq!(done.status.code(), Some(4), "{done:?}");
    let done = Command::new(env!("CARGO_BIN_EXE_incise"))
        .current_dir(folder.path())
        .args(["simulate", "-o", "out"])
        .args(base.split_whitespace())
        .args(["--plane", "1,0,0,0"])
        .output()
        .unwrap();
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    let said = String::from_utf8(done.stderr).unwrap();
    let miss = "the plane 1,0,0,9 misses all bodies";
    assert!(said.contains(miss), "{said}");
    let done = simulate(folder.path(), &format!("{base} --plane 1,0,0,0"));
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    assert_eq!(report(&done)["missed_cuts"], serde_json::json!([miss]));
}

#[test]
fn an_offset_that_rounds_the_shape_of_a_body_away_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (offset, exit) in [
        ("0,-1e4,0", 0),
        ("0,1e8,0", 2),
        ("1e30,0,0", 2),
        ("0,0,1e39", 2),
    ] {
        let words = format!("Sphere80 --seconds 0.1 --offset {offset}");
        let done = simulate(folder.path(), &words);
        assert_eq!(done.status.code(), Some(exit), "{offset}: {done:?}");
        let error = String::from_utf8_lossy(&done.stderr);
        let is_told = error.contains("single precision");
        assert_eq!(is_told, exit == 2, "{offset}: {error}");
    }
}

#[test]
fn numbers_out_of_range_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (words, fault) in [
        ("--seconds -1", "'-1' is not a positive number"),
        ("--seconds 1 --dt -0.1", "'-0.1' is not a positive number"),
        (
            "--seconds 1 --plane 1,0,0,0 --at -1",
            "'-1' is not 0, a pos",
        ),
        (
            "--seconds 1 --substep -2",
            "solver.substep is -2; it must be a finite number above 0",
        ),
        (
            "--seconds 1 --iterations 0",
            "solver.iterations is 0; it must be from 1 to",
        ),
        (
            "--seconds 1 --fps -1",
            "'-1' is not a whole number from 1 to 65535",
        ),
        (
            "--seconds 1 --material steel",
            "[possible values: soft-body, shell, cloth, limp-shell, skin, liver, muscle, jelly",
        ),
    ] {
        let done = simulate(folder.path(), &format!("Sphere80 {words}"));
        assert_eq!(done.status.code(), Some(2), "{words}: {done:?}");
        let error = String::from_utf8(done.stderr).unwrap();
        assert!(error.contains(fault), "{error}");
    }
}

#[test]
fn bodies_of_files_keep_their_places_far_from_the_origin() {
    let folder = tempfile::tempdir().unwrap();
    for (name, x) in [("a.obj", 1e6), ("b.obj", 1e6 + 2.0)] {
        let mut ball = build_model(Model::Sphere80);
        ball.set_origin([x, 0.0, 0.0]);
        write_obj(&folder.path().join(name), &ball).unwrap();
    }
    let done = simulate(folder.path(), "a.obj b.obj --seconds 0.1");
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    let [a, b] = [0, 1].map(|number| center(folder.path(), number));
    assert!((b.x - a.x - 2.0).abs() < 1e-3, "{a} and {b}");
}

#[test]
fn bodies_land_on_each_other_unless_contacts_are_off() {
    let folder = tempfile::tempdir().unwrap();
    let distance = |more: &str| {
        let words = format!(
            "Sphere80 Sphere80 --offset 0,0,0 --offset 0,1.05,0 --seconds 0.6 --ground -0.5 \
             --material rubber {more}"
        );
        let done = simulate(folder.path(), &words);
        assert_eq!(done.status.code(), Some(0), "{done:?}");
        let [lower, upper] = [0, 1].map(|number| center(folder.path(), number));
        (upper - lower).norm()
    };
    let (touching, passing) = (distance(""), distance("--no-contacts"));
    assert!(touching > 0.7, "{touching}: a little flattened");
    assert!(passing < 0.5, "{passing}: one center is in the other ball");
}

#[test]
fn more_offsets_than_inputs_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let words = "Sphere20 --offset 0,0,0 --offset 0,1,0 --seconds 0.1";
    let done = simulate(folder.path(), words);
    assert_eq!(done.status.code(), Some(2), "{done:?}");
    assert!(!folder.path().join("out").exists(), "nothing is written");
}
