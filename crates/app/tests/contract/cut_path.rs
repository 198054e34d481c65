//! Tests of `incise cut --path`: strokes that end inside and outside, bad paths, far files.

use crate::bodies::hollow_sphere;
use crate::common::{cut, incise, text};
use incise_mesh::geometry::area_vector;
use incise_mesh::{Surface, read_mesh, write_obj};
use incise_models::{Model, build_model};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Writes a blade along z that moves along x through these places, one pose per line.
fn stroke(folder: &Path, places: &[f64]) -> PathBuf {
    let pose = |x: &f64| format!("{x} 0.01 -1 {x} 0.02 1\n");
    write_path(folder, &places.iter().map(pose).collect::<String>())
}

fn write_path(folder: &Path, lines: &str) -> PathBuf {
    let path = folder.join("knife.txt");
    std::fs::write(&path, lines).unwrap();
    path
}

/// Cuts a ball of radius 0.5 along a path and returns the exit code, the report and the messages.
fn cut_ball(folder: &Path, path: &Path, more: &[&str]) -> (Option<i32>, Value, String) {
    let path = ["--path", text(path)];
    let output = folder.join("out");
    cut(Path::new("Sphere768"), &output, &[&path[..], more].concat())
}

fn piece(folder: &Path, number: u32) -> Surface {
    let data = read_mesh(&folder.join(format!("out/piece_{number:03}.obj"))).unwrap();
    data.into_surface().unwrap().0
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn a_stroke_that_stops_inside_slits_the_ball_and_keeps_its_volume() {
    let folder = tempfile::tempdir().unwrap();
    let path = stroke(folder.path(), &[-0.8, 0.0]);
    let (code, report, error) = cut_ball(folder.path(), &path, &["--snap", "0"]);
    assert_eq!(code, Some(0), "{error}");
    assert_eq!(error, "");
    let pieces = report["pieces"].as_array().unwrap();
    assert_eq!(pieces.len(), 1, "{report}");
    assert_eq!(pieces[0]["euler_characteristic"], 2);
    let (before, after) = (number(&report["volume"]), number(&pieces[0]["volume"]));
    assert!((after - before).abs() < 1e-6 * before, "{after}, {before}");
    assert_eq!(
        (&report["steps"], &report["cutting_steps"]),
        (&1.into(), &1.into())
    );
    assert!(report["tips"].as_u64() > Some(2), "{report}");
    // The walls are half a disc each, under the material of caps.
    let surface = piece(folder.path(), 0);
    surface.validate().unwrap();
    let is_wall = |&t: &_| surface.material(t) == 1;
    let walls: Vec<_> = surface.topology().triangles().filter(is_wall).collect();
    assert_eq!(report["wall_triangles"], walls.len());
    assert_eq!(report["cap_triangles"], walls.len());
    let area: f64 = walls
        .iter()
        .map(|&t| area_vector(surface.triangle_positions(t)).norm() / 2.0)
        .sum();
    let discs = std::f64::consts::PI * 0.25;
    assert!((area / discs - 1.0).abs() < 0.05, "{area}, not {discs}");
    // The file is a body that can be cut again, although its walls coincide.
    let file = folder.path().join("out/piece_000.obj");
    let check = incise(&["check", text(&file), "--json"]);
    let check: Value = serde_json::from_slice(&check.stdout).unwrap();
    assert_eq!(check["cuttable"], true);
    assert_eq!(check["warnings"][0]["kind"], "indices_kept");
}

#[test]
fn a_stroke_right_through_makes_two_pieces_in_any_number_of_steps() {
    let folder = tempfile::tempdir().unwrap();
    let mut volumes = Vec::new();
    for steps in [1, 2, 7, 20] {
        let place = |i: i32| -0.81 + 1.64 * f64::from(i) / f64::from(steps);
        let places: Vec<f64> = (0..=steps).map(place).collect();
        let path = stroke(folder.path(), &places);
        let (code, report, error) = cut_ball(folder.path(), &path, &["--snap", "0"]);
        assert_eq!(code, Some(0), "{steps} steps: {error}");
        assert_eq!(
            (&report["steps"], &report["tips"]),
            (&steps.into(), &0.into())
        );
        let pieces = report["pieces"].as_array().unwrap();
        assert_eq!(pieces.len(), 2, "{steps} steps");
        let mut own: Vec<f64> = pieces.iter().map(|p| number(&p["volume"])).collect();
        own.sort_by(f64::total_cmp);
        assert!((own.iter().sum::<f64>() / number(&report["volume"]) - 1.0).abs() < 1e-5);
        volumes.push(own);
        for number in 0..2 {
            let surface = piece(folder.path(), number);
            assert!(surface.topology().is_closed(), "{steps} steps");
            assert_eq!(pieces[number as usize]["euler_characteristic"], 2);
        }
    }
    for own in &volumes[1..] {
        for (a, b) in own.iter().zip(&volumes[0]) {
            assert!((a - b).abs() < 1e-5 * (a + b), "{volumes:?}");
        }
    }
}

#[test]
fn a_curved_blade_scoops_a_piece_out() {
    let folder = tempfile::tempdir().unwrap();
    // A channel of three facets, open upward, that moves along z.
    let pose = |z: f64| format!("-0.2 0.7 {z} -0.2 0.3 {z} 0.2 0.3 {z} 0.2 0.7 {z}\n");
    let lines: String = [-0.8, -0.2, 0.1, 0.8].map(pose).concat();
    let path = write_path(folder.path(), &lines);
    let (code, report, error) = cut_ball(folder.path(), &path, &[]);
    assert_eq!(code, Some(0), "{error}");
    assert_eq!(report["steps"], 3);
    let pieces = report["pieces"].as_array().unwrap();
    assert_eq!(pieces.len(), 2, "{report}");
    let volumes = pieces.iter().map(|p| number(&p["volume"]));
    assert!(volumes.fold(f64::MAX, f64::min) < 0.1 * number(&report["volume"]));
}

#[test]
fn the_text_names_steps_walls_and_the_tip() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out");
    for (places, said) in [
        (
            &[-2.0, -0.8, -0.2, 0.0][..],
            [
                "  3 steps, 2 with a cut; the blade ends inside the body, at a tip of",
                "wall triangles,",
            ],
        ),
        (
            &[-0.8, 0.8],
            [
                "  1 step, 1 with a cut; the blade ends outside the body",
                "  2 pieces, exact method",
            ],
        ),
    ] {
        let path = stroke(folder.path(), places);
        let done = incise(&[
            "cut",
            "Sphere768",
            "--path",
            text(&path),
            "-o",
            text(&output),
        ]);
        assert_eq!(done.status.code(), Some(0), "{done:?}");
        let told = String::from_utf8(done.stdout).unwrap();
        for said in said {
            assert!(told.contains(said), "{told}");
        }
    }
}

