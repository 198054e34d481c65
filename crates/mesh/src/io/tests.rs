//! Random bytes: no reader panics, and accepted data is valid.

use super::*;
use crate::surface::{Blend, Channel, Domain};
use proptest::prelude::*;

const OBJ: &[u8] = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0 # c\nvt 0 0\nvn 0 0 1\n\
    f 1/1/1 2/1/1 3/1 4\nf -1 -2 \\\n -3\n";
const STL_TEXT: &[u8] = b"solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n\
    vertex 0 1 0\nendloop\nendfacet\nendsolid s\n";
const PLY_TEXT: &[u8] =
    b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
    property float z\nproperty float s\nproperty float t\nelement face 1\n\
    property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n\
    0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2 6 0 0 1 0 1 1\n";
const PLY_STRIPS: &[u8] =
    b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
    property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n\
    0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 2 1\n";
const GLTF: &[u8] = concat!(
    r#"{"scenes":[{"nodes":[0]}],
    "nodes":[{"mesh":0,"scale":[1,2,-3],"children":[1]},{}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"mode":4}]}],
    "bufferViews":[{"buffer":0,"byteLength":36},
    {"buffer":0,"byteOffset":36,"byteLength":4,"byteStride":1}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
    {"bufferView":1,"byteOffset":0,"componentType":5121,"count":3,"type":"SCALAR"}],
    "buffers":[{"byteLength":40,"uri":"data:application/octet-stream;base64,"#,
    r#"AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAECAA=="}]}"#
)
.as_bytes();

fn ply_binary() -> Vec<u8> {
    let text = std::str::from_utf8(PLY_TEXT).unwrap();
    let header = text.split_inclusive("end_header\n").next().unwrap();
    let mut out = header.replace("ascii", "binary_little_endian").into_bytes();
    out.extend(
        [0.0f32, 1.0, 2.0]
            .repeat(5)
            .iter()
            .flat_map(|x| x.to_le_bytes()),
    );
    out.push(3);
    out.extend([0u32, 1, 2].iter().flat_map(|i| i.to_le_bytes()));
    out.push(6);
    out.extend([0.5f32; 6].iter().flat_map(|x| x.to_le_bytes()));
    out
}

fn stl_binary() -> Vec<u8> {
    let mut out = vec![0; 84];
    out[80] = 2;
    out.extend((0..100u8).map(|i| i % 4));
    out
}

fn glb() -> Vec<u8> {
    let mut out = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    out.extend(u32::try_from(GLTF.len()).unwrap().to_le_bytes());
    out.extend(b"JSON");
    out.extend(GLTF);
    out
}

/// A file with a binary chunk: colors, skin weights, texture coordinates, normals, and others.
fn glb_with_attributes() -> Vec<u8> {
    let mut surface = crate::cube_sphere(1, 0.5);
    let channels = [
        ("color", Domain::Corner, Blend::Linear, 4),
        ("skin", Domain::Vertex, Blend::Skin, 8),
        ("uv1", Domain::Corner, Blend::Linear, 2),
        ("heat", Domain::Vertex, Blend::Linear, 1),
    ];
    for (name, domain, blend, width) in channels {
        let values = vec![0.25; surface.slots(domain) * width];
        let channel = Channel::new(name, domain, blend, width, values).unwrap();
        surface.set_channel(channel).unwrap();
    }
    let mut out = Vec::new();
    write_glb_to(&mut out, &[("a", &surface), ("b", &surface)]).unwrap();
    out
}

fn valid_files() -> [Vec<u8>; 9] {
    [
        OBJ.to_vec(),
        STL_TEXT.to_vec(),
        stl_binary(),
        PLY_TEXT.to_vec(),
        ply_binary(),
        PLY_STRIPS.to_vec(),
        GLTF.to_vec(),
        glb(),
        glb_with_attributes(),
    ]
}

type Reader = fn(&[u8]) -> Result<MeshData, ParseError>;

fn read_with_all(bytes: &[u8]) -> usize {
    let read: [Reader; 4] = [read_obj, read_ply, read_stl, |bytes| read_gltf(bytes, None)];
    let mut accepted = 0;
    for data in read.iter().filter_map(|read| read(bytes).ok()) {
        accepted += 1;
        assert!(
            !data.triangles.is_empty(),
            "accepted means that there are faces"
        );
        assert!(
            data.triangles
                .iter()
                .flatten()
                .all(|&v| (v as usize) < data.positions.len()),
            "indices are in range"
        );
        assert!(
            data.positions.iter().flatten().all(|x| x.is_finite()),
            "coordinates are finite"
        );
        let fit = crate::check(&data).is_cuttable().is_ok();
        let surface = data.into_surface();
        assert_eq!(fit, surface.is_ok(), "the report and the surface agree");
        if let Ok((surface, _)) = surface {
            surface.validate().unwrap();
            assert!(surface.topology().is_closed(), "a fit surface is closed");
        }
    }
    accepted
}

#[test]
fn unmodified_files_are_valid() {
    for file in valid_files() {
        assert_eq!(
            read_with_all(&file),
            1,
            "{}",
            String::from_utf8_lossy(&file)
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn random_bytes_are_survived(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        read_with_all(&bytes);
    }

    #[test]
    fn broken_files_are_survived(
        file in 0..9usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4u8), 0..4),
        end in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut bytes = valid_files()[file].clone();
        for (at, value, kind) in changes {
            let at = at.index(bytes.len());
            match kind {
                0 => bytes[at] = value,
                // Replacing digits by digits keeps text readable but makes counts and indices
                // wrong.
                1 => bytes[at] = b"0123456789-.e"[usize::from(value) % 13],
                2 => bytes.insert(at, b"0123456789-.e /\n"[usize::from(value) % 16]),
                _ => { bytes.remove(at); }
            }
        }
        if let Some(end) = end {
            bytes.truncate(end.index(bytes.len()));
        }
        read_with_all(&bytes);
    }
}
