//! Tests of the piece files that `incise cut` writes: names, overwriting, attributes, cavities.

use crate::bodies::hollow_sphere;
use crate::common::{cut, incise, text};
use incise_mesh::{Blend, Channel, Domain, RepairParams, read_mesh, write_obj, write_ply};
use incise_models::{Model, build_model};
use std::path::{Path, PathBuf};
use std::process::Command;

#[test]
fn neither_the_input_nor_a_folder_is_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("piece_001.obj");
    write_obj(&input, &build_model(Model::Sphere80)).unwrap();
    let before = std::fs::read(&input).unwrap();
    let cut = |output: &Path| {
        let arguments = [
            "cut",
            text(&input),
            "--plane",
            "1,0,0,0.05",
            "-o",
            text(output),
        ];
        let output = incise(&arguments);
        let error = String::from_utf8(output.stderr).unwrap();
        (output.status.code(), error)
    };
    // The input's folder under another path.
    let out = folder.path().join("out");
    std::fs::create_dir(&out).unwrap();
    for target in [folder.path(), &out.join(".."), &out.join("new/../..")] {
        let (code, error) = cut(target);
        assert_eq!(code, Some(3), "{error}");
        assert!(error.contains("overwrite the input"), "{error}");
        assert_eq!(std::fs::read(&input).unwrap(), before);
        assert!(!folder.path().join("piece_000.obj").exists());
    }
    std::fs::create_dir(out.join("piece_001.obj")).unwrap();
    let (code, error) = cut(&out);
    assert_eq!(code, Some(3), "{error}");
    assert!(error.contains("is a folder"), "{error}");
    assert!(!out.join("piece_000.obj").exists(), "nothing is written");
}

// Other systems' file systems may take Unicode only.
#[cfg(target_os = "linux")]
#[test]
fn json_is_valid_for_paths_that_are_not_unicode() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join(OsStr::from_bytes(b"sph\xffre.obj"));
    write_obj(&input, &build_model(Model::Sphere80)).unwrap();
    let output = folder.path().join(OsStr::from_bytes(b"o\xfft"));
    let json = |command: &mut Command| -> serde_json::Value {
        let output = command.arg(&input).arg("--json").output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let binary = || Command::new(env!("CARGO_BIN_EXE_incise"));
    let check = json(binary().arg("check"));
    assert!(
        check["file"]
            .as_str()
            .unwrap()
            .ends_with("sph\u{fffd}re.obj")
    );
    let cut = json(
        binary()
            .args(["cut", "--plane", "1,0,0,0.05", "-o"])
            .arg(&output),
    );
    assert!(
        cut["input"]
            .as_str()
            .unwrap()
            .ends_with("sph\u{fffd}re.obj")
    );
    let file = cut["pieces"][1]["file"].as_str().unwrap();
    assert!(file.ends_with("o\u{fffd}t/piece_001.obj"), "{file}");
    assert!(output.join("piece_001.obj").exists());
}

#[test]
fn a_cavity_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("hollow.obj");
    write_obj(&input, &hollow_sphere()).unwrap();
    let output = folder.path().join("out");
    let arguments = [
        "cut",
        text(&input),
        "--plane",
        "1,0,0,0.25",
        "-o",
        text(&output),
    ];
    let cut = |more: &[&str]| {
        let output = incise(&[&arguments, more].concat());
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    let report: serde_json::Value = serde_json::from_str(&cut(&["--json"])).unwrap();
    let pieces = report["pieces"].as_array().unwrap();
    assert_eq!(pieces.len(), 3);
    for piece in pieces {
        let cavity = piece["volume"].as_f64().unwrap() < 0.0;
        assert_eq!(piece["cavity"].as_bool(), Some(cavity));
    }
    let cavities = pieces.iter().filter(|p| p["cavity"] == true).count();
    assert_eq!(cavities, 1, "the cut misses it");
    let lines = cut(&[]);
    let lines: Vec<&str> = lines.lines().filter(|l| l.contains("cavity")).collect();
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert!(lines[0].contains("volume -"), "{lines:?}");
}

