//! What shaders are told, as they are told it: `shaders/view.wgsl` and `shaders/surface.wgsl` have the same structs.

use super::view::{Background, View};
use bytemuck::{Pod, Zeroable};
use incise_mesh::Vec3;
use incise_mesh::geometry::{round, widen};

/// A picture's look.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct ViewUniform {
    /// From points relative to `origin` to clip space, a column a row.
    pub(super) clip: [[f32; 4]; 4],
    pub(super) origin: [f32; 4],
    /// Toward the lights, and their strength.
    pub(super) key: [f32; 4],
    pub(super) fill: [f32; 4],
    pub(super) sky: [f32; 4],
    pub(super) top: [f32; 4],
    pub(super) bottom: [f32; 4],
    pub(super) wire: [f32; 4],
    /// Width and height \[px\].
    pub(super) viewport: [f32; 2],
    pub(super) wire_width: f32,
    pub(super) encode: u32,
}

/// A body's.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct BodyUniform {
    pub(super) inside: [f32; 4],
    pub(super) first_vertex: u32,
    pub(super) pad: [u32; 3],
}

impl ViewUniform {
    /// Of a picture of so many pixels. `encode` says whether the texture takes numbers as they are shown.
    pub(super) fn new(view: &View, [width, height]: [u32; 2], encode: bool) -> Self {
        let camera = &view.camera;
        let [right, up, back] = camera.axes();
        let from_camera = |[x, y, z]: [f64; 3]| (right * x + up * y + back * z).normalize();
        let light = |direction: Vec3, strength: f32| {
            // A light from nowhere is none.
            let [x, y, z] = round(direction);
            let is_light = [x, y, z].iter().all(|x| x.is_finite());
            if is_light {
                [x, y, z, strength]
            } else {
                [0.0; 4]
            }
        };
        let [x, y, z] = view.light.direction;
        let target = round(camera.target.into());
        // The eye looks at the target itself, points are relative to what is left of it in 32 bits.
        let off = widen(target) - Vec3::from(camera.target);
        let aspect = f64::from(width) / f64::from(height);
        let clip = camera.projection_from_target(aspect) * nalgebra::Matrix4::new_translation(&off);
        let (top, bottom) = match view.background {
            Background::Plain(color) => (color, color),
            Background::Gradient { top, bottom } => (top, bottom),
        };
        let wire = view.wireframe.map_or([0.0; 4], |w| w.color.linear());
        let [a, b, c] = target;
        Self {
            clip: clip.map(narrow).into(),
            origin: [a, b, c, 0.0],
            key: light(from_camera([x, y, z]), view.light.key),
            fill: light(from_camera([-x, -0.35 * y, z]), view.light.fill),
            sky: light(Vec3::y(), view.light.ambient),
            top: top.linear(),
            bottom: bottom.linear(),
            wire,
            viewport: [narrow(f64::from(width)), narrow(f64::from(height))],
            wire_width: view.wireframe.map_or(0.0, |w| w.width),
            encode: u32::from(encode),
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "the device works with 32 bits"
)]
fn narrow(x: f64) -> f32 {
    x as f32
}
