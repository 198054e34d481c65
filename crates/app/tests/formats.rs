//! Tests of the formats of written pieces, and of the attributes that they keep.

mod common;

use common::{cut, text};
use incise_mesh::{Blend, Channel, Domain, Surface, read_mesh, write_ply};
use incise_models::{Model, build_model};
use std::path::Path;

/// Returns a ball with colors from its positions, and skin weights.
fn colored() -> Surface {
    let mut ball = build_model(Model::Sphere768);
    let colors = ball
        .rest_positions()
        .iter()
        .flat_map(|p| p.map(|x| x + 0.5));
    let colors = colors.collect();
    let skin = ball
        .rest_positions()
        .iter()
        .flat_map(|p| [1.0, 2.0, p[0] + 0.5, 0.5 - p[0]]);
    let skin = skin.collect();
    for channel in [
        Channel::new("color", Domain::Vertex, Blend::Linear, 3, colors),
        Channel::new("skin", Domain::Vertex, Blend::Skin, 4, skin),
    ] {
        ball.set_channel(channel.unwrap()).unwrap();
    }
    ball
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
    let input = folder.path().join("ball.ply");
    write_ply(&input, &colored()).unwrap();
    let output = folder.path().join("out");
    for (format, dropped) in [("ply", vec![]), ("obj", vec!["skin"]), ("glb", vec![])] {
        let options = ["--plane", "1,0.1,0.2,0.03", "--format", format];
        let (code, report, error) = cut(&input, &output, &options);
        assert_eq!(code, Some(0), "{error}");
        let warnings = report["warnings"].as_array().unwrap();
        let names: Vec<&str> = warnings
            .iter()
            .map(|w| w["name"].as_str().unwrap())
            .collect();
        assert_eq!(names, dropped, "{format}");
        let files: Vec<_> = std::fs::read_dir(&output).unwrap().collect();
        assert_eq!(files.len(), 2, "pieces of another format are removed");
        for piece in ["piece_000", "piece_001"] {
            check_colors(&output.join(format!("{piece}.{format}")));
        }
    }
    let (code, report, error) = cut(&input, &output, &["--plane", "1,0,0,0", "--format", "stl"]);
    assert_eq!(code, Some(0), "{error}");
    let warnings = report["warnings"].as_array().unwrap();
    let names: Vec<&str> = warnings
        .iter()
        .map(|w| w["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["materials", "color", "skin"]);
}

#[test]
fn one_file_of_gltf_has_a_node_per_piece() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("ball.ply");
    write_ply(&input, &colored()).unwrap();
    let output = folder.path().join("pieces.glb");
    let (code, report, error) = cut(&input, &output, &["--plane", "1,0.1,0.2,0.03"]);
    assert_eq!(code, Some(0), "{error}");
    assert_eq!(report["pieces"][1]["file"], text(&output));
    let bytes = String::from_utf8_lossy(&std::fs::read(&output).unwrap()).into_owned();
    for name in ["piece_000", "piece_001", "COLOR_0", "JOINTS_0"] {
        assert!(bytes.contains(name), "{name}");
    }
    let data = read_mesh(&output).unwrap();
    let triangles: u64 = (report["pieces"].as_array().unwrap().iter())
        .map(|piece| piece["triangles"].as_u64().unwrap())
        .sum();
    assert_eq!(data.triangles.len() as u64, triangles);
    let (code, _, error) = cut(&output, &output, &["--plane", "1,0,0,0"]);
    assert_eq!(code, Some(3), "{error}");
}