/// The mesh lies at 1e6 m, where the spacing of 32-bit numbers is 0.06 m.
#[test]
fn a_file_far_from_the_origin_is_cut_as_one_near_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut ball = build_model(Model::Sphere768);
    let reports = [0.0, 1e6].map(|x| {
        ball.set_origin([x, 0.0, 0.0]);
        let input = folder.path().join("ball.obj");
        write_obj(&input, &ball).unwrap();
        let pose = |at: f64| format!("{0} 0.01 -1 {0} 0.02 1\n", x + at);
        let path = write_path(folder.path(), &[-0.75, -0.125].map(pose).concat());
        let output = folder.path().join("out");
        let (code, report, error) = cut(&input, &output, &["--path", text(&path)]);
        assert_eq!(code, Some(0), "{error}");
        report
    });
    for key in ["/cut/hits", "/wall_triangles", "/tips", "/cut/loops"] {
        assert_eq!(reports[0].pointer(key), reports[1].pointer(key), "{key}");
    }
    let written = piece(folder.path(), 0);
    let x = written.origin()[0] + written.bounds().center().x;
    assert!((x - 1e6).abs() < 1e-3, "{x}");
}

#[test]
fn caps_of_an_earlier_cut_are_no_walls() {
    let folder = tempfile::tempdir().unwrap();
    let half = folder.path().join("half");
    let plane = ["--plane", "0,0,1,0.05"];
    let (code, cap, error) = cut(Path::new("Sphere768"), &half, &plane);
    assert_eq!(code, Some(0), "{error}");
    let path = stroke(folder.path(), &[-0.8, 0.0]);
    let input = half.join("piece_000.obj");
    let output = folder.path().join("out");
    let (code, report, error) = cut(&input, &output, &["--path", text(&path)]);
    assert_eq!(code, Some(0), "{error}");
    let surface = piece(folder.path(), 0);
    let is_cap = |&t: &_| surface.material(t) == 1;
    let caps = surface.topology().triangles().filter(is_cap).count();
    let walls = usize::try_from(report["wall_triangles"].as_u64().unwrap()).unwrap();
    let cap = usize::try_from(cap["cap_triangles"].as_u64().unwrap()).unwrap() / 2;
    assert!(
        walls > 0 && caps >= cap + walls,
        "{caps}: {cap} and {walls}"
    );
}

