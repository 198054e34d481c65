//! GLB files keep every bit, and name or replace what they cannot hold.

use super::*;
use crate::io::read_gltf;
use crate::shapes::{cube_sphere, torus};
use crate::surface::{Domain, Surface};
use crate::{HalfEdge, TriangleId};
use proptest::prelude::*;

fn bytes_of(surfaces: &[(&str, &Surface)]) -> (Vec<u8>, Vec<Warning>) {
    let mut out = Vec::new();
    let still = surfaces
        .iter()
        .map(|&(name, surface)| AnimatedSurface::still(name, surface));
    let dropped = write(&still.collect::<Vec<_>>(), &mut out).unwrap();
    (out, dropped)
}

/// Returns position, attributes and material of every corner of every triangle, sorted.
fn corners(surface: &Surface, names: &[&str]) -> Vec<Vec<u32>> {
    let corner = |h: HalfEdge| {
        let v = surface.topology().origin(h);
        let [x, y, z, _] = surface.positions()[v.index()];
        let mut out = vec![x, y, z];
        out.extend(surface.corner_uvs()[h.index()]);
        out.extend(surface.corner_normals()[h.index()]);
        for name in names {
            let channel = surface.channel(name).unwrap();
            let slot = match channel.domain() {
                Domain::Vertex => v.index(),
                Domain::Corner => h.index(),
            };
            out.extend(channel.row(slot));
        }
        out.iter().map(|x| x.to_bits()).collect::<Vec<u32>>()
    };
    let mut out: Vec<Vec<u32>> = Vec::new();
    for t in surface.topology().triangles() {
        let mut triangle: Vec<u32> = t.half_edges().into_iter().flat_map(corner).collect();
        triangle.push(surface.material(t));
        out.push(triangle);
    }
    out.sort_unstable();
    out
}

proptest! {
    #[test]
    fn files_keep_every_bit(
        values in prop::collection::vec(
            (-1e3f32..1e3).prop_filter("not zero", |x| *x != 0.0),
            1..99,
        ),
        joints in prop::collection::vec(0u16..999, 1..99),
        material in 0u32..5,
    ) {
        let mut surface = torus(0.4, 0.15, 5, 4);
        let corners_of = 3 * surface.topology().triangle_slots();
        let cycle = |count: usize| values.iter().cycle().copied().take(count);
        let rows: Vec<f32> = cycle(2 * corners_of).collect();
        surface.set_corner_uvs(rows.as_chunks::<2>().0.to_vec()).unwrap();
        let rows: Vec<f32> = cycle(3 * corners_of).collect();
        surface.set_corner_normals(rows.as_chunks::<3>().0.to_vec()).unwrap();
        surface.set_material(TriangleId(3), material);
        let names = ["color", "uv1", "HEAT", "skin"];
        for (name, domain, width) in [
            ("color", Domain::Vertex, 4),
            ("uv1", Domain::Corner, 2),
            ("HEAT", Domain::Vertex, 1),
        ] {
            let values = cycle(surface.slots(domain) * width).collect();
            let channel = Channel::new(name, domain, Blend::Linear, width, values).unwrap();
            surface.set_channel(channel).unwrap();
        }
        let slots = surface.slots(Domain::Vertex);
        let skin = (0..slots).flat_map(|v| {
            let joint = |k: usize| f32::from(joints[(v + k) % joints.len()]);
            [joint(0), joint(1), joint(2), joint(3), 0.5, 0.25, 0.125, 0.125]
        });
        let skin = Channel::new("skin", Domain::Vertex, Blend::Skin, 8, skin.collect());
        surface.set_channel(skin.unwrap()).unwrap();
        let (bytes, dropped) = bytes_of(&[("ring", &surface)]);
        prop_assert_eq!(dropped, []);
        let data = read_gltf(&bytes, None).unwrap();
        prop_assert_eq!(&data.warnings, &[]);
        let (again, _) = data.into_surface().unwrap();
        prop_assert_eq!(corners(&again, &names), corners(&surface, &names));
    }
}

#[test]
fn zero_normals_become_those_of_the_surface() {
    let mut surface = cube_sphere(2, 0.5);
    let corners = surface.slots(Domain::Corner);
    surface.set_corner_normals(vec![[0.0; 3]; corners]).unwrap();
    let (bytes, _) = bytes_of(&[("a", &surface)]);
    let (again, _) = read_gltf(&bytes, None).unwrap().into_surface().unwrap();
    assert_eq!(again.corner_normals().len(), corners);
    for [x, y, z] in again.corner_normals() {
        assert!((x * x + y * y + z * z - 1.0).abs() < 1e-5, "{x} {y} {z}");
    }
}

#[test]
fn a_node_without_attributes_beside_one_with_them_gets_neutral_ones() {
    let bare = cube_sphere(1, 0.25);
    let mut full = cube_sphere(1, 0.5);
    let skin = [1.0, 2.0, 3.0, 0.0, 0.5, 0.25, 0.125, 0.125];
    for (name, blend, row) in [
        ("color", Blend::Linear, &skin[4..]),
        ("skin", Blend::Skin, &skin[..]),
    ] {
        let values = row.repeat(full.slots(Domain::Vertex));
        let channel = Channel::new(name, Domain::Vertex, blend, row.len(), values).unwrap();
        full.set_channel(channel).unwrap();
    }
    for nodes in [[("a", &bare), ("b", &full)], [("b", &full), ("a", &bare)]] {
        let (bytes, dropped) = bytes_of(&nodes);
        assert_eq!(dropped, []);
        let data = read_gltf(&bytes, None).unwrap();
        let named = data.warnings.iter().filter_map(|warning| match warning {
            Warning::PartialAttributes { name, .. } => Some(name.as_str()),
            _ => None,
        });
        assert_eq!(named.collect::<Vec<_>>(), ["color", "skin"]);
        let colors = data.channels[0].values().chunks(4);
        assert!(colors.clone().any(|row| row == [1.0; 4]));
        assert!(colors.clone().all(|row| row[0] > 0.0 && row[3] > 0.0));
        let mut skin = data.channels[1].values().chunks(8);
        assert!(skin.all(|row| row[4..].iter().sum::<f32>() == 1.0));
    }
}

#[test]
fn nodes_materials_and_dropped_channels() {
    let mut surface = cube_sphere(2, 0.5);
    surface.set_material(TriangleId(0), 1);
    surface.set_origin([1e6, 0.0, 0.0]);
    let slots = surface.slots(Domain::Vertex);
    let wide = Channel::new(
        "wide",
        Domain::Vertex,
        Blend::Linear,
        5,
        vec![0.0; 5 * slots],
    );
    surface.set_channel(wide.unwrap()).unwrap();
    let (bytes, dropped) = bytes_of(&[("a", &surface), ("b", &surface)]);
    let name = "wide".to_owned();
    assert_eq!(dropped, [Warning::Dropped { name }]);
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let json: Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    assert_eq!(json["nodes"][1]["translation"], json!([1e6, 0.0, 0.0]));
    assert_eq!(json["meshes"][0]["primitives"].as_array().unwrap().len(), 2);
    assert_eq!(json["materials"].as_array().unwrap().len(), 2);
    assert_eq!(bytes.len() % 4, 0);
    let (none, _) = bytes_of(&[]);
    let error = read_gltf(&none, None).unwrap_err();
    assert_eq!(error.to_string(), "the file has no faces");
}
