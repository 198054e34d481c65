use super::*;
use crate::surface::Domain;

/// Returns a document with a triangle whose positions are in a binary chunk.
fn glb(nodes: &str, primitive: &str) -> Vec<u8> {
    let mut json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":{nodes},
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}{primitive}}}]}}],
        "bufferViews":[{{"buffer":0,"byteLength":48}},
        {{"buffer":0,"byteOffset":48,"byteLength":4}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}},
        {{"bufferView":1,"componentType":5121,"count":4,"type":"SCALAR"}},
        {{"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"}}],
        "buffers":[{{"byteLength":52}}]}}"#
    );
    while !json.len().is_multiple_of(4) {
        json.push(' ');
    }
    let points = [
        0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0,
    ];
    let mut binary: Vec<u8> = points.iter().flat_map(|x| x.to_le_bytes()).collect();
    binary.extend([0, 1, 2, 3]);
    let mut out = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, chunk) in [(b"JSON", json.as_bytes()), (b"BIN\0", &binary)] {
        out.extend(u32::try_from(chunk.len()).unwrap().to_le_bytes());
        out.extend(kind);
        out.extend(chunk);
    }
    out
}

fn read(nodes: &str, primitive: &str) -> Result<MeshData, ParseError> {
    read_gltf(&glb(nodes, primitive), None)
}

#[test]
fn lists_strips_and_fans_are_read() {
    let node = r#"[{"mesh":0}]"#;
    let triangles = |primitive| read(node, primitive).unwrap().triangles;
    assert_eq!(triangles(r#","indices":2"#), [[0, 1, 2]]);
    assert_eq!(
        triangles(r#","indices":1,"mode":5"#),
        [[0, 1, 2], [1, 3, 2]]
    );
    assert_eq!(triangles(r#","mode":6"#), [[0, 1, 2], [0, 2, 3]]);
    assert!(matches!(
        read(node, r#","mode":0"#).unwrap_err(),
        ParseError::NoFaces
    ));
    assert!(matches!(
        read(node, r#","indices":1"#).unwrap_err(),
        ParseError::Syntax {
            at: SourceLocation::Primitive(0, 0),
            ..
        }
    ));
}

#[test]
fn transforms_chain_and_mirrors_flip() {
    let nodes = r#"[{"translation":[10,0,0],"children":[1]},{"scale":[-2,1,1],"mesh":0}]"#;
    let data = read(nodes, r#","indices":2"#).unwrap();
    assert_eq!(
        data.positions,
        [[10.0, 0.0, 0.0], [8.0, 0.0, 0.0], [10.0, 1.0, 0.0]]
    );
    assert_eq!(data.triangles, [[0, 2, 1]]);
}

#[test]
fn a_cyclic_node_is_an_error() {
    let nodes = r#"[{"children":[1]},{"children":[0]}]"#;
    assert!(matches!(
        read(nodes, "").unwrap_err(),
        ParseError::Syntax {
            at: SourceLocation::Node(0),
            ..
        }
    ));
}

#[test]
fn a_truncated_file_is_an_error() {
    let whole = glb(r#"[{"mesh":0}]"#, r#","indices":2"#);
    for end in 4..whole.len() {
        assert!(
            read_gltf(&whole[..end], None).is_err(),
            "cut after {end} bytes"
        );
    }
}

#[test]
fn shared_data_has_a_memory_limit() {
    // Nodes share a mesh whose primitives share an accessor: 999 positions unfold to 16 million.
    let points = 999;
    let primitives = vec![r#"{"attributes":{"POSITION":0}}"#; 160].join(",");
    let nodes = vec![r#"{"mesh":0}"#; 100].join(",");
    let roots: Vec<String> = (0..100).map(|i| i.to_string()).collect();
    let base64 = "A".repeat(points * 16);
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[{}]}}],"nodes":[{nodes}],
        "meshes":[{{"primitives":[{primitives}]}}],
        "bufferViews":[{{"buffer":0,"byteLength":{}}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":{points},"type":"VEC3"}}],
        "buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{base64}"}}]}}"#,
        roots.join(","),
        points * 12,
        points * 12
    );
    let error = read_gltf(text.as_bytes(), None).unwrap_err();
    assert!(matches!(error, ParseError::TooLarge), "{error}");
}

/// Returns a document whose triangle is in another file.
fn beside(uri: &str) -> Vec<u8> {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}],
        "buffers":[{{"byteLength":36,"uri":"{uri}"}}]}}"#
    )
    .into_bytes()
}