#[test]
fn exactly_one_of_plane_blade_and_path_is_needed() {
    let folder = tempfile::tempdir().unwrap();
    let path = stroke(folder.path(), &[-0.8, 0.8]);
    for (more, said) in [
        (&["--plane", "1,0,0,0"][..], "cannot be used with"),
        (
            &["--blade", "-1,0,-1,-1,0,1", "--to", "1,0,-1,1,0,1"],
            "cannot be used with",
        ),
        (
            &["--method", "paper"],
            "--path cannot be combined with --method paper",
        ),
    ] {
        let (code, _, error) = cut_ball(folder.path(), &path, more);
        assert_eq!(code, Some(2), "{error}");
        assert!(error.contains(said), "{error}");
    }
    let (code, _, error) = cut(Path::new("Sphere80"), &folder.path().join("out"), &[]);
    assert_eq!(code, Some(2));
    assert!(error.contains("--path <FILE>"), "{error}");
    assert!(!folder.path().join("out").exists(), "nothing is written");
}

#[test]
fn bad_paths_are_refused_with_their_line() {
    let folder = tempfile::tempdir().unwrap();
    let pose = "0 0 -1 0 0 1\n";
    for (lines, said) in [
        (String::new(), "knife.txt: the file has no pose"),
        (format!("# one\n{pose}"), "line 2: this is the only pose"),
        (format!("{pose}1 0 -1 1 0\n"), "line 2: 5 numbers"),
        (format!("{pose}1 0 -1\n"), "line 2: the blade has 1 point;"),
        (
            format!("{pose}0 0 0 1 1 1 2 2 2\n"),
            "line 2: the blade has 3 points, but 2 on line 1",
        ),
        (
            format!("{pose}NaN 0 -1 1 0 1\n"),
            "line 2: 'NaN' is not finite",
        ),
        (
            format!("{pose}1,0,-1,1,0,1\n"),
            "line 2: '1,0,-1,1,0,1' is not a number",
        ),
        (
            pose.repeat(3),
            "the blade has no length, or it never moves across its edge",
        ),
    ] {
        let path = write_path(folder.path(), &lines);
        let (code, _, error) = cut_ball(folder.path(), &path, &[]);
        assert_eq!(code, Some(1), "{lines}: {error}");
        assert!(error.contains(said), "{lines}: {error}");
    }
    let missing = folder.path().join("missing.txt");
    let (code, _, error) = cut_ball(folder.path(), &missing, &[]);
    assert_eq!(code, Some(1), "{error}");
    assert!(
        error.contains("missing.txt: the path of the blade cannot be read"),
        "{error}"
    );
    assert!(!folder.path().join("out").exists(), "nothing is written");
}

#[test]
fn a_step_that_fails_names_its_line_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    // A short blade that starts inside the body, and one that turns into its own wall.
    for (lines, said) in [
        (
            "# inside\n0 0 -0.1 0 0 0.1\n0.1 0 -0.1 0.1 0 0.1\n",
            "line 3: the blade moves inside the body",
        ),
        (
            "-0.8 0 -1 -0.8 0 1\n0.1 0 -1 0.1 0 1\n\n-0.3 0.2 -1 -0.3 -0.2 1\n",
            "line 4: ",
        ),
    ] {
        let path = write_path(folder.path(), lines);
        let (code, _, error) = cut_ball(folder.path(), &path, &[]);
        assert_eq!(code, Some(1), "{error}");
        assert!(error.contains(said), "{error}");
        assert!(error.contains("nothing was written"), "{error}");
        assert!(!folder.path().join("out").exists(), "nothing is written");
    }
}

#[test]
fn a_path_beside_the_body_and_in_its_cavity_misses() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("hollow.obj");
    write_obj(&input, &hollow_sphere()).unwrap();
    let output = folder.path().join("out");
    for lines in [
        "2 0 -1 2 0 1\n3 0 -1 3 0 1\n",
        "0 0 -0.02 0 0 0.02\n0.02 0 -0.02 0.02 0 0.02\n",
    ] {
        let path = write_path(folder.path(), lines);
        let (code, report, error) = cut(&input, &output, &["--path", text(&path)]);
        assert_eq!(code, Some(4), "{error}");
        assert_eq!(
            (&report["cutting_steps"], &report["tips"]),
            (&0.into(), &0.into())
        );
        assert_eq!(report["wall_triangles"], 0);
    }
    let plane = ["--plane", "1,0.1,0.2,0.01"];
    let (_, report, _) = cut(&input, &output, &plane);
    for key in ["steps", "cutting_steps", "tips", "wall_triangles"] {
        assert!(report[key].is_null(), "no path, no {key}");
    }
}
