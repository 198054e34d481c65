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
mod tests;
