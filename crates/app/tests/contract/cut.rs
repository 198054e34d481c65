//! Tests of `incise cut`: cuts by both methods, refused cuts and exit codes.

use crate::bodies::hollow_sphere;
use crate::common::{cut, incise, text};
use incise_mesh::write_obj;
use incise_models::{Model, build_model};
use std::path::Path;

#[test]
fn a_plane_makes_two_closed_pieces_at_every_level() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("sphere.obj");
    write_obj(&input, &build_model(Model::Sphere768)).unwrap();
    let levels = [
        "2x-coarser",
        "1.5x-coarser",
        "original",
        "1.5x-finer",
        "2x-finer",
        "0.8",
    ];
    for level in levels {
        let pieces = folder.path().join(level);
        let arguments = [
            "cut",
            text(&input),
            "--plane",
            "-1,0.2,0.1,0.05",
            "--level",
            level,
            "-o",
            text(&pieces),
            "--json",
        ];
        let output = incise(&arguments);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(report["pieces"].as_array().unwrap().len(), 2);
        let volumes = report["pieces"].as_array().unwrap().iter();
        let sum: f64 = volumes.map(|p| p["volume"].as_f64().unwrap()).sum();
        let before = report["volume"].as_f64().unwrap();
        assert!((sum - before).abs() < 0.03 * before, "{sum} of {before}");
        for piece in ["piece_000.obj", "piece_001.obj"] {
            let check = incise(&["check", text(&pieces.join(piece))]);
            assert_eq!(check.status.code(), Some(0), "{piece} is closed");
        }
    }
}

#[test]
fn a_blade_cuts_along_its_sweep_and_a_partial_cut_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("sphere.obj");
    write_obj(&input, &build_model(Model::Sphere80)).unwrap();
    let output = folder.path().join("out");
    let cut = |to| {
        incise(&[
            "cut",
            text(&input),
            "--blade",
            "-2,0.1,-2,-2,0.1,2",
            "--to",
            to,
            "-o",
            text(&output),
        ])
    };
    let half = cut("0,0.1,-2,0,0.1,2");
    assert_eq!(half.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&half.stderr).contains("ends inside the body"));
    assert!(!output.exists(), "nothing is written");
    assert_eq!(cut("2,0.1,-2,2,0.1,2").status.code(), Some(0));
    assert!(output.join("piece_001.obj").exists());
}

#[test]
fn a_wrong_command_line_exits_with_2_and_a_wrong_input_with_1() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("sphere.obj");
    write_obj(&input, &build_model(Model::Sphere20)).unwrap();
    let output = folder.path().join("out");
    let code = |more: &[&str]| {
        let mut arguments = vec!["cut", text(&input), "-o", text(&output)];
        arguments.extend(more);
        incise(&arguments).status.code()
    };
    assert_eq!(code(&[]), Some(2), "neither plane nor blade");
    assert_eq!(code(&["--plane", "1,0,0"]), Some(2), "three numbers");
    assert_eq!(code(&["--plane", "0,0,0,1"]), Some(2), "no normal");
    assert_eq!(code(&["--plane", "1,0,0,nan"]), Some(2), "not finite");
    assert_eq!(code(&["--blade", "0,0,0,1,1,1"]), Some(2), "to nowhere");
    for level in ["0", "-1"] {
        let (code, _, error) = cut(&input, &output, &["--plane", "1,0,0,0", "--level", level]);
        assert_eq!(code, Some(2), "{error}");
        assert!(error.contains("level.z is"), "{error}");
    }
    assert_eq!(
        code(&["--plane", "1,0,0,0", "--to", "0,0,0,1,1,1"]),
        Some(2)
    );
    for (plane, said) in [
        ("inf,0,0,0", "number 1, 'inf', is not finite"),
        ("1,0,0,nan", "number 4, 'nan', is not finite"),
        ("1,0,zero,0", "number 3, 'zero', is not a number"),
        ("1,0,0", "found 3 numbers"),
    ] {
        let (_, _, error) = cut(&input, &output, &["--plane", plane]);
        assert!(error.contains(said), "{plane}: {error}");
        assert!(error.contains("expected 4 finite numbers"), "{error}");
    }
    assert!(!output.exists(), "nothing is written");
    let missing = folder.path().join("missing.obj");
    let status = incise(&[
        "cut",
        text(&missing),
        "--plane",
        "1,0,0,0",
        "-o",
        text(&output),
    ]);
    assert_eq!(status.status.code(), Some(1));
    let (code, _, error) = cut(&input, &output, &["--plane", "1,0,0,9"]);
    assert_eq!(code, Some(4), "a miss has a code of its own");
    assert!(error.contains("bounding box is [-0.4253254"), "{error}");
}

