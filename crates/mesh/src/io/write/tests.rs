//! Files of all formats keep every bit, and warnings name the rest.

use super::*;
use crate::ids::TriangleId;
use crate::io::read_mesh;
use crate::surface::{Blend, Channel, CornerAttributes, Domain};
use proptest::prelude::*;

fn tetrahedron(corners: [[f32; 3]; 4]) -> Surface {
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    Surface::from_triangles(&corners, &faces).unwrap()
}

fn any_coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![any::<f32>(), -1.0f32..1.0].prop_filter("finite", |x| x.is_finite())
}

proptest! {
    #[test]
    fn files_keep_every_bit(
        points in prop::array::uniform4(prop::array::uniform3(any_coordinate())),
        uv in prop::array::uniform12(prop::array::uniform2(any_coordinate())),
        normal in prop::array::uniform3(any_coordinate()),
        material: u32,
        values in prop::collection::vec(
            prop_oneof![any_coordinate(), (0u8..=255).prop_map(|b| f32::from(b) / 255.0)],
            1..50,
        ),
    ) {
        let distinct = (0..4).all(|i| (0..i).all(|j| points[i] != points[j]));
        prop_assume!(distinct);
        let mut surface = tetrahedron(points);
        surface.corners.uv = uv.to_vec();
        surface.corners.normal = vec![normal; 12];
        surface.set_material(TriangleId(2), material);
        for (name, domain, blend, width) in [
            ("color", Domain::Vertex, Blend::Linear, 3),
            ("heat", Domain::Vertex, Blend::Linear, 1),
            ("skin", Domain::Vertex, Blend::Skin, 8),
            ("uv1", Domain::Corner, Blend::Linear, 2),
            ("bones", Domain::Corner, Blend::Skin, 4),
        ] {
            let rows = surface.slots(domain) * width;
            let values = values.iter().cycle().take(rows).copied().collect();
            let channel = Channel::new(name, domain, blend, width, values).unwrap();
            surface.set_channel(channel).unwrap();
        }
        let folder = tempfile::tempdir().unwrap();
        for (name, write) in [
            ("a.obj", write_obj as fn(&Path, &Surface) -> _),
            ("a.PLY", write_ply),
        ] {
            let path = folder.path().join(name);
            let dropped = write(&path, &surface).unwrap();
            let data = read_mesh(&path).unwrap();
            let bits = |p: [f32; 3]| p.map(f32::to_bits);
            for (i, p) in data.positions.iter().enumerate() {
                prop_assert_eq!(bits(*p), bits(points[i]));
            }
            let faces: Vec<[u32; 3]> = surface
                .topology()
                .triangles()
                .map(|t| surface.topology().triangle(t).map(|v| v.0))
                .collect();
            prop_assert_eq!(&data.triangles, &faces);
            let bits = |uv: &[f32; 2]| uv.map(f32::to_bits);
            prop_assert!(data.corners.uv.iter().map(bits).eq(uv.iter().map(bits)));
            let bits = |n: &[f32; 3]| n.map(f32::to_bits);
            let normals = &surface.corners.normal;
            prop_assert!(data.corners.normal.iter().map(bits).eq(normals.iter().map(bits)));
            if name == "a.obj" {
                let rest = ["heat", "skin", "uv1", "bones"].map(str::to_owned);
                prop_assert_eq!(dropped, rest.map(|name| Warning::Dropped { name }));
                prop_assert_eq!(&data.channels[..], &surface.channels[..1]);
            } else {
                prop_assert_eq!(dropped, []);
                prop_assert_eq!(&data.channels, &surface.channels);
                prop_assert_eq!(data.file_vertices, surface.seam_split_vertices());
            }
            for (a, b) in data.channels.iter().zip(&surface.channels) {
                let bits = |channel: &Channel| {
                    channel.values().iter().map(|x| x.to_bits()).collect::<Vec<_>>()
                };
                prop_assert_eq!(bits(a), bits(b));
            }
            let materials = if material == 0 { vec![] } else { vec![0, 0, material, 0] };
            prop_assert_eq!(data.materials, materials);
        }
        let path = folder.path().join("a.stl");
        let dropped = write_stl(&path, &surface).unwrap();
        let mut names = vec!["texture coordinates", "normals", "materials"];
        names.truncate(if material == 0 { 2 } else { 3 });
        names.extend(surface.channels.iter().map(Channel::name));
        let warning = |name: &&str| Warning::Dropped { name: (*name).to_owned() };
        prop_assert_eq!(dropped, names.iter().map(warning).collect::<Vec<_>>());
        let data = read_mesh(&path).unwrap();
        let corners = data.triangles.as_flattened().iter();
        let corners = corners.map(|&v| data.positions[v as usize].map(f32::to_bits));
        let expected = surface.topology().corners().iter();
        prop_assert!(corners.eq(expected.map(|v| points[v.index()].map(f32::to_bits))));
    }
}

