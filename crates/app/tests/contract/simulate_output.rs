//! Tests of the files that `incise simulate` writes beside meshes.

use crate::common::{incise, text};
use serde_json::Value;

/// A body is one node until its cut and two nodes after it.
#[test]
fn pieces_are_exported_with_their_motion() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.glb");
    let words = "simulate Sphere80 --seconds 0.5 --plane 1,0,0.1,0 --at 0.2 --fps 10 --export";
    let words: Vec<&str> = words.split_whitespace().chain([text(&file)]).collect();
    let done = incise(&words);
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    let bytes = std::fs::read(&file).expect("a file");
    let length = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    let json: Value = serde_json::from_slice(&bytes[20..20 + length]).expect("JSON");
    let names: Vec<_> = (json["nodes"].as_array().expect("nodes").iter())
        .map(|node| node["name"].as_str().expect("a name"))
        .collect();
    let expected = [
        "body_0_take_0_piece_000",
        "body_0_take_1_piece_000",
        "body_0_take_1_piece_001",
    ];
    assert_eq!(names, expected);
    // Pictures at 0, 0.1 and 0.2 s show the whole body, those at 0.3, 0.4 and 0.5 s its halves.
    for mesh in json["meshes"].as_array().expect("meshes") {
        let targets = mesh["primitives"][0]["targets"].as_array();
        assert_eq!(targets.map(Vec::len), Some(2), "{mesh}");
    }
    let channels = json["animations"][0]["channels"]
        .as_array()
        .expect("channels");
    let count = |path: &str| {
        let of_path = channels.iter().filter(|c| c["target"]["path"] == path);
        of_path.count()
    };
    assert_eq!([count("weights"), count("scale")], [3, 3]);
    let read = incise_mesh::read_mesh(&file).expect("a mesh");
    assert!(read.triangles.len() > 160, "the ball and its halves");
    let again = ["simulate", text(&file), "--seconds", "0.1", "--export"];
    let refused = incise(&[&again[..], &[text(&file)]].concat());
    assert_eq!(refused.status.code(), Some(3), "{refused:?}");
    assert_eq!(
        std::fs::read(&file).expect("a file"),
        bytes,
        "the input stays"
    );
}

#[test]
fn other_names_than_png_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.gif");
    let words = ["simulate", "Sphere20", "--seconds", "0.1", "--animation"];
    let done = incise(&[&words[..], &[text(&file)]].concat());
    assert_eq!(done.status.code(), Some(2), "{done:?}");
    assert!(String::from_utf8_lossy(&done.stderr).contains("only .png"));
}