/// A box at the end of the range of 32-bit coordinates is an error of the input.
#[test]
fn a_mesh_too_large_for_a_plane_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("large.obj");
    let tetrahedron = "v 0 0 0\nv 3e38 0 0\nv 0 3e38 0\nv 0 0 3e38\n\
                       f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    std::fs::write(&input, tetrahedron).unwrap();
    let output = folder.path().join("out");
    let (code, _, error) = cut(&input, &output, &["--plane", "1,0,0,1"]);
    assert_eq!(code, Some(1), "{error}");
    assert!(error.contains("scale the mesh"), "{error}");
}

fn sum_of_volumes(report: &serde_json::Value) -> f64 {
    let pieces = report["pieces"].as_array().unwrap().iter();
    pieces.map(|p| p["volume"].as_f64().unwrap()).sum()
}

#[test]
fn without_snapping_no_volume_moves_and_with_it_the_report_says_how_much() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("bunny.obj");
    write_obj(&input, &build_model(Model::Bunny)).unwrap();
    let plane = ["--plane", "0.1,1,0.2,0.013"];
    let output = folder.path().join("out");
    let run = |snap: &str| {
        let (code, report, error) = cut(&input, &output, &[&plane[..], &["--snap", snap]].concat());
        assert_eq!(code, Some(0), "{error}");
        let before = report["volume"].as_f64().unwrap();
        let off = (sum_of_volumes(&report) - before).abs() / before;
        (report, off)
    };
    let (exact, off) = run("0");
    assert_eq!(
        (&exact["method"], &exact["snap"]),
        (&"exact".into(), &0.0.into())
    );
    assert_eq!(exact["cut"]["snapped_vertices"], 0);
    assert_eq!(exact["cut"]["moved_volume"], 0.0);
    assert!(off < 1e-5, "{off} of the volume is lost");
    let (snapped, off) = run("0.3");
    let moved = snapped["cut"]["moved_volume"].as_f64().unwrap();
    let count = |name: &str| snapped["cut"][name].as_u64().unwrap();
    let contracted = count("snapped_vertices") + count("merged_points");
    assert!(contracted > 0, "{snapped}");
    assert!(moved > 0.0, "{snapped}");
    assert!(
        off <= moved / snapped["volume"].as_f64().unwrap() + 1e-5,
        "{off}"
    );
    let shortest = |report: &serde_json::Value| report["cut"]["short_rim_edges"].as_u64().unwrap();
    assert!(shortest(&snapped) < snapped["cut"]["hits"].as_u64().unwrap());
    let (code, _, error) = cut(&input, &output, &[&plane[..], &["--snap", "0.5"]].concat());
    assert_eq!(code, Some(2), "{error}");
    assert!(error.contains("below 0.5"), "{error}");
    for wrong in ["-0.1", "nan", "much"] {
        let (code, ..) = cut(&input, &output, &[&plane[..], &["--snap", wrong]].concat());
        assert_eq!(code, Some(2), "--snap {wrong}");
    }
}

#[test]
fn remeshing_moves_the_surface_by_no_more_than_the_report_says() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("bunny.obj");
    write_obj(&input, &build_model(Model::Bunny)).unwrap();
    let plane = ["--plane", "0.1,1,0.2,0.013"];
    let output = folder.path().join("out");
    let run = |more: &[&str]| cut(&input, &output, &[&plane[..], more].concat());
    let (_, off, _) = run(&[]);
    assert_eq!(off["remesh"], 0.0);
    assert_eq!(off["cut"]["moved_surface"], 0.0);
    let (code, on, error) = run(&["--remesh", "0.1"]);
    assert_eq!(code, Some(0), "{error}");
    let count = |name: &str| on["cut"][name].as_u64().unwrap();
    let done = ["flipped_edges", "collapsed_vertices", "collapsed_points"].map(count);
    assert!(done.iter().sum::<u64>() > 0, "{on}");
    let moved = on["cut"]["moved_surface"].as_f64().unwrap();
    assert!(moved > 0.0, "{on}");
    let triangles = |report: &serde_json::Value| -> u64 {
        let pieces = report["pieces"].as_array().unwrap().iter();
        pieces.map(|p| p["triangles"].as_u64().unwrap()).sum()
    };
    assert!(triangles(&on) < triangles(&off), "{on}");
    for wrong in ["0.5", "-0.1", "nan", "much"] {
        let (code, _, error) = run(&["--remesh", wrong]);
        assert_eq!(code, Some(2), "--remesh {wrong}");
        assert!(error.contains("remesh"), "{error}");
    }
}

