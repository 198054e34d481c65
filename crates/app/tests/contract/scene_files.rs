//! Tests of scene files: documentation, examples, agreement with options, and errors.

use crate::common::{incise, text};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Output;

/// Writes a scene to a new folder.
fn scene(text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.toml");
    std::fs::write(&file, text).unwrap();
    (folder, file)
}

fn report(done: &Output) -> Value {
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    serde_json::from_slice(&done.stdout).unwrap()
}

/// Returns the bytes of all files of a folder, in the order of their names.
fn files(folder: &Path) -> Vec<Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
        .iter()
        .map(|path| std::fs::read(path).unwrap())
        .collect()
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

#[test]
fn the_example_of_the_documentation_runs() {
    let page = std::fs::read_to_string(repository().join("docs/scene-files.md")).unwrap();
    let (_, example) = page.split_once("```toml\n").unwrap();
    let (example, _) = example.split_once("```").unwrap();
    let (folder, file) = scene(example);
    let report = report(&incise(&["simulate", text(&file), "--json"]));
    assert_eq!(report["frames"], 30);
    let pieces = report["pieces"].as_array().unwrap();
    let bodies: Vec<&Value> = pieces.iter().map(|piece| &piece["body"]).collect();
    // The blade stops inside the first body; the plane cuts the second one.
    assert_eq!(bodies, [0, 1, 1], "{report}");
    assert!(report["cutting_steps"].as_u64() > Some(3), "{report}");
    assert_eq!(files(&folder.path().join("pieces")).len(), 3);
}

#[test]
fn the_examples_run() {
    let folder = tempfile::tempdir().unwrap();
    for (name, count) in [("bunny_slices", 7), ("falling_bunny", 4), ("knife", 2)] {
        let scenes = repository().join("crates/app/scenes");
        let file = scenes.join(name).with_extension("toml");
        let out = folder.path().join(name);
        let report = report(&incise(&[
            "simulate",
            text(&file),
            "-o",
            text(&out),
            "--json",
        ]));
        let pieces = report["pieces"].as_array().unwrap();
        assert_eq!(pieces.len(), count, "{report}");
        for piece in pieces {
            assert_eq!(piece["boundary_edges"], 0, "{report}");
        }
    }
}

#[test]
fn a_file_and_options_give_the_same_bytes() {
    let (folder, file) = scene(
        "seconds = 0.3\ndt = 0.01\nsubstep = 0.0025\n\
         [materials.own]\npreset = \"rubber\"\n\
         [[bodies]]\nmesh = \"Sphere80\"\nmaterial = \"own\"\n\
         [[bodies]]\nmesh = \"Sphere20\"\nmaterial = \"own\"\noffset = [0, 1.05, 0]\n\
         [[colliders]]\nplane = { point = [0, -0.6, 0], normal = [0, 1, 0] }\n\
         [[cuts]]\nplane = [1, 0, 0.1, 0]\nat = 0.1\n\
         [[cuts]]\nplane = [0, 0.1, 1, 0]\nat = 0.2\n\
         [output]\npieces = \"of_file\"\nformat = \"ply\"\n",
    );
    let of_file = report(&incise(&["simulate", text(&file), "--json"]));
    let out = folder.path().join("of_options");
    let words = "simulate Sphere80 Sphere20 --offset 0,0,0 --offset 0,1.05,0 --seconds 0.3 \
                 --dt 1/100 --substep 0.0025 --ground -0.6 --material rubber \
                 --plane 1,0,0.1,0 --at 0.1 --plane 0,0.1,1,0 --at 0.2 --format ply --json -o";
    let words: Vec<&str> = words.split_whitespace().chain([text(&out)]).collect();
    let of_options = report(&incise(&words));
    for key in ["inputs", "frames", "dt", "substep", "hits", "steps"] {
        assert_eq!(of_file[key], of_options[key], "{key}");
    }
    let of_file = files(&folder.path().join("of_file"));
    assert!(of_file.len() > 4, "{} pieces", of_file.len());
    assert!(of_file == files(&out), "the pieces differ");
}

