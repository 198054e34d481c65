//! Tests of the errors of `incise render`.

use crate::common::{incise, text};
use incise_mesh::write_obj;
use incise_models::{Model, build_model};

#[test]
fn invalid_input_is_an_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let target = folder.path().join("a.png");
    let refused = |more: &[&str], code, said: &str| {
        let mut arguments = vec!["render", "Sphere20"];
        arguments.extend(more);
        if !more.contains(&"-o") {
            arguments.extend(["-o", text(&target)]);
        }
        let output = incise(&arguments);
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{more:?}: {error}");
        assert!(error.contains(said), "{more:?}: {error}");
        assert!(!target.exists(), "{more:?}");
    };
    refused(&["--size", "0x10"], 2, "not a size");
    refused(&["--camera", "0,100"], 2, "-90 to 90");
    refused(&["--color", "red"], 2, "#rrggbb");
    refused(&["--background", "#fff,"], 2, "#rrggbb");
    refused(&["--explode", "-1"], 2, "not a positive number");
    refused(&["--show-sweep"], 2, "--plane");
    refused(&["--level", "2x-finer"], 2, "--plane");
    refused(&["--plane", "0,0,0,1"], 2, "no area");
    refused(&["--without", "1"], 2, "the image has 1 piece,");
    let paper = ["--method", "paper"];
    refused(&paper, 2, "--plane");
    let snapped = [&["--plane", "1,0,0,0", "--snap", "0.2"][..], &paper].concat();
    refused(&snapped, 2, "--snap");
    refused(&["-o", "a.jpg"], 2, "only .png");
    refused(&["-o", "none/such/folder.png"], 3, "folder.png");
    refused(&["nothing.obj"], 1, "nothing.obj");
    // The image must not overwrite the input.
    let mesh = folder.path().join("mesh.png");
    write_obj(&mesh, &build_model(Model::Sphere20)).expect("a folder");
    let before = std::fs::read(&mesh).expect("a file");
    refused(&[text(&mesh), "-o", text(&mesh)], 3, "overwrite the input");
    assert_eq!(std::fs::read(&mesh).expect("a file"), before);
}

#[test]
fn without_a_gpu_rendering_is_an_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let target = folder.path().join("a.png");
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_incise"));
    for name in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        command.env(name, "/nonexistent/driver.json");
    }
    let output = command
        .args(["render", "Sphere20", "-o", text(&target)])
        .output();
    let output = output.expect("it runs");
    let error = String::from_utf8_lossy(&output.stderr);
    // Some GPUs need no driver file of this kind.
    if output.status.code() != Some(0) {
        assert_eq!(output.status.code(), Some(1), "{error}");
        assert!(error.contains("install a driver"), "{error}");
        assert!(!target.exists());
    }
}
