//! Meshes far from the origin in every format.

use super::*;
use crate::geometry::{to_f32, to_f64};
use crate::io::{read_mesh, read_obj, read_ply, read_stl, write_obj, write_ply, write_stl};
use crate::shapes::{icosphere, torus};
use crate::surface::Surface;
use proptest::prelude::*;
use std::fmt::Write;

/// Coordinates of a survey, in meters.
const SURVEY: [f64; 3] = [449_728.0, 5_411_968.0, 12.0];

/// Returns the positions of a surface moved by `by`, and its triangles.
fn moved(surface: &Surface, by: [f64; 3]) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let position = |p: &[f32; 4]| [0, 1, 2].map(|k| f64::from(p[k]) + by[k]);
    let topology = surface.topology();
    let triangles = topology.triangles();
    (
        surface.positions().iter().map(position).collect(),
        triangles
            .map(|t| topology.triangle(t).map(|v| v.0))
            .collect(),
    )
}

fn obj(surface: &Surface, by: [f64; 3]) -> Vec<u8> {
    let (positions, triangles) = moved(surface, by);
    let mut text = String::new();
    for [x, y, z] in positions {
        writeln!(text, "v {x} {y} {z}").unwrap();
    }
    for [a, b, c] in triangles {
        writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
    }
    text.into_bytes()
}

fn ply(surface: &Surface, by: [f64; 3], kind: &str) -> Vec<u8> {
    let (positions, triangles) = moved(surface, by);
    let format = if kind == "double" {
        "binary_little_endian"
    } else {
        "ascii"
    };
    let mut out = format!(
        "ply\nformat {format} 1.0\nelement vertex {}\nproperty {kind} x\nproperty {kind} y\n\
         property {kind} z\nelement face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        positions.len(),
        triangles.len()
    )
    .into_bytes();
    if kind == "double" {
        out.extend(
            positions
                .as_flattened()
                .iter()
                .flat_map(|x| x.to_le_bytes()),
        );
        for t in triangles {
            out.push(3);
            out.extend(t.iter().flat_map(|i| i.to_le_bytes()));
        }
        return out;
    }
    let mut text = String::new();
    for [x, y, z] in positions {
        writeln!(text, "{x} {y} {z}").unwrap();
    }
    for [a, b, c] in triangles {
        writeln!(text, "3 {a} {b} {c}").unwrap();
    }
    out.extend(text.into_bytes());
    out
}

fn stl(surface: &Surface, by: [f64; 3]) -> Vec<u8> {
    let (positions, triangles) = moved(surface, by);
    let mut text = String::from("solid s\n");
    for t in triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        for [x, y, z] in t.map(|v| positions[v as usize]) {
            writeln!(text, "vertex {x} {y} {z}").unwrap();
        }
        text += "endloop\nendfacet\n";
    }
    text += "endsolid s\n";
    text.into_bytes()
}

fn max_distance(data: &MeshData, surface: &Surface, by: [f64; 3]) -> f64 {
    let (positions, _) = moved(surface, [0.0; 3]);
    let distances = data.positions.iter().zip(positions).map(|(&p, q)| {
        let p = to_f64(p) + nalgebra::Vector3::from(data.origin) - nalgebra::Vector3::from(by);
        (p - nalgebra::Vector3::from(q)).amax()
    });
    distances.fold(0.0, f64::max)
}

#[test]
fn a_body_far_away_keeps_its_shape_in_every_format() {
    let body = torus(0.4, 0.1, 32, 16);
    for by in [[1e6; 3], SURVEY, [0.0, -1e7, 0.0]] {
        for (name, data) in [
            ("obj", read_obj(&obj(&body, by)).unwrap()),
            ("ply", read_ply(&ply(&body, by, "float")).unwrap()),
            ("ply", read_ply(&ply(&body, by, "double")).unwrap()),
        ] {
            assert_ne!(data.origin, [0.0; 3]);
            // Two roundings: of the file's 64 bits, and of coordinates below 1 m.
            let error = max_distance(&data, &body, by);
            assert!(error < 4e-8, "{name} {error}");
            assert!(
                data.positions.iter().flatten().all(|x| x.abs() < 2.0),
                "{name}"
            );
            let (surface, warnings) = data.into_surface().unwrap();
            assert!(matches!(warnings[..], [Warning::OriginMoved { .. }]));
            assert!((surface.volume() - body.volume()).abs() < 1e-7, "{name}");
        }
        let data = read_stl(&stl(&body, by)).unwrap();
        assert_eq!(data.positions.len(), body.topology().vertex_count());
        assert!(data.into_surface().is_ok());
    }
}

