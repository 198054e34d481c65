//! Uniform structs with the layout of `shaders/view.wgsl` and `shaders/surface.wgsl`.

use super::view::{Background, View};
use bytemuck::{Pod, Zeroable};
use incise_mesh::Vec3;
use incise_mesh::geometry::{round_to_f32, to_f32, to_f64};

/// Uniforms of an image.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct ViewUniform {
    /// Matrix from points relative to `origin` to clip space, by columns.
    pub(super) clip: [[f32; 4]; 4],
    pub(super) origin: [f32; 4],
    /// Direction toward each light and its strength.
    pub(super) key: [f32; 4],
    pub(super) fill: [f32; 4],
    pub(super) sky: [f32; 4],
    pub(super) top: [f32; 4],
    pub(super) bottom: [f32; 4],
    pub(super) wire: [f32; 4],
    /// Width and height \[px\].
    pub(super) viewport: [f32; 2],
    pub(super) wire_width: f32,
    /// 1 if shaders encode their output as sRGB.
    pub(super) encode: u32,
}

/// Uniforms of a body.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct BodyUniform {
    /// Linear color of back faces and its weight.
    pub(super) back_face: [f32; 4],
    /// Index of vertex 0 in the bound positions.
    pub(super) first_vertex: u32,
    /// Squares of a checkerboard per unit of texture coordinates; 0 for plain colors.
    pub(super) checkers: f32,
    pub(super) pad: [u32; 2],
}

impl ViewUniform {
    /// Computes the uniforms of an image of the given size \[px\].
    ///
    /// `encode` is true for textures that store sRGB values without conversion.
    pub(super) fn new(view: &View, [width, height]: [u32; 2], encode: bool) -> Self {
        let camera = &view.camera;
        let [right, up, back] = camera.axes();
        let from_camera = |[x, y, z]: [f64; 3]| (right * x + up * y + back * z).normalize();
        let light = |direction: Vec3, strength: f32| {
            // A zero direction turns the light off.
            let [x, y, z] = to_f32(direction);
            let is_light = [x, y, z].iter().all(|x| x.is_finite());
            if is_light {
                [x, y, z, strength]
            } else {
                [0.0; 4]
            }
        };
        let [x, y, z] = view.light.direction;
        let target = to_f32(camera.target.into());
        // The camera uses the 64-bit target; points are relative to the target rounded to 32 bits.
        let off = to_f64(target) - Vec3::from(camera.target);
        let aspect = f64::from(width) / f64::from(height);
        let clip = camera.projection_from_target(aspect) * nalgebra::Matrix4::new_translation(&off);
        let (top, bottom) = match view.background {
            Background::Plain(color) => (color, color),
            Background::Gradient { top, bottom } => (top, bottom),
        };
        let wire = view.wireframe.map_or([0.0; 4], |w| w.color.linear());
        let [a, b, c] = target;
        Self {
            clip: clip.map(round_to_f32).into(),
            origin: [a, b, c, 0.0],
            key: light(from_camera([x, y, z]), view.light.key),
            fill: light(from_camera([-x, -0.35 * y, z]), view.light.fill),
            sky: light(Vec3::y(), view.light.ambient),
            top: top.linear(),
            bottom: bottom.linear(),
            wire,
            viewport: [
                round_to_f32(f64::from(width)),
                round_to_f32(f64::from(height)),
            ],
            wire_width: view.wireframe.map_or(0.0, |w| w.width),
            encode: u32::from(encode),
        }
    }
}
