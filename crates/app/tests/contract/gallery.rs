//! Tests of the errors of `incise gallery`.

use crate::common::{incise, text};

#[test]
fn an_unknown_figure_is_an_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = incise(&["gallery", "-o", text(folder.path()), "--only", "fig1,fig12"]);
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{error}");
    for name in ["fig12", "fig1", "fig10", "figA4", "texture"] {
        assert!(error.contains(name), "{name}: {error}");
    }
    for size in ["0", "63", "4000"] {
        let output = incise(&["gallery", "-o", text(folder.path()), "--size", size]);
        assert_eq!(output.status.code(), Some(2), "{size}");
    }
    let left = std::fs::read_dir(folder.path()).expect("a folder").count();
    assert_eq!(left, 0, "nothing is drawn");
}

#[test]
fn without_a_gpu_the_gallery_is_an_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let missing = [
        "gallery",
        "-o",
        text(folder.path()),
        "--adapter",
        "no such device",
    ];
    let output = incise(&missing);
    assert_eq!(output.status.code(), Some(1));
    let file = folder.path().join("file");
    std::fs::write(&file, "").expect("a folder");
    let output = incise(&["gallery", "-o", text(&file)]);
    assert_eq!(output.status.code(), Some(3), "a file is no folder");
}