#[test]
fn buffers_must_be_in_the_folder_or_below() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("inner");
    std::fs::create_dir(&inner).unwrap();
    let points = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let bytes: Vec<u8> = points.iter().flat_map(|x| x.to_le_bytes()).collect();
    for path in [folder.path().join("mesh.bin"), inner.join("mesh.bin")] {
        std::fs::write(path, &bytes).unwrap();
    }
    let outside = folder.path().join("mesh.bin");
    let outside = outside.to_str().unwrap().replace('\\', "/");
    assert!(read_gltf(&beside("mesh.bin"), Some(&inner)).is_ok());
    assert!(read_gltf(&beside("inner/mesh.bin"), Some(folder.path())).is_ok());
    for uri in ["../mesh.bin", &outside, "/dev/zero"] {
        let error = read_gltf(&beside(uri), Some(&inner)).unwrap_err();
        assert!(
            matches!(
                error,
                ParseError::Syntax {
                    at: SourceLocation::Buffer(0),
                    ..
                }
            ),
            "{uri}: {error}"
        );
    }
    let error = read_gltf(&beside("missing.bin"), Some(&inner)).unwrap_err();
    assert!(matches!(error, ParseError::Buffer { .. }), "{error}");
}

#[cfg(unix)]
#[test]
fn a_buffer_that_is_no_regular_file_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink("/dev/zero", folder.path().join("mesh.bin")).unwrap();
    let error = read_gltf(&beside("mesh.bin"), Some(folder.path())).unwrap_err();
    assert!(matches!(error, ParseError::Buffer { .. }), "{error}");
}

#[test]
fn distant_nodes_keep_the_shape_of_their_meshes() {
    let at = |translation: &str| {
        let nodes = format!(r#"[{{"mesh":0,"translation":[{translation}]}}]"#);
        read(&nodes, r#","mode":5"#).unwrap()
    };
    let (far, near) = (at("1000000.25,0,-4000000"), at("0.25,0,0"));
    assert_eq!(far.origin, [1e6, 0.0, -4e6]);
    assert_eq!(far.positions, near.positions);
    assert_eq!(far.triangles, near.triangles);
}

fn attribute(name: &str, accessor: usize) -> String {
    format!(r#","{name}":{accessor}"#)
}

/// Returns a document with two triangles that have further attributes.
fn file(attributes: &str) -> Vec<u8> {
    let bytes = glb(r#"[{"mesh":0}]"#, r#","mode":6"#);
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let end = text.find("BIN").unwrap() - 4;
    let json = text[20..end].replace(r#""POSITION":0"#, &format!(r#""POSITION":0{attributes}"#));
    let mut file = json.into_bytes();
    file.resize(file.len().next_multiple_of(4), b' ');
    let mut out = bytes[..12].to_vec();
    out.extend(u32::try_from(file.len()).unwrap().to_le_bytes());
    out.extend(b"JSON");
    out.extend(file);
    out.extend(&bytes[end..]);
    out
}

#[test]
fn the_first_of_attributes_of_one_channel_is_kept() {
    for (first, second) in [
        ("COLOR_0", "_color"),
        ("COLOR_1", "_color1"),
        ("COLOR_0", "COLOR_00"),
        ("TEXCOORD_01", "TEXCOORD_1"),
    ] {
        let both = attribute(first, 0) + &attribute(second, 0);
        let data = read_gltf(&file(&both), None).unwrap();
        let alone = read_gltf(&file(&attribute(first, 0)), None).unwrap();
        assert_eq!(data.channels, alone.channels);
        assert_eq!(data.warnings, [Warning::dropped(second.as_bytes())]);
    }
}

#[test]
fn further_attributes_become_channels() {
    let all = [
        attribute("COLOR_0", 0),
        attribute("TEXCOORD_2", 0),
        attribute("_HEAT", 1),
    ]
    .concat();
    let data = read_gltf(&file(&all), None).unwrap();
    let found = data
        .channels
        .iter()
        .map(|c| (c.name(), c.domain(), c.values().len()));
    let expected = [
        ("color", Domain::Vertex, 12),
        ("uv2", Domain::Corner, 18),
        ("HEAT", Domain::Vertex, 4),
    ];
    assert_eq!(found.collect::<Vec<_>>(), expected);
    assert_eq!(data.channels[2].values(), [0.0, 1.0, 2.0, 3.0]);
    assert_eq!(data.warnings, []);
    let dropped = read_gltf(&file(&attribute("JOINTS_0", 1)), None).unwrap();
    let name = "JOINTS_0".to_owned();
    assert_eq!(dropped.warnings, [Warning::Dropped { name }]);
    let many: String = (0..200_000)
        .map(|i| attribute(&format!("_A{i}"), 0))
        .collect();
    assert!(matches!(
        read_gltf(&file(&many), None),
        Ok(_) | Err(ParseError::TooLarge)
    ));
}