#[test]
fn timed_poses_are_a_path_with_a_pose_per_frame() {
    let head = "seconds = 0.5\ngravity = [0, 0, 0]\n[[bodies]]\nmesh = \"Sphere768\"\n";
    let (folder, file) = scene(&format!(
        "{head}[[blades]]\nposes = [\n\
         {{ at = 0.1, edge = [[-0.75, 0.01, -1], [-0.75, 0.01, 1]] }},\n\
         {{ at = 0.3, edge = [[0.75, 0.01, -1], [0.75, 0.01, 1]] }},\n]\n"
    ));
    let poses = (0..=12).map(|frame| {
        let x = -0.75 + 1.5 * f64::from(frame) / 12.0;
        format!("{x} 0.01 -1 {x} 0.01 1\n")
    });
    let knife = folder.path().join("knife.txt");
    std::fs::write(&knife, poses.collect::<String>()).unwrap();
    let path = folder.path().join("path.toml");
    let blade = "[[blades]]\npath = \"knife.txt\"\nat = 0.1\n";
    std::fs::write(&path, format!("{head}{blade}")).unwrap();
    let [timed, along_path] = [&file, &path].map(|file| {
        let out = folder.path().join("out");
        let report = report(&incise(&[
            "simulate",
            text(file),
            "-o",
            text(&out),
            "--json",
        ]));
        assert_eq!(report["steps"], 12, "{report}");
        files(&out)
    });
    assert_eq!(timed.len(), 2);
    assert!(timed == along_path, "the pieces differ");
}

#[test]
fn colliders_stop_a_falling_body() {
    for collider in [
        "plane = { point = [0, -0.6, 0], normal = [0, 2, 0] }",
        "sphere = { center = [0, -50.6, 0], radius = 50 }",
        "capsule = { ends = [[-9, -10.6, 0], [9, -10.6, 0]], radius = 10 }",
        "box = { center = [0, -1.6, 0], half = [2, 1, 2] }",
    ] {
        let (folder, file) = scene(&format!(
            "seconds = 1\n[[bodies]]\nmesh = \"Sphere80\"\n[[colliders]]\n{collider}\n"
        ));
        let out = folder.path().join("out");
        report(&incise(&[
            "simulate",
            text(&file),
            "-o",
            text(&out),
            "--json",
        ]));
        let piece = incise_mesh::read_mesh(&out.join("piece_000.obj")).unwrap();
        let lowest = piece.into_surface().unwrap().0.bounds().min[1];
        assert!((-0.61..-0.4).contains(&lowest), "{collider}: {lowest}");
    }
}

