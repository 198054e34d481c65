use super::*;

const UP: [f64; 3] = [0.0, 1.0, 0.0];

/// Returns the parameters of a level.
fn level(name: &str) -> Value {
    Value::Map(vec![("level".to_owned(), Value::from(name))])
}

#[test]
fn a_cut_is_two_closed_pieces_with_caps_and_undo_takes_it_back() {
    let mut mesh = Mesh::model("Sphere768").unwrap();
    let before = mesh.surface().clone();
    let report = mesh.cut(&UP, 0.0, &Value::None).unwrap();
    for (name, expected) in [
        ("is_miss", false.value()),
        ("refined", true.value()),
        ("pieces_added", 1_usize.value()),
    ] {
        assert_eq!(report.at(name), Some(expected), "{name}");
    }
    assert_eq!(mesh.piece_numbers().len(), 2);
    let mask = mesh
        .arrays()
        .caps
        .iter()
        .map(|&m| usize::from(m))
        .sum::<usize>();
    assert_eq!(report.at("cap_triangles"), Some(mask.value()));
    let pieces = mesh
        .piece_numbers()
        .into_iter()
        .map(|p| mesh.piece(p.into()).unwrap());
    for mut piece in pieces {
        let report = piece.check().unwrap();
        assert!(report.closed && report.defects.is_empty());
    }
    mesh.undo().unwrap();
    assert_eq!(mesh.surface().positions(), before.positions());
    assert!(
        mesh.surface()
            .topology()
            .triangles()
            .eq(before.topology().triangles())
    );
    assert!(matches!(mesh.undo(), Err(WebError::NothingToUndo)));
    assert!(matches!(
        mesh.piece(3.0),
        Err(WebError::UnknownPiece { piece: 3.0 })
    ));
}

#[test]
fn exports_are_read_again() {
    let mut mesh = Mesh::model("Sphere80").unwrap();
    let _ = mesh.cut(&UP, 0.1, &level("2x-finer")).unwrap();
    for (format, bytes) in [("obj", mesh.to_obj()), ("GLB", mesh.to_glb())] {
        let read = Mesh::from_bytes(&bytes.unwrap(), format).unwrap();
        assert_eq!(read.triangle_count(), mesh.triangle_count(), "{format}");
    }
}

#[test]
fn hostile_arrays_and_files_are_errors() {
    let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    for (positions, triangles) in [
        (&corners[..], &[0, 1, 3][..]),
        (&corners, &[0, 1, u32::MAX]),
        (&corners, &[0, 1]),
        (&corners[..8], &[0, 1, 2]),
        (&[f32::NAN; 9], &[0, 1, 2]),
        (&[f32::INFINITY; 9], &[0, 1, 2]),
        (&[0.0; 9], &[0, 1, 2]),
        (&[], &[]),
    ] {
        assert!(
            Mesh::from_slices(positions, triangles).is_err(),
            "{triangles:?}"
        );
    }
    let sheet = Mesh::from_slices(&corners, &[0, 1, 2]).unwrap();
    assert_eq!((sheet.triangle_count(), sheet.piece_count()), (1, 1));
    for format in ["obj", "ply", "stl", "glb", "gltf", "exe"] {
        for bytes in [&[][..], &[0xff; 100], b"glTF\x02\0\0\0\xff\xff\xff\xff"] {
            assert!(Mesh::from_bytes(bytes, format).is_err(), "{format}");
        }
    }
}

#[test]
fn hostile_planes_are_errors_or_misses() {
    let mut mesh = Mesh::model("Sphere80").unwrap();
    for normal in [[0.0; 3], [f64::NAN; 3], [f64::INFINITY; 3]] {
        assert!(mesh.cut(&normal, 0.0, &Value::None).is_err());
    }
    assert!(mesh.cut(&UP[..2], 0.0, &Value::None).is_err());
    assert!(mesh.cut(&UP, f64::NAN, &Value::None).is_err());
    for name in ["0", "nan", "-1", ""] {
        assert!(mesh.cut(&UP, 0.0, &level(name)).is_err());
    }
    let caps = Value::Map(vec![("caps".to_owned(), Value::from("some"))]);
    assert!(mesh.cut(&UP, 0.0, &caps).is_err());
    let miss = mesh.cut(&UP, 1e300, &Value::None).unwrap();
    assert_eq!(miss.at("is_miss"), Some(true.value()));
    assert_eq!((mesh.undo_count(), mesh.triangle_count()), (0, 80));
}