#[test]
fn pieces_keep_texture_coordinates_and_normals_and_caps_have_their_own_material() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("sphere.obj");
    let mut sphere = build_model(Model::Sphere80);
    let corners = sphere.topology().triangle_slots() * 3;
    sphere.set_corner_uvs(vec![[0.25, 0.75]; corners]).unwrap();
    sphere
        .set_corner_normals(vec![[0.0, 0.0, 1.0]; corners])
        .unwrap();
    write_obj(&input, &sphere).unwrap();
    let output = folder.path().join("out");
    let (code, report, error) = cut(&input, &output, &["--plane", "1,0.1,0.2,0.03"]);
    assert_eq!(code, Some(0), "{error}");
    let mut on_caps = 0;
    for piece in ["piece_000.obj", "piece_001.obj"] {
        let obj = std::fs::read_to_string(output.join(piece)).unwrap();
        assert!(obj.contains("\nvt 0.25 0.75\n"), "{piece} has no texture");
        assert!(obj.contains("\nvn 0.0 0.0 1.0\n"), "{piece} has no normals");
        let [mut skin, mut cap] = [0, 0];
        let mut on_cap = None;
        for line in obj.lines() {
            match line {
                "usemtl material_0" => on_cap = Some(false),
                "usemtl material_1" => on_cap = Some(true),
                _ if line.starts_with("f ") => {
                    *if on_cap.unwrap() { &mut cap } else { &mut skin } += 1;
                }
                _ => {}
            }
        }
        assert!(skin > 0 && cap > 0, "{piece}: {skin} and {cap}");
        on_caps += cap;
        let check = incise(&["check", text(&output.join(piece))]);
        assert_eq!(check.status.code(), Some(0), "{piece} is closed");
    }
    assert_eq!(report["cap_triangles"], on_caps);
}

/// Returns the largest texture coordinate in a file.
fn largest_texture_coordinate(obj: &Path) -> f64 {
    let obj = std::fs::read_to_string(obj).unwrap();
    let lines = obj.lines().filter_map(|line| line.strip_prefix("vt "));
    let numbers = lines.flat_map(str::split_whitespace);
    let numbers = numbers.map(|number| number.parse::<f64>().unwrap().abs());
    numbers.fold(0.0, f64::max)
}

#[test]
fn texture_coordinates_of_caps_are_scaled() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("sphere.obj");
    let mut sphere = build_model(Model::Sphere80);
    let corners = sphere.topology().triangle_slots() * 3;
    sphere.set_corner_uvs(vec![[0.0; 2]; corners]).unwrap();
    write_obj(&input, &sphere).unwrap();
    let largest = ["1", "4"].map(|scale| {
        let output = folder.path().join(scale);
        let options = ["--plane", "1,0.1,0.2,0.03", "--cap-uv-scale", scale];
        let (code, _, error) = cut(&input, &output, &options);
        assert_eq!(code, Some(0), "{error}");
        largest_texture_coordinate(&output.join("piece_000.obj"))
    });
    assert!(largest[0] > 0.1, "{largest:?}");
    assert!((largest[1] / largest[0] - 4.0).abs() < 1e-6, "{largest:?}");
    let (code, ..) = cut(
        &input,
        folder.path(),
        &["--plane", "1,0,0,0", "--cap-uv-scale", "-1"],
    );
    assert_eq!(code, Some(2));
}