#[test]
fn a_plane_through_a_cavity_is_cut_exactly_and_refused_by_the_paper_s_method() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("hollow.obj");
    write_obj(&input, &hollow_sphere()).unwrap();
    let output = folder.path().join("out");
    let plane = ["--plane", "1,0.1,0.2,0.01"];
    let (code, _, error) = cut(
        &input,
        &output,
        &[&plane[..], &["--method", "paper"]].concat(),
    );
    assert_eq!(code, Some(1), "{error}");
    assert!(error.contains("has a hole"), "{error}");
    assert!(!output.exists(), "nothing is written");
    let (code, report, error) = cut(&input, &output, &[&plane[..], &["--snap", "0"]].concat());
    assert_eq!(code, Some(0), "{error}");
    let pieces = report["pieces"].as_array().unwrap();
    assert_eq!((pieces.len(), &report["cut"]["loops"]), (2, &2.into()));
    assert!(pieces.iter().all(|p| p["cavity"] == false), "{report}");
    let before = report["volume"].as_f64().unwrap();
    assert!((sum_of_volumes(&report) - before).abs() < 1e-5 * before);
    for piece in ["piece_000.obj", "piece_001.obj"] {
        let check = incise(&["check", text(&output.join(piece)), "--json"]);
        let check: serde_json::Value = serde_json::from_slice(&check.stdout).unwrap();
        assert_eq!(
            (&check["cuttable"], &check["genus"]),
            (&true.into(), &0.into())
        );
    }
}

#[test]
fn a_partial_cut_is_refused_by_both_methods_and_says_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("sphere.obj");
    write_obj(&input, &build_model(Model::Sphere768)).unwrap();
    let output = folder.path().join("out");
    let blade = ["--blade", "-2,0.1,-2,-2,0.1,2", "--to", "0,0.1,-2,0,0.1,2"];
    for method in ["exact", "paper"] {
        let (code, _, error) = cut(
            &input,
            &output,
            &[&blade[..], &["--method", method]].concat(),
        );
        assert_eq!(code, Some(1), "{method}: {error}");
        assert!(error.contains("make the sweep larger"), "{method}: {error}");
        assert!(!output.exists(), "{method}: nothing is written");
    }
    let whole = ["--blade", "-2,0.1,-2,-2,0.3,2", "--to", "2,0.2,-2,2,0.1,2"];
    for method in ["exact", "paper"] {
        let (code, report, error) = cut(
            &input,
            &output,
            &[&whole[..], &["--method", method]].concat(),
        );
        assert_eq!(code, Some(0), "{method}: {error}");
        assert_eq!(report["pieces"].as_array().unwrap().len(), 2, "{method}");
        assert_eq!(report["method"], method);
    }
}

#[test]
fn a_sweep_too_large_to_be_exact_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("sphere.obj");
    write_obj(&input, &build_model(Model::Sphere80)).unwrap();
    let output = folder.path().join("out");
    for (far, is_refused) in [("1e8", false), ("1e13", true)] {
        let from = format!("-{far},0.1,-{far},-{far},0.1,{far}");
        let to = format!("{far},0.1,-{far},{far},0.1,{far}");
        let (code, _, error) = cut(&input, &output, &["--blade", &from, "--to", &to]);
        assert_eq!(code, Some(i32::from(is_refused)), "{far}: {error}");
        assert_eq!(
            error.contains("make the sweep smaller"),
            is_refused,
            "{error}"
        );
    }
}

#[test]
fn a_sweep_inside_the_body_is_no_miss_and_one_in_its_cavity_is() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("hollow.obj");
    write_obj(&input, &hollow_sphere()).unwrap();
    let output = folder.path().join("out");
    let inside = [
        "--blade",
        "0.2,-0.1,-0.1,0.2,0.1,-0.1",
        "--to",
        "0.2,-0.1,0.1,0.2,0.1,0.1",
    ];
    for method in ["exact", "paper"] {
        let (code, _, error) = cut(
            &input,
            &output,
            &[&inside[..], &["--method", method]].concat(),
        );
        assert_eq!(code, Some(1), "{method}: {error}");
        assert!(error.contains("lies inside the body"), "{method}: {error}");
        assert!(!output.exists(), "{method}: nothing is written");
    }
    let in_cavity = [
        "--blade",
        "0,-0.02,-0.02,0,0.02,-0.02",
        "--to",
        "0,-0.02,0.02,0,0.02,0.02",
    ];
    let beside = [
        "--blade",
        "2,-0.1,-0.1,2,0.1,-0.1",
        "--to",
        "2,-0.1,0.1,2,0.1,0.1",
    ];
    for miss in [in_cavity, beside] {
        let (code, report, error) = cut(&input, &output, &miss);
        assert_eq!(
            (code, &report["cut"]["hits"]),
            (Some(4), &0.into()),
            "{error}"
        );
    }
}