#[test]
fn a_file_at_round_coordinates_is_read_as_at_the_origin() {
    let body = icosphere(2, 0.5);
    let near = read_obj(&obj(&body, [0.0; 3])).unwrap();
    assert_eq!(near.origin, [0.0; 3]);
    assert_eq!(near.warnings, []);
    // Coordinates on a grid that 64 bits hold exactly at both places.
    let grid = |p: [f32; 3]| p.map(|x| (x * 1024.0).round() / 1024.0);
    let mut rounded = body.clone();
    for p in rounded.positions_mut() {
        let [x, y, z] = grid([p[0], p[1], p[2]]);
        *p = [x, y, z, 1.0];
    }
    let near = read_obj(&obj(&rounded, [0.0; 3])).unwrap();
    let far = read_obj(&obj(&rounded, [1e6, 0.0, -1e6])).unwrap();
    assert_eq!(far.origin, [1e6, 0.0, -1e6]);
    assert_eq!(far.positions, near.positions);
    assert_eq!(far.triangles, near.triangles);
}

#[test]
fn unused_vertices_do_not_count() {
    let mut text = String::from_utf8(obj(&icosphere(1, 0.5), SURVEY)).unwrap();
    text += "v 0 0 0\n";
    assert_ne!(read_obj(text.as_bytes()).unwrap().origin, [0.0; 3]);
    let mut text = String::from_utf8(obj(&icosphere(1, 0.5), [0.0; 3])).unwrap();
    text += "v 1e9 0 0\n";
    assert_eq!(read_obj(text.as_bytes()).unwrap().origin, [0.0; 3]);
}

#[test]
fn written_files_are_at_the_place_of_the_read_ones() {
    let body = torus(0.4, 0.1, 32, 16);
    let folder = tempfile::tempdir().unwrap();
    let (surface, _) = read_obj(&obj(&body, SURVEY))
        .unwrap()
        .into_surface()
        .unwrap();
    let part = surface.extract_piece(0);
    assert_eq!(part.origin(), surface.origin());
    for name in ["a.obj", "a.ply"] {
        let path = folder.path().join(name);
        if name == "a.obj" {
            write_obj(&path, &part).unwrap();
        } else {
            write_ply(&path, &part).unwrap();
        }
        let data = read_mesh(&path).unwrap();
        assert!(max_distance(&data, &body, SURVEY) < 4e-8, "{name}");
        assert_eq!(data.origin, surface.origin());
    }
}

#[test]
fn an_origin_moves_without_the_surface() {
    let body = icosphere(1, 0.5);
    let mut moved = body.clone();
    moved.move_origin([8.0, -4.0, 0.0]);
    assert_eq!(moved.origin(), [8.0, -4.0, 0.0]);
    assert!(moved != body);
    let p = moved.positions()[0];
    let q = to_f32(to_f64([p[0], p[1], p[2]]) + nalgebra::Vector3::new(8.0, -4.0, 0.0));
    assert!((to_f64(q) - body.position(crate::VertexId(0))).amax() < 1e-6);
}

#[test]
fn the_origin_of_an_empty_box_is_zero() {
    assert_eq!(nearby_origin(&Aabb::default()), [0.0; 3]);
}

#[test]
fn stl_warns_that_distant_coordinates_are_rounded() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.stl");
    let mut body = crate::cube_sphere(2, 0.5);
    assert_eq!(write_stl(&path, &body).unwrap(), []);
    body.set_origin([1e6, 0.0, 0.0]);
    let origin = body.origin();
    let warnings = write_stl(&path, &body).unwrap();
    assert_eq!(warnings, [Warning::OriginRounded { origin }]);
    assert_eq!(write_ply(&path, &body).unwrap(), []);
    assert_eq!(write_obj(&path, &body).unwrap(), []);
}

proptest! {
    /// The origin is zero or close to the box, and coordinates relative to it are small.
    #[test]
    fn origins_are_close(
        center in prop::array::uniform3(-1e9..1e9f64),
        scale in -9..9i32,
        size in prop::array::uniform3(0.0..1.0f64),
    ) {
        let point = |side: f64| {
            to_f32([0, 1, 2].map(|k| center[k] + side * size[k] * 10f64.powi(scale)).into())
        };
        let bounds = Aabb::around([point(-1.0), point(1.0)]);
        let origin = nearby_origin(&bounds);
        let diagonal = bounds.diagonal().max(bounds.center().amax() * f64::from(f32::EPSILON));
        for k in 0..3 {
            let offset = (bounds.center()[k] - origin[k]).abs();
            let limit = if origin == [0.0; 3] { FAR } else { 1.0 } * diagonal;
            prop_assert!(offset <= limit, "{offset} {diagonal}");
        }
    }
}