#[test]
fn only_pieces_of_an_earlier_run_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("hollow.obj");
    write_obj(&input, &hollow_sphere()).unwrap();
    let output = folder.path().join("out");
    let names = || {
        let entries = std::fs::read_dir(&output).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    };
    // The plane misses the cavity: two halves and the cavity.
    let (code, report, error) = cut(&input, &output, &["--plane", "1,0,0,0.25"]);
    assert_eq!(
        (code, &report["removed"]),
        (Some(0), &serde_json::json!([])),
        "{error}"
    );
    assert_eq!(names(), ["piece_000.obj", "piece_001.obj", "piece_002.obj"]);
    for kept in ["piece_0002.obj", "piece_002.ply", "notes.txt"] {
        std::fs::write(output.join(kept), "").unwrap();
    }
    std::fs::create_dir(output.join("piece_100.obj")).unwrap();
    std::fs::write(output.join("piece_1000.obj"), "").unwrap();
    // A refused cut leaves existing files.
    let plane = ["--plane", "1,0.1,0.2,0.01"];
    let before = names();
    let refused = [&plane[..], &["--method", "paper"]].concat();
    assert_eq!(cut(&input, &output, &refused).0, Some(1));
    assert_eq!(names(), before);
    // The plane crosses the cavity: two pieces.
    let (code, report, error) = cut(&input, &output, &plane);
    assert_eq!(code, Some(0), "{error}");
    let removed: Vec<&str> = (report["removed"].as_array().unwrap().iter())
        .map(|path| path.as_str().unwrap().rsplit(['/', '\\']).next().unwrap())
        .collect();
    assert_eq!(removed, ["piece_002.obj", "piece_1000.obj"]);
    assert_eq!(
        names(),
        [
            "notes.txt",
            "piece_000.obj",
            "piece_0002.obj",
            "piece_001.obj",
            "piece_002.ply",
            "piece_100.obj"
        ]
    );
    let again = [
        "cut",
        text(&input),
        "-o",
        text(&output),
        "--plane",
        "1,0,0,9",
    ];
    let lines = String::from_utf8(incise(&again).stdout).unwrap();
    assert!(
        !lines.contains("removed"),
        "as many pieces as before: {lines}"
    );
}

#[test]
fn an_input_named_like_a_piece_is_not_removed() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("piece_007.obj");
    write_obj(&input, &build_model(Model::Sphere80)).unwrap();
    let (code, _, error) = cut(&input, folder.path(), &["--plane", "1,0,0,0.05"]);
    assert_eq!(code, Some(3), "{error}");
    assert!(error.contains("choose another folder"), "{error}");
    assert!(input.exists() && !folder.path().join("piece_000.obj").exists());
}

#[test]
fn an_output_that_cannot_be_written_exits_with_3() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("sphere.obj");
    write_obj(&input, &build_model(Model::Sphere80)).unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "here is no folder").unwrap();
    let (code, _, error) = cut(&input, &file, &["--plane", "1,0,0,0.05"]);
    assert_eq!(code, Some(3), "{error}");
    let simulate = [
        "simulate",
        text(&input),
        "--seconds",
        "0.02",
        "-o",
        text(&file),
    ];
    assert_eq!(incise(&simulate).status.code(), Some(3));
    let help = String::from_utf8(incise(&["--help"]).stdout).unwrap();
    assert!(help.contains("3  the output cannot be written"), "{help}");
}

/// Writes a ball with skin weights, and colors from its positions. Returns its path.
fn write_colored_ball(folder: &Path) -> PathBuf {
    let mut ball = build_model(Model::Sphere768);
    let points = ball.rest_positions().to_vec();
    let colors = points.iter().flat_map(|p| p.map(|x| x + 0.5)).collect();
    let weights = points.iter().map(|p| p[0] + 0.5);
    let skin = weights.flat_map(|w| [1.0, 2.0, w, 1.0 - w]).collect();
    for channel in [
        Channel::new("color", Domain::Vertex, Blend::Linear, 3, colors),
        Channel::new("skin", Domain::Vertex, Blend::Skin, 4, skin),
    ] {
        ball.set_channel(channel.unwrap()).unwrap();
    }
    let input = folder.join("ball.ply");
    write_ply(&input, &ball).unwrap();
    input
}