/// Returns names of channels: any text, and words that files give a meaning.
fn any_name() -> impl Strategy<Value = String> {
    let words = [
        "x",
        "nx",
        "s",
        "u",
        "red",
        "alpha",
        "color",
        "normal",
        "texcoord",
        "material",
        "vertex_indices",
        "vertex_index",
        "heat",
        "heat_0",
        "heat_weight",
        "heat_joint",
        "heat_skin",
        "a b",
        "a\nend_header",
        "property",
        "",
    ];
    let word = prop::sample::select(words.to_vec()).prop_map(str::to_owned);
    prop_oneof![word, "[ -~\n\u{e9}]{0,4}(_[0-9]{1,2})?"]
}

proptest! {
    #[test]
    fn ply_has_the_channels_without_a_warning(
        channels in prop::collection::vec((any_name(), any::<[bool; 2]>(), 1usize..5), 0..6),
        is_byte: bool,
    ) {
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mut surface = tetrahedron(corners);
        for (name, [is_corner, is_skin], width) in channels {
            let domain = if is_corner { Domain::Corner } else { Domain::Vertex };
            let (blend, width) = if is_skin && !is_corner {
                (Blend::Skin, 2 * width)
            } else {
                (Blend::Linear, width)
            };
            let count = surface.slots(domain) * width;
            let values = (0..count).map(|i| if is_byte { 1.0 } else { i as f32 + 0.5 });
            let values = values.collect();
            let channel = Channel::new(name, domain, blend, width, values).unwrap();
            surface.set_channel(channel).unwrap();
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ply");
        let dropped = write_ply(&path, &surface).unwrap();
        let data = read_mesh(&path).unwrap();
        prop_assert_eq!(&data.warnings, &[]);
        let is_dropped = |name: &str| dropped.contains(&Warning::dropped(name.as_bytes()));
        let of = |domain: Domain| {
            let all = surface.channels.iter().filter(move |c| c.domain() == domain);
            all.filter(|c| !is_dropped(c.name())).cloned()
        };
        let kept: Vec<Channel> = of(Domain::Vertex).chain(of(Domain::Corner)).collect();
        prop_assert_eq!(&data.channels, &kept);
        prop_assert_eq!(kept.len() + dropped.len(), surface.channels.len());
        prop_assert_eq!(data.positions, corners);
        prop_assert_eq!(data.corners, CornerAttributes::default());
    }
}

#[test]
fn materials_are_named_where_they_change() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut surface = tetrahedron(corners);
    let lines = |surface: &Surface| {
        let mut out = Vec::new();
        obj::write(surface, &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        let lines = text.lines().filter(|line| !line.starts_with('v'));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(lines(&surface).len(), 4, "one material needs no name");
    surface.set_material(TriangleId(1), 7);
    surface.set_material(TriangleId(2), 7);
    let (skin, cap) = ("usemtl material_0", "usemtl material_7");
    let expected = [skin, "f 1 3 2", cap, "f 1 2 4", "f 2 3 4", skin, "f 3 1 4"];
    assert_eq!(lines(&surface), expected);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    write_obj(&path, &surface).unwrap();
    let (read, _) = read_mesh(&path).unwrap().into_surface().unwrap();
    let materials: Vec<u32> = (0..4).map(|t| read.material(TriangleId(t))).collect();
    assert_eq!(materials, [0, 7, 7, 0]);
}

#[test]
fn memory_and_files_get_the_same_bytes() {
    let surface = tetrahedron([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    let mut bytes = Vec::new();
    write_obj_to(&mut bytes, &surface).unwrap();
    write_obj(&path, &surface).unwrap();
    assert_eq!(bytes, std::fs::read(&path).unwrap());
    #[cfg(feature = "gltf")]
    {
        let mut bytes = Vec::new();
        write_glb_to(&mut bytes, &[("body", &surface)]).unwrap();
        write_glb(&path, &[("body", &surface)]).unwrap();
        assert_eq!(bytes, std::fs::read(&path).unwrap());
    }
}

#[test]
fn free_slots_are_left_out() {
    let mut surface = tetrahedron([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let unused = surface.remove_triangles(&[TriangleId(0)]);
    surface.remove_vertices(&unused);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    write_obj(&path, &surface).unwrap();
    let data = read_mesh(&path).unwrap();
    assert_eq!(data.triangles.len(), 3);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_failed_write_leaves_no_file() {
    let surface = tetrahedron([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let folder = tempfile::tempdir().unwrap();
    let taken = folder.path().join("taken.obj");
    std::fs::create_dir(&taken).unwrap();
    assert_eq!(write_obj(&taken, &surface).unwrap_err().path, taken);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    assert!(write_ply(&folder.path().join("none/a.ply"), &surface).is_err());
}
