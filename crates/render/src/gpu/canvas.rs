//! What is drawn on before it is a picture.

use super::pipelines::DEPTH;
use super::renderer::Renderer;
use super::scope::scoped;
use crate::error::RenderError;
use crate::picture::check_size;
use wgpu::{TextureUsages, TextureView};

/// Depths and, where pixels have several, the samples of one size of picture. A window makes another one when its size
/// changes.
#[derive(Debug)]
pub struct Canvas {
    pub(super) depth: TextureView,
    /// None where a pixel has one sample and is drawn in its place.
    pub(super) samples: Option<TextureView>,
    pub(super) size: [u32; 2],
    pub(super) kind: (wgpu::TextureFormat, u32),
}

impl Canvas {
    /// A canvas of so many pixels.
    ///
    /// # Errors
    /// [`RenderError::Size`], and what the device says.
    pub fn new(renderer: &Renderer, width: u32, height: u32) -> Result<Self, RenderError> {
        let (device, samples) = (renderer.device(), renderer.samples());
        check_size(width, height, device.limits().max_texture_dimension_2d)?;
        let view = |label, format| {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: extent(width, height),
                mip_level_count: 1,
                sample_count: samples,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            });
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        scoped(device, "a canvas", || Self {
            depth: view("depth", DEPTH),
            samples: (samples > 1).then(|| view("samples", renderer.format())),
            size: [width, height],
            kind: (renderer.format(), samples),
        })
    }

    /// Pixels across and along.
    #[must_use]
    pub const fn size(&self) -> [u32; 2] {
        self.size
    }
}

/// The size of a texture.
pub(super) const fn extent(width: u32, height: u32) -> wgpu::Extent3d {
    wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    }
}