/// Asserts that the colors of a file's mesh are those of its positions.
fn check_colors(file: &Path) {
    let (surface, _) = read_mesh(file).unwrap().into_surface().unwrap();
    let color = surface.channel("color").expect("the mesh has colors");
    assert_eq!(color.domain(), Domain::Vertex, "no seams");
    for v in surface.topology().vertices() {
        let at = surface.rest_position(v);
        for (x, &value) in at.iter().zip(color.row(v.index())) {
            assert!((x + 0.5 - f64::from(value)).abs() < 1e-6, "{v}: {at}");
        }
    }
}

#[test]
fn pieces_keep_colors_in_every_format_that_has_them() {
    let folder = tempfile::tempdir().unwrap();
    let input = write_colored_ball(folder.path());
    for (format, dropped) in [
        ("ply", &[][..]),
        ("obj", &["skin"]),
        ("glb", &[]),
        (
            "stl",
            &["texture coordinates", "materials", "color", "skin"],
        ),
    ] {
        let output = folder.path().join(format);
        let options = ["--plane", "1,0.1,0.2,0.03", "--format", format];
        let (code, report, error) = cut(&input, &output, &options);
        assert_eq!(code, Some(0), "{error}");
        let warnings = report["warnings"].as_array().unwrap().iter();
        let names: Vec<_> = warnings.map(|w| w["name"].as_str().unwrap()).collect();
        assert_eq!(names, dropped, "{format}");
        if !dropped.contains(&"color") {
            for piece in ["piece_000", "piece_001"] {
                check_colors(&output.join(format!("{piece}.{format}")));
            }
        }
    }
}

#[test]
fn one_file_of_gltf_has_a_node_per_piece() {
    let folder = tempfile::tempdir().unwrap();
    let input = write_colored_ball(folder.path());
    let output = folder.path().join("pieces.glb");
    let (code, report, error) = cut(&input, &output, &["--plane", "1,0.1,0.2,0.03"]);
    assert_eq!(code, Some(0), "{error}");
    assert_eq!(report["pieces"][1]["file"], text(&output));
    let bytes = std::fs::read(&output).unwrap();
    let json = String::from_utf8_lossy(&bytes);
    for name in ["piece_000", "piece_001", "COLOR_0", "JOINTS_0"] {
        assert!(json.contains(name), "{name}");
    }
    let triangles: u64 = (report["pieces"].as_array().unwrap().iter())
        .map(|piece| piece["triangles"].as_u64().unwrap())
        .sum();
    let data = read_mesh(&output).unwrap();
    assert_eq!(data.triangles.len() as u64, triangles);
    let (code, _, error) = cut(&output, &output, &["--plane", "1,0,0,0"]);
    assert_eq!(code, Some(3), "{error}");
}

/// Regression: creases and caps have vertices of their own in glTF, so that pieces that touch fell
/// apart along them when they were read back: two cuts of Octopus gave 209 components.
#[test]
fn pieces_that_touch_come_back_from_gltf_as_they_were() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("pieces.glb");
    for (model, planes) in [
        ("Bunny", ["0,1,0,0.013", "0,1,0,0.1"]),
        ("Sphere768", ["0,1,0,0.013", "1,0,0,0.017"]),
        ("Octopus", ["0,1,0,0", "1,0,0,0"]),
    ] {
        let planes = ["--plane", planes[0], "--plane", planes[1]];
        let (code, report, error) = cut(Path::new(model), &output, &planes);
        assert_eq!(code, Some(0), "{error}");
        let pieces = report["pieces"].as_array().unwrap();
        let repair = RepairParams::default();
        let (surface, _) = read_mesh(&output).unwrap().repair(repair).unwrap();
        surface.validate_closed().unwrap();
        assert_eq!(surface.piece_count(), pieces.len(), "{model}");
        let mut volumes: Vec<f64> = surface.piece_volumes();
        let mut expected: Vec<f64> = (pieces.iter())
            .map(|piece| piece["volume"].as_f64().unwrap())
            .collect();
        volumes.sort_by(f64::total_cmp);
        expected.sort_by(f64::total_cmp);
        for (a, b) in volumes.iter().zip(&expected) {
            assert!((a - b).abs() < 1e-9, "{model}: {a} and {b}");
        }
    }
}