#[test]
fn a_blade_with_swapped_ends_is_a_distinct_error() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("sphere.obj");
    write_obj(&input, &build_model(Model::Sphere80)).unwrap();
    let output = folder.path().join("out");
    let blade = |to| ["--blade", "-2,0.1,-2,-2,0.1,2", "--to", to];
    for to in ["2,0.1,2,2,0.1,-2", "1,0.1,3,2,0.1,-1", "2,0.101,2,2,0.1,-2"] {
        let (code, _, error) = cut(&input, &output, &blade(to));
        assert_eq!(code, Some(2), "{to}: {error}");
        assert!(error.contains("crosses itself"), "{to}: {error}");
    }
    let (code, _, error) = cut(&input, &output, &blade("-2,0.1,-2,-2,0.1,2"));
    assert_eq!(code, Some(2), "{error}");
    assert!(error.contains("no area"), "{error}");
    let (code, ..) = cut(&input, &output, &blade("2,0.1,-2,2,0.1,2"));
    assert_eq!(code, Some(0), "the same order");
}

#[test]
fn help_and_report_describe_snapping() {
    let help = incise(&["cut", "--help"]);
    let help = String::from_utf8(help.stdout).unwrap();
    for word in [
        "--snap",
        "--method",
        "exact",
        "paper",
        "at least 0 and below 0.5",
        "diagonal from",
        "--max-triangles",
        "default: 0.1",
    ] {
        assert!(help.contains(word), "{word} in\n{help}");
    }
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("sphere.obj");
    write_obj(&input, &build_model(Model::Sphere768)).unwrap();
    let output = folder.path().join("out");
    let plane = [
        "cut",
        text(&input),
        "--plane",
        "1,0.1,0.2,0.03",
        "-o",
        text(&output),
    ];
    let lines = String::from_utf8(incise(&plane).stdout).unwrap();
    assert!(lines.contains("snap 0.1:"), "{lines}");
    assert!(lines.contains("short rim edges left"), "{lines}");
    assert!(lines.contains("2 pieces, exact method"), "{lines}");
}

#[test]
fn a_built_in_model_needs_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out");
    let plane = ["--plane", "0,1,0.2,0.05"];
    let (code, report, error) = cut("bunny".as_ref(), &output, &plane);
    assert_eq!((code, error.as_str()), (Some(0), ""));
    assert_eq!(report["triangles"], 1500);
    assert_eq!(report["pieces"].as_array().unwrap().len(), 2);
    let (code, _, error) = cut("rabbit".as_ref(), &output, &plane);
    assert_eq!(code, Some(1));
    assert!(error.contains("Bunny"), "{error}");
}

/// A body far from the origin has the pieces of one at the origin, at its place.
#[test]
fn a_body_far_from_the_origin_is_cut_as_exactly() {
    let folder = tempfile::tempdir().unwrap();
    let at = [4e6, 250_000.0, -1e6];
    let near = build_model(Model::Sphere80);
    let mut text = String::new();
    for &[x, y, z, _] in near.positions() {
        let p = [x, y, z].map(f64::from);
        text += &format!("v {} {} {}\n", p[0] + at[0], p[1] + at[1], p[2] + at[2]);
    }
    for t in near.topology().triangles() {
        let [a, b, c] = near.topology().triangle(t).map(|v| v.0 + 1);
        text += &format!("f {a} {b} {c}\n");
    }
    let (far, far_pieces) = (folder.path().join("far.obj"), folder.path().join("far"));
    std::fs::write(&far, text).unwrap();
    let plane = format!("1,0.5,0,{}", at[0] + 0.5 * at[1] + 0.013);
    let (code, report, error) = cut(&far, &far_pieces, &["--plane", &plane]);
    assert_eq!(code, Some(0), "{error}");
    assert_eq!(report["warnings"][0]["kind"], "origin_moved");
    let near_pieces = folder.path().join("near");
    let plane = ["--plane", "1,0.5,0,0.013"];
    let (_, expected, _) = cut("Sphere80".as_ref(), &near_pieces, &plane);
    for i in 0..2 {
        let volume = |report: &serde_json::Value| report["pieces"][i]["volume"].as_f64().unwrap();
        let error = volume(&report) / volume(&expected) - 1.0;
        assert!(error.abs() < 1e-6, "{error}");
        let name = format!("piece_00{i}.obj");
        let text = std::fs::read_to_string(far_pieces.join(name)).unwrap();
        let first: Vec<f64> = text.lines().next().unwrap()[2..]
            .split(' ')
            .map(|word| word.parse().unwrap())
            .collect();
        for k in 0..3 {
            assert!((first[k] - at[k]).abs() <= 1.0, "{first:?}");
        }
    }
    let (code, _, error) = cut(&far, &far_pieces, &["--plane", "1,0,0,0"]);
    assert_eq!(code, Some(4));
    assert!(error.contains("[3999999."), "{error}");
}

