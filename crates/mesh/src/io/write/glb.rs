//! Writes binary glTF 2.0: a node per surface, a primitive per material.

mod animation;

pub use animation::AnimatedSurface;

use crate::io::Warning;
use crate::render_buffers::{RenderBuffers, RenderParams};
use crate::surface::{Blend, Channel};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{self, Write};

const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;
/// Targets of buffer views.
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;
/// Base colors of the materials 0, the skin, and of all others, the caps \[linear RGBA\].
const COLORS: [[f32; 4]; 2] = [[0.8, 0.62, 0.5, 1.0], [0.5, 0.06, 0.05, 1.0]];

/// The parts of a file while it is put together.
#[derive(Default)]
struct Document {
    binary: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
    /// The index of each material number.
    materials: BTreeMap<u32, usize>,
    dropped: Vec<String>,
    /// Channels and samplers of the animation.
    channels: Vec<Value>,
    samplers: Vec<Value>,
}

/// Writes surfaces, each with the name of its node, and returns warnings about dropped attributes.
pub(super) fn write(
    surfaces: &[AnimatedSurface<'_>],
    out: &mut impl Write,
) -> io::Result<Vec<Warning>> {
    let mut document = Document::default();
    for surface in surfaces {
        if surface.surface.topology().triangle_count() > 0 {
            document.add(surface)?;
        }
    }
    let mut animations = Vec::new();
    if !document.channels.is_empty() {
        animations.push(json!({"channels": document.channels, "samplers": document.samplers}));
    }
    let too_large = |_| io::Error::other("glTF files end at 4 GiB; write fewer surfaces");
    let materials: BTreeMap<usize, u32> = document
        .materials
        .iter()
        .map(|(&number, &index)| (index, number))
        .collect();
    let materials: Vec<Value> = materials.values().map(|&number| material(number)).collect();
    let nodes: Vec<usize> = (0..document.nodes.len()).collect();
    let mut json = json!({
        "asset": {"version": "2.0", "generator": "incise"},
        "scene": 0,
        "scenes": [{"nodes": nodes}],
    });
    // Empty arrays are not allowed.
    for (name, values) in [
        ("nodes", document.nodes),
        ("meshes", document.meshes),
        ("materials", materials),
        ("accessors", document.accessors),
        ("bufferViews", document.views),
        ("animations", animations),
    ] {
        if !values.is_empty() {
            json[name] = Value::Array(values);
        }
    }
    if document.binary.is_empty() {
        json["scenes"] = json!([{}]);
    } else {
        json["buffers"] = json!([{"byteLength": document.binary.len()}]);
    }
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let chunks = [(text, b"JSON"), (document.binary, b"BIN\0")];
    let chunks = chunks.iter().filter(|(bytes, _)| !bytes.is_empty());
    let length = 12
        + chunks
            .clone()
            .map(|(bytes, _)| 8 + bytes.len())
            .sum::<usize>();
    out.write_all(b"glTF\x02\0\0\0")?;
    out.write_all(&u32::try_from(length).map_err(too_large)?.to_le_bytes())?;
    for (bytes, kind) in chunks {
        out.write_all(&u32::try_from(bytes.len()).map_err(too_large)?.to_le_bytes())?;
        out.write_all(*kind)?;
        out.write_all(bytes)?;
    }
    document.dropped.sort_unstable();
    document.dropped.dedup();
    let dropped = document.dropped.into_iter();
    Ok(dropped.map(|name| Warning::Dropped { name }).collect())
}

/// Returns the surface's own normals, computed ones where these are zero or do not follow it.
fn normals(animated: &AnimatedSurface<'_>, buffers: &RenderBuffers) -> Vec<[f32; 3]> {
    let mut normals = buffers.normals().to_vec();
    if animated.times.is_empty() {
        for (normal, h) in normals.iter_mut().zip(buffers.corners()) {
            let own = animated.surface.corner_normals().get(h.index());
            if let Some(own) = own.filter(|own| **own != [0.0; 3]) {
                *normal = *own;
            }
        }
    }
    normals
}

/// Returns a material with the name that readers of this crate know.
fn material(number: u32) -> Value {
    json!({
        "name": format!("material_{number}"),
        "pbrMetallicRoughness": {
            "baseColorFactor": COLORS[usize::from(number > 0)],
            "metallicFactor": 0.0,
            "roughnessFactor": 0.6,
        },
    })
}

impl Document {
    fn add(&mut self, animated: &AnimatedSurface<'_>) -> io::Result<()> {
        let AnimatedSurface { name, surface, .. } = *animated;
        let mut buffers = RenderBuffers::new(surface, RenderParams::default());
        let normals = normals(animated, &buffers);
        let mut attributes = json!({
            "POSITION": self.vectors(buffers.positions()),
            "NORMAL": self.floats(3, normals.as_flattened()),
        });
        let mut sets = 0;
        if !buffers.uvs().is_empty() {
            attributes["TEXCOORD_0"] = self.floats(2, buffers.uvs().as_flattened());
            sets = 1;
        }
        for channel in buffers.channels() {
            self.add_channel(channel, &mut sets, &mut attributes);
        }
        let mut indices: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (t, triangle) in buffers.triangles() {
            indices
                .entry(surface.material(t))
                .or_default()
                .extend(triangle);
        }
        let targets = self.add_targets(animated, &mut buffers);
        let primitives = indices.iter().map(|(&material, indices)| {
            let next = self.materials.len();
            let material = *self.materials.entry(material).or_insert(next);
            let bytes = indices.iter().flat_map(|i| i.to_le_bytes());
            let indices = self.accessor(U32, "SCALAR", indices.len(), bytes.collect(), INDICES);
            let mut primitive =
                json!({"attributes": attributes, "indices": indices, "material": material});
            if !targets.is_empty() {
                primitive["targets"] = json!(targets);
            }
            primitive
        });
        let primitives: Vec<Value> = primitives.collect();
        let mut node = json!({"name": name, "mesh": self.meshes.len()});
        if surface.origin() != [0.0; 3] {
            node["translation"] = json!(surface.origin());
        }
        self.meshes
            .push(json!({"name": name, "primitives": primitives}));
        self.nodes.push(node);
        self.animate(animated);
        Ok(())
    }

    /// Adds a channel as the attribute that readers expect, or notes that it is dropped.
    fn add_channel(&mut self, channel: &Channel, sets: &mut usize, attributes: &mut Value) {
        let (name, width) = (channel.name(), channel.width());
        if channel.blend() == Blend::Skin {
            match skin(channel).filter(|_| name == "skin") {
                Some((joints, weights)) => {
                    let count = joints.len() / 4;
                    let bytes = joints
                        .iter()
                        .flat_map(|joint| joint.to_le_bytes())
                        .collect();
                    attributes["JOINTS_0"] = self.accessor(U16, "VEC4", count, bytes, VERTICES);
                    attributes["WEIGHTS_0"] = self.floats(4, &weights);
                }
                None => self.dropped.push(name.to_owned()),
            }
            return;
        }
        let is_next_set = name == format!("uv{sets}") && width == 2;
        let attribute = if is_next_set {
            *sets += 1;
            format!("TEXCOORD_{}", *sets - 1)
        } else if name == "color" && (width == 3 || width == 4) {
            "COLOR_0".to_owned()
        } else if (1..=4).contains(&width) && !name.is_empty() {
            format!("_{name}")
        } else {
            self.dropped.push(name.to_owned());
            return;
        };
        attributes[attribute] = self.floats(width, channel.values());
    }

    /// Adds rows of numbers and returns the accessor.
    fn floats(&mut self, width: usize, values: &[f32]) -> Value {
        let shape = ["SCALAR", "VEC2", "VEC3", "VEC4"][width - 1];
        let bytes = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.accessor(F32, shape, values.len() / width, bytes, VERTICES)
    }

    /// Adds positions with their bounds, which glTF requires, and returns the accessor.
    fn vectors(&mut self, values: &[[f32; 3]]) -> Value {
        let accessor = self.floats(3, values.as_flattened());
        let bounds = [f32::min, f32::max].map(|pick| {
            let values = values.iter().copied();
            values.reduce(|a, b| [0, 1, 2].map(|k| pick(a[k], b[k])))
        });
        self.set_bounds(bounds.map(|corner| json!(corner)));
        accessor
    }

    /// Sets minimum and maximum of the last accessor.
    fn set_bounds(&mut self, [min, max]: [Value; 2]) {
        if let Some(accessor) = self.accessors.last_mut() {
            accessor["min"] = min;
            accessor["max"] = max;
        }
    }

    /// Adds an accessor with a buffer view of its own, and returns its number.
    fn accessor(
        &mut self,
        kind: u32,
        shape: &str,
        count: usize,
        bytes: Vec<u8>,
        target: u32,
    ) -> Value {
        self.views.push(json!({
            "buffer": 0,
            "byteOffset": self.binary.len(),
            "byteLength": bytes.len(),
            "target": target,
        }));
        self.binary.extend(bytes);
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        self.accessors.push(json!({
            "bufferView": self.views.len() - 1,
            "componentType": kind,
            "count": count,
            "type": shape,
        }));
        json!(self.accessors.len() - 1)
    }
}

/// Returns four joints and four weights per row; none if a joint has no number of 16 bits.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a joint that does not fit is refused by the comparison"
)]
fn skin(channel: &Channel) -> Option<(Vec<u16>, Vec<f32>)> {
    let (mut joints, mut weights) = (Vec::new(), Vec::new());
    for row in channel.values().chunks_exact(channel.width()) {
        let (numbers, shares) = row.split_at(channel.width() / 2);
        let missing = 4 - numbers.len();
        for &number in numbers {
            let joint = number as u16;
            if f32::from(joint) != number {
                return None;
            }
            joints.push(joint);
        }
        joints.extend(std::iter::repeat_n(0, missing));
        weights.extend(shares);
        weights.extend(std::iter::repeat_n(0.0, missing));
    }
    Some((joints, weights))
}

#[cfg(test)]
mod tests {
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
}
