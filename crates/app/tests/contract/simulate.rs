//! Tests of `incise simulate`: free fall, cuts, backends, volumes and errors of one body.

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

/// Runs the program without GPU drivers.
fn without_drivers(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_incise"));
    for name in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        command.env(name, "/nonexistent/driver.json");
    }
    command.args(arguments).output().unwrap()
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// Writes a sphere of radius 0.5 around the origin to a new folder.
fn with_sphere() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("sphere.obj");
    write_obj(&input, &build_model(Model::Sphere80)).unwrap();
    (folder, input)
}

fn piece(folder: &Path, number: u32) -> Surface {
    let data = read_mesh(&folder.join(format!("piece_{number:03}.obj"))).unwrap();
    data.into_surface().unwrap().0
}

#[test]
fn free_fall_equals_its_closed_form() {
    let (folder, input) = with_sphere();
    let out = folder.path().join("out");
    let done = incise(&[
        "simulate",
        text(&input),
        "--seconds",
        "0.5",
        "--dt",
        "1/100",
        "--substep",
        "0.0025",
        "-o",
        text(&out),
    ]);
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    assert_eq!(done.stderr, b"");
    let surface = piece(&out, 0);
    // Symplectic Euler: g h^2 n (n + 1) / 2.
    let expected = -9.81 / (400.0 * 400.0) * 200.0 * 201.0 / 2.0;
    let middle = surface.bounds().center().y;
    assert!((middle - expected).abs() < 1e-3, "{middle}, not {expected}");
}

#[test]
fn a_body_is_cut_on_its_way_to_the_ground() {
    let (folder, input) = with_sphere();
    let out = folder.path().join("out");
    let arguments = [
        "simulate",
        text(&input),
        "--seconds",
        "1",
        "--ground",
        "-0.7",
        "--plane",
        "1,0,0,0.05",
        "--at",
        "0.1",
        "-o",
        text(&out),
        "--json",
    ];
    let done = incise(&arguments);
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    let report: Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(report["backend"], "cpu");
    assert!(report["device"].is_null(), "{report}");
    assert_eq!(report["frames"], 60);
    assert!(report["hits"].as_u64().unwrap() > 0, "{report}");
    assert_eq!(report["pieces"].as_array().unwrap().len(), 2);
    for number in 0..2 {
        let surface = piece(&out, number);
        assert!(surface.topology().is_closed(), "piece {number}");
        let lowest = surface.bounds().min[1];
        assert!((-0.7 - 1e-4..-0.3).contains(&lowest), "{lowest}");
    }
}

#[test]
fn auto_without_a_gpu_warns_once_and_gives_the_cpu_result() {
    let (folder, input) = with_sphere();
    let [on_cpu, on_auto] = ["cpu", "auto"].map(|backend| {
        let out = folder.path().join(backend);
        let arguments = [
            "simulate",
            text(&input),
            "--seconds",
            "0.2",
            "--backend",
            backend,
            "-o",
            text(&out),
        ];
        let done = without_drivers(&arguments);
        assert_eq!(done.status.code(), Some(0), "{done:?}");
        (
            String::from_utf8(done.stderr).unwrap(),
            std::fs::read(out.join("piece_000.obj")).unwrap(),
        )
    });
    assert_eq!(on_cpu.0, "");
    let said = on_auto.0;
    assert_eq!(said.matches("continuing on the CPU").count(), 1, "{said}");
    assert_eq!(on_cpu.1, on_auto.1);
}

#[test]
fn refusals_name_the_reason() {
    let (folder, input) = with_sphere();
    let out = folder.path().join("out");
    let base = [
        "simulate",
        text(&input),
        "-o",
        text(&out),
        "--seconds",
        "0.1",
    ];
    let run = |more: &[&str]| {
        let done = without_drivers(&[&base[..], more].concat());
        (done.status.code(), String::from_utf8(done.stderr).unwrap())
    };
    let (code, err) = run(&["--backend", "gpu"]);
    assert_eq!(code, Some(1), "{err}");
    let reason = if cfg!(feature = "gpu") {
        "no GPU adapter"
    } else {
        "feature gpu"
    };
    assert!(err.contains(reason), "{err}");
    for wrong in [
        &["--plane", "1,0,0,0", "--at", "0.1"][..],
        &["--plane", "0,0,0,1"],
        &["--at", "0.05"],
        &["--dt", "0"],
        &["--backend", "tpu"],
    ] {
        let (code, err) = run(wrong);
        assert_eq!(code, Some(2), "{wrong:?}: {err}");
    }
    assert!(!out.exists(), "nothing is written");
}