/// Errors of the method that needs closed bodies recommend `incise fill` only where its result can
/// be cut.
#[test]
fn fill_is_recommended_where_it_helps() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out");
    let error = |name: &str, text: &str| {
        let input = folder.path().join(name);
        std::fs::write(&input, text).unwrap();
        let plane = ["--plane", "1,0,0,0.2", "--method", "paper"];
        let (code, _, error) = cut(&input, &output, &plane);
        assert_eq!(code, Some(1), "{error}");
        error
    };
    let tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n";
    assert!(error("open.obj", tetrahedron).contains("incise fill"));
    let sheet = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
    let told = error("sheet.obj", sheet);
    assert!(!told.contains("incise fill"), "{told}");
    assert!(
        told.contains("has no inside") && told.contains("thickness"),
        "{told}"
    );
    let mut with_sheet = Vec::new();
    write_obj(
        &folder.path().join("ball.obj"),
        &build_model(Model::Sphere80),
    )
    .unwrap();
    let ball = std::fs::read_to_string(folder.path().join("ball.obj")).unwrap();
    // The last face is gone: the sphere has a hole.
    with_sheet.extend(ball.trim_end().rsplit_once('\n').map(|(open, _)| open));
    with_sheet.push("v 5 0 0\nv 6 0 0\nv 6 1 0\nv 5 1 0\nf -4 -3 -2 -1\n");
    let told = error("ball_and_sheet.obj", &with_sheet.join("\n"));
    assert!(
        told.contains("sheets without volume") && told.ends_with(": 1"),
        "{told}"
    );
    let fan = format!("{tetrahedron}v 1 1 1\nf 1 2 5\n");
    // Separated, the fan's triangle is a sheet.
    let told = error("fan.obj", &fan);
    assert!(
        told.contains("sheets without volume") && told.ends_with(": 1"),
        "{told}"
    );
    let input = folder.path().join("fan.obj");
    let (code, _, told) = cut(&input, &output, &["--plane", "1,0,0,0.2", "--no-repair"]);
    assert_eq!(code, Some(1), "{told}");
    assert!(!told.contains("incise fill"), "{told}");
}

/// Two planes through the center divide a ball into four pieces, whose volumes sum up.
#[test]
fn several_planes_cut_all_pieces_in_their_order() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let planes = ["--plane", "1,0.1,0,0.01", "--plane", "0,1,0.1,0.02"];
    let (code, report, error) = cut(Path::new("Sphere768"), &out, &planes);
    assert_eq!(code, Some(0), "{error}");
    let pieces = report["pieces"].as_array().unwrap();
    assert_eq!(pieces.len(), 4, "{report}");
    let volumes = pieces.iter().map(|piece| piece["volume"].as_f64().unwrap());
    let (sum, whole) = (volumes.sum::<f64>(), report["volume"].as_f64().unwrap());
    let moved = report["cut"]["moved_volume"].as_f64().unwrap();
    assert!((sum - whole).abs() < moved.abs() + 1e-6 * whole, "{report}");
    // The caps of the first plane are divided by the second one.
    let caps: usize = (0..4)
        .map(|i| {
            let file = incise_mesh::read_mesh(&out.join(format!("piece_{i:03}.obj"))).unwrap();
            let piece = file.into_surface().unwrap().0;
            let triangles = piece.topology().triangles();
            triangles.filter(|&t| piece.material(t) == 1).count()
        })
        .sum();
    assert_eq!(report["cap_triangles"].as_u64(), u64::try_from(caps).ok());
    assert_eq!(report["cut"]["loops"], 3, "one loop, then one in each half");
}