#[test]
fn errors_name_the_line_and_write_nothing() {
    let body = "[[bodies]]\nmesh = \"Sphere20\"\n";
    let pose = |at: f64| format!("{{ at = {at}, edge = [[0, 0, -1], [0, 0, 1]] }}");
    for (lines, said) in [
        (format!("seconds = \n{body}"), "line 1: "),
        (
            format!("{body}second = 1\n"),
            "line 3: unknown field `second`",
        ),
        (
            format!("seconds = 0\n{body}"),
            "line 1: '0' is not a positive number",
        ),
        (
            format!("seconds = 1\ngravity = [0, 1]\n{body}"),
            "line 2: gravity is '0,1'; it must be 3 numbers",
        ),
        (
            format!("seconds = 1\nground = -1\n{body}"),
            "line 2: there is no parameter 'ground'",
        ),
        ("seconds = 1\n".to_owned(), "no body"),
        (
            format!("seconds = 1\n{body}material = \"steel\"\n"),
            "line 4: there is no material steel",
        ),
        (
            format!("seconds = 1\n[materials.own]\nfriction = -1\n{body}material = \"own\"\n"),
            "line 3: friction is -1; it must be a finite number of at least 0",
        ),
        (
            format!("seconds = 1\n[materials.own]\nsprings = 1\n{body}material = \"own\"\n"),
            "line 3: there is no parameter 'springs'; the names are density, stretch",
        ),
        (
            format!("seconds = 1\nsubstep = 0\n{body}"),
            "line 2: solver.substep is 0; it must be a finite number above 0",
        ),
        (
            format!("seconds = 1\n[materials.unused]\nfriction = -1\n{body}"),
            "line 3: friction is -1; it must be a finite number of at least 0",
        ),
        (
            format!(
                "seconds = 1\n[materials.own]\nvolume = true\ncompressibility = -1\n{body}\
                 material = \"own\"\n"
            ),
            "line 4: volume.compressibility is -1; it must be",
        ),
        (
            format!("seconds = 1\nlevel = 0\n{body}"),
            "line 2: cut.refine.level.z is 0; it must be",
        ),
        (
            format!("seconds = 1\nsubstep = 0.004\n{body}[solver]\nsubstep = 0.002\n"),
            "line 6: 'solver.substep' and 'substep' are the same parameter",
        ),
        (
            format!("seconds = 1\n{body}[contacts]\nthickness = 200\n"),
            "line 5: contacts.thickness is 200; it must be above 0 and at most 100",
        ),
        (
            format!("seconds = 1\nsubsteps = 4\n{body}"),
            "line 2: there is no parameter 'substeps'; the names are dt, solver.iterations",
        ),
        (
            format!(
                "seconds = 1\n{body}[[colliders]]\nsphere = {{ center = [0, 0, 0], radius = 0 }}\n"
            ),
            "line 4: the collider",
        ),
        (
            format!("seconds = 1\n{body}[[cuts]]\nplane = [1, 0, 0, 0]\nat = 2\n"),
            "line 4: the time 2 s",
        ),
        (
            format!("seconds = 1\n{body}[[blades]]\nat = 0.5\n"),
            "line 4: a blade needs either",
        ),
        (
            format!("seconds = 1\n{body}[[blades]]\nposes = [{}]\n", pose(0.1)),
            "fewer than 2 poses",
        ),
        (
            format!(
                "seconds = 1\n{body}[[blades]]\nposes = [\n{},\n{}]\n",
                pose(0.1),
                pose(0.1)
            ),
            "line 7: the pose at 0.1 s",
        ),
        (
            "seconds = 1\n[[bodies]]\nmesh = \"Cube\"\n".to_owned(),
            "no such file or model",
        ),
    ] {
        let (folder, file) = scene(&lines);
        let out = folder.path().join("out");
        let done = incise(&["simulate", text(&file), "-o", text(&out)]);
        let error = String::from_utf8(done.stderr).unwrap();
        assert_eq!(done.status.code(), Some(1), "{lines}: {error}");
        assert!(error.contains(said), "{lines}: {error}");
        assert!(!out.exists(), "{lines}");
    }
}

#[test]
fn options_of_the_scene_are_refused_beside_a_file() {
    let (folder, file) = scene("seconds = 0.05\n[[bodies]]\nmesh = \"Sphere20\"\n");
    let out = folder.path().join("out");
    let run = |more: &[&str]| {
        let done = incise(&[&["simulate", text(&file)], more].concat());
        (done.status.code(), String::from_utf8(done.stderr).unwrap())
    };
    for (more, said) in [
        (
            &["--seconds", "1"][..],
            "--seconds cannot be combined with a scene file",
        ),
        (&["--material", "jelly"], "--material cannot be combined"),
        (&["Bunny"], "a scene file is the only input"),
        (&[], "there is no output"),
    ] {
        let (code, error) = run(more);
        assert_eq!(code, Some(2), "{more:?}: {error}");
        assert!(error.contains(said), "{more:?}: {error}");
    }
    let done = incise(&["simulate", "Bunny", "-o", text(&out)]);
    assert_eq!(done.status.code(), Some(2), "{done:?}");
    let glb = folder.path().join("out.glb");
    assert_eq!(run(&["-o", text(&glb)]).0, Some(0));
    assert!(glb.is_file());
}
