//! Animation: shapes over time as morph targets, and visibility as a scale of 0 or 1.

use super::{Document, F32};
use crate::render_buffers::RenderBuffers;
use crate::surface::Surface;
use serde_json::{Value, json};

/// A node of a file: a surface and its shapes over time.
#[derive(Debug, Clone)]
pub struct AnimatedSurface<'a> {
    /// Name of the node.
    pub name: &'a str,
    /// The surface in its first shape.
    pub surface: &'a Surface,
    /// Times of all shapes \[s\], ascending; the node is invisible before the first one. Empty for
    /// a surface at rest.
    pub times: Vec<f32>,
    /// Positions of the shapes after the first one \[m\], shape \[times - 1\]\[vertex slots\].
    /// Others are not written.
    pub positions: Vec<Vec<[f32; 4]>>,
    /// Time from which on the node is invisible \[s\]; `None` if it stays.
    pub end: Option<f32>,
}

impl<'a> AnimatedSurface<'a> {
    /// Creates the node of a surface at rest.
    #[must_use]
    pub fn still(name: &'a str, surface: &'a Surface) -> Self {
        Self {
            name,
            surface,
            times: Vec::new(),
            positions: Vec::new(),
            end: None,
        }
    }

    /// Returns the shapes that have a time and a position per vertex slot.
    fn shapes(&self) -> impl Iterator<Item = &Vec<[f32; 4]>> {
        let slots = self.surface.positions().len();
        let timed = self
            .positions
            .iter()
            .take(self.times.len().saturating_sub(1));
        timed.take_while(move |shape| shape.len() == slots)
    }
}

impl Document {
    /// Adds the differences of all shapes from the first one, and returns the morph targets.
    pub(super) fn add_targets(
        &mut self,
        animated: &AnimatedSurface<'_>,
        buffers: &mut RenderBuffers,
    ) -> Vec<Value> {
        let (positions, normals) = (buffers.positions().to_vec(), buffers.normals().to_vec());
        let mut moved = animated.surface.clone();
        let mut targets = Vec::new();
        for shape in animated.shapes() {
            moved.positions_mut().copy_from_slice(shape);
            buffers.refresh(&moved);
            let positions = differences(&positions, buffers.positions());
            let normals = differences(&normals, buffers.normals());
            targets.push(json!({
                "POSITION": self.vectors(&positions),
                "NORMAL": self.floats(3, normals.as_flattened()),
            }));
        }
        targets
    }

    /// Adds the channels of the last node: weights of its shapes, and its visibility.
    pub(super) fn animate(&mut self, animated: &AnimatedSurface<'_>) {
        let shapes = animated.shapes().count();
        if shapes > 0 {
            let weight = |time: usize, shape: usize| if time == shape + 1 { 1.0 } else { 0.0 };
            let rows = (0..=shapes).flat_map(|time| (0..shapes).map(move |s| weight(time, s)));
            let output = self.track("SCALAR", 1, &rows.collect::<Vec<f32>>());
            self.add_channel_of_node("weights", "LINEAR", &animated.times[..=shapes], output);
        }
        let start = animated.times.first().copied().filter(|&start| start > 0.0);
        let mut keys = vec![(0.0, if start.is_some() { 0.0 } else { 1.0 })];
        keys.extend(start.map(|time| (time, 1.0)));
        keys.extend(animated.end.map(|time| (time, 0.0)));
        if keys.len() > 1 {
            let times: Vec<f32> = keys.iter().map(|&(time, _)| time).collect();
            let scales: Vec<f32> = keys.iter().flat_map(|&(_, scale)| [scale; 3]).collect();
            let output = self.track("VEC3", 3, &scales);
            self.add_channel_of_node("scale", "STEP", &times, output);
        }
    }

    fn add_channel_of_node(&mut self, path: &str, kind: &str, times: &[f32], output: Value) {
        let input = self.track("SCALAR", 1, times);
        self.set_bounds([times.first(), times.last()].map(|time| json!([time])));
        let (sampler, node) = (self.samplers.len(), self.nodes.len() - 1);
        self.samplers
            .push(json!({"input": input, "output": output, "interpolation": kind}));
        self.channels
            .push(json!({"sampler": sampler, "target": {"node": node, "path": path}}));
    }

    /// Adds times or values of an animation and returns the accessor.
    fn track(&mut self, shape: &str, width: usize, values: &[f32]) -> Value {
        let bytes = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        let accessor = self.accessor(F32, shape, values.len() / width, bytes, super::VERTICES);
        // Views of vertices have a target, those of animations none.
        if let Some(view) = self.views.last_mut().and_then(Value::as_object_mut) {
            view.remove("target");
        }
        accessor
    }
}