#[test]
fn halves_keep_their_volume_and_rest_on_each_other() {
    let (folder, input) = with_sphere();
    let out = folder.path().join("out");
    let run = |more: &[&str]| {
        let arguments = [
            "simulate",
            text(&input),
            "--seconds",
            "1",
            "--ground",
            "-0.6",
            "--plane",
            "0,1,0,0.05",
            "-o",
            text(&out),
        ];
        let done = incise(&[&arguments[..], more].concat());
        assert_eq!(done.status.code(), Some(0), "{done:?}");
        [0, 1].map(|number| piece(&out, number))
    };
    let whole = build_model(Model::Sphere80).volume();
    let kept = |halves: &[Surface; 2]| halves.iter().map(Surface::volume).sum::<f64>() / whole;
    let lowest = |halves: &[Surface; 2]| {
        let lows = halves.each_ref().map(|half| half.bounds().min[1]);
        lows[0].max(lows[1])
    };
    let all = run(&["--material", "rubber"]);
    assert!((kept(&all) - 1.0).abs() < 0.02, "{}", kept(&all));
    assert!(lowest(&all) > -0.3, "one is on top: {}", lowest(&all));
    for more in [&[][..], &["--contacts-thickness", "0.2"]] {
        let none = run(&[&["--no-contacts"][..], more].concat());
        assert!(
            lowest(&none) < -0.5,
            "both on the ground: {}",
            lowest(&none)
        );
    }
}

/// The plane would eject the part of the body below it.
#[test]
fn a_body_that_starts_in_a_plane_is_refused() {
    let (folder, input) = with_sphere();
    let out = folder.path().join("out");
    let run = |ground: &str| {
        let words = [
            "simulate",
            text(&input),
            "--seconds",
            "0.1",
            "--ground",
            ground,
            "-o",
            text(&out),
        ];
        incise(&words)
    };
    let refused = run("0");
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    let said = String::from_utf8(refused.stderr).unwrap();
    assert!(said.contains("it starts 0.5 m deep"), "{said}");
    assert!(!out.exists(), "nothing is written");
    assert_eq!(run("-0.5").status.code(), Some(0), "it stands on it");
}

#[test]
fn normals_of_the_input_are_not_those_of_moved_pieces() {
    let (folder, input) = with_sphere();
    assert!(!read_mesh(&input).unwrap().corners.normal.is_empty());
    let out = folder.path().join("out");
    let done = incise(&[
        "simulate",
        text(&input),
        "--seconds",
        "0.1",
        "-o",
        text(&out),
    ]);
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    let read = read_mesh(&out.join("piece_000.obj")).unwrap();
    assert!(read.corners.normal.is_empty());
}

#[test]
fn outputs_of_one_name_are_refused() {
    let (folder, input) = with_sphere();
    let file = folder.path().join("a.glb");
    let same = folder.path().join(".").join("a.glb");
    let words = [
        "simulate",
        text(&input),
        "--seconds",
        "0.1",
        "-o",
        text(&file),
    ];
    let done = incise(&[&words[..], &["--export", text(&same)]].concat());
    assert_eq!(done.status.code(), Some(2), "{done:?}");
    assert!(String::from_utf8_lossy(&done.stderr).contains("two outputs have this name"));
    assert!(!file.exists());
}

#[test]
fn more_frames_than_can_be_counted_are_refused() {
    let (folder, input) = with_sphere();
    let out = folder.path().join("out");
    let words = ["simulate", text(&input), "-o", text(&out)];
    let done = incise(&[&words[..], &["--seconds", "1e300"]].concat());
    let error = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(2), "{error}");
    let said = "1e300 s have more than 4294967295 frames";
    assert!(error.contains(said), "{error}");
    assert!(!out.exists(), "nothing is written");
}
