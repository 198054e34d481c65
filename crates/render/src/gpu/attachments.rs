//! The depth and multisampled color attachments of a render target.

use super::error_scope::scoped;
use super::pipelines::DEPTH;
use super::renderer::Renderer;
use crate::error::RenderError;
use crate::image::check_size;
use wgpu::{TextureUsages, TextureView};

/// Depth and multisampled color textures for images of one size.
///
/// A window creates new ones when its size changes.
#[derive(Debug)]
pub struct Attachments {
    pub(super) depth: TextureView,
    /// Multisampled color; `None` with one sample per pixel, which is rendered directly.
    pub(super) multisampled: Option<TextureView>,
    pub(super) size: [u32; 2],
    /// Format and samples per pixel of the renderer.
    pub(super) format: (wgpu::TextureFormat, u32),
}

impl Attachments {
    /// Creates the attachments for images of `width` by `height` pixels.
    ///
    /// # Errors
    /// [`RenderError::InvalidSize`], or an error of the device.
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
        scoped(device, "creating attachments", || Self {
            depth: view("depth", DEPTH),
            multisampled: (samples > 1).then(|| view("multisampled color", renderer.format())),
            size: [width, height],
            format: (renderer.format(), samples),
        })
    }

    /// Returns width and height \[px\].
    #[must_use]
    pub const fn size(&self) -> [u32; 2] {
        self.size
    }
}

/// Returns the extent of a 2D texture.
pub(super) const fn extent(width: u32, height: u32) -> wgpu::Extent3d {
    wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    }
}