/// Returns the vectors from the first rows to the others.
fn differences(from: &[[f32; 3]], to: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let rows = from.iter().zip(to);
    rows.map(|(a, b)| [0, 1, 2].map(|k| b[k] - a[k])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::read_gltf;
    use crate::shapes::cube_sphere;

    /// Returns the numbers of an accessor.
    fn numbers(json: &Value, binary: &[u8], accessor: &Value) -> Vec<f32> {
        let index = |value: &Value| usize::try_from(value.as_u64().unwrap()).unwrap();
        let view = &json["bufferViews"][index(&json["accessors"][index(accessor)]["bufferView"])];
        let begin = index(&view["byteOffset"]);
        let bytes = &binary[begin..begin + index(&view["byteLength"])];
        let words = bytes.as_chunks::<4>().0.iter();
        words.map(|&word| f32::from_le_bytes(word)).collect()
    }

    #[test]
    fn normals_follow_the_motion_even_if_the_surface_has_its_own() {
        let mut surface = crate::icosphere(1, 0.5);
        let corners = surface.corner_normals().len();
        surface
            .set_corner_normals(vec![[0.0, 0.0, 1.0]; corners])
            .unwrap();
        let turned = |&[x, y, z, w]: &[f32; 4]| [z, x, y, w];
        let node = AnimatedSurface {
            name: "piece",
            surface: &surface,
            times: vec![0.0, 1.0],
            positions: vec![surface.positions().iter().map(turned).collect()],
            end: None,
        };
        let mut file = Vec::new();
        super::super::write(&[node], &mut file).unwrap();
        let length = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
        let json: Value = serde_json::from_slice(&file[20..20 + length]).unwrap();
        let primitive = &json["meshes"][0]["primitives"][0];
        let vectors = |accessor: &Value| numbers(&json, &file[20 + length + 8..], accessor);
        let first = vectors(&primitive["attributes"]["NORMAL"]);
        let by = vectors(&primitive["targets"][0]["NORMAL"]);
        assert!(!first.is_empty());
        let rows = first.as_chunks::<3>().0.iter().zip(by.as_chunks::<3>().0);
        for (&[x, y, z], by) in rows {
            let expected = [z, x, y];
            for k in 0..3 {
                assert!(([x, y, z][k] + by[k] - expected[k]).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn targets_weights_and_visibility_are_read_back() {
        let surface = cube_sphere(2, 0.5);
        let moved = |by: f32| {
            let positions = surface.positions().iter();
            positions
                .map(|&[x, y, z, w]| [x + by, y, z, w])
                .collect::<Vec<_>>()
        };
        let node = AnimatedSurface {
            name: "piece",
            surface: &surface,
            times: vec![0.5, 1.0, 1.5],
            positions: vec![moved(0.25), moved(1.0)],
            end: Some(2.0),
        };
        let mut file = Vec::new();
        let nodes = [AnimatedSurface::still("rest", &surface), node];
        assert_eq!(super::super::write(&nodes, &mut file).unwrap(), []);
        let data = read_gltf(&file, None).unwrap();
        assert_eq!(
            data.triangles.len(),
            2 * surface.topology().triangle_count()
        );
        let length = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
        let json: Value = serde_json::from_slice(&file[20..20 + length]).unwrap();
        let binary = &file[20 + length + 8..];
        assert!(
            json["meshes"][0]["primitives"][0]["targets"].is_null(),
            "it is at rest"
        );
        let targets = json["meshes"][1]["primitives"][0]["targets"]
            .as_array()
            .unwrap();
        assert_eq!(targets.len(), 2);
        for (target, by) in targets.iter().zip([0.25, 1.0]) {
            let differences = numbers(&json, binary, &target["POSITION"]);
            for difference in differences.as_chunks::<3>().0 {
                assert!((difference[0] - by).abs() < 1e-6, "{difference:?}");
                assert_eq!(difference[1..], [0.0; 2]);
            }
            let normals = numbers(&json, binary, &target["NORMAL"]);
            assert!(
                normals.iter().all(|x| x.abs() < 1e-5),
                "a shift turns no normal"
            );
        }
        let animation = &json["animations"][0];
        let track = |channel: usize| {
            assert_eq!(animation["channels"][channel]["target"]["node"], 1);
            let sampler = &animation["samplers"][channel];
            let values = ["input", "output"].map(|key| numbers(&json, binary, &sampler[key]));
            (sampler["interpolation"].clone(), values)
        };
        let weights = vec![0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
        assert_eq!(track(0), ("LINEAR".into(), [vec![0.5, 1.0, 1.5], weights]));
        let scales = [[0.0; 3], [1.0; 3], [0.0; 3]].concat();
        assert_eq!(track(1), ("STEP".into(), [vec![0.0, 0.5, 2.0], scales]));
    }
}
