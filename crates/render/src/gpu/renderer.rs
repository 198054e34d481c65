//! Encodes the render pass of an image: background, bodies, overlays.

use super::attachments::{Attachments, extent};
use super::body::BodyView;
use super::error_scope::{create_buffer, scoped};
use super::overlay::Overlay;
use super::pipelines::{DEPTH, Pipelines};
use super::shaders::STORAGE_BUFFERS;
use super::uniforms::ViewUniform;
use super::view::View;
use crate::error::RenderError;
use wgpu::{
    BindGroup, BufferUsages, CommandEncoder, Device, LoadOp, Operations, Queue, StoreOp,
    TextureFormat, TextureUsages, TextureView,
};

/// Texture format of offscreen images.
pub(super) const OFFSCREEN: TextureFormat = TextureFormat::Rgba8UnormSrgb;

/// Samples per pixel on devices with multisampling, which all support four.
const SAMPLES: u32 = 4;

/// Render pipelines of a device for one texture format and sample count.
///
/// All renderers of a device can draw the same bodies and overlays.
#[derive(Debug)]
pub struct Renderer {
    device: Device,
    queue: Queue,
    pub(super) pipelines: Pipelines,
    format: TextureFormat,
    samples: u32,
}

/// The contents of an image.
#[derive(Debug, Clone, Copy, Default)]
pub struct DrawList<'a> {
    /// Opaque bodies, in any order.
    pub bodies: &'a [&'a BodyView],
    /// Overlays, blended over the bodies in this order.
    pub overlays: &'a [&'a Overlay],
}

impl Renderer {
    /// Creates a renderer for textures of `format` with `samples` per pixel.
    ///
    /// For formats that are not sRGB, the shaders encode colors, and translucent colors are blended
    /// in sRGB instead of linear light.
    ///
    /// # Errors
    /// [`RenderError::LimitTooSmall`] and [`RenderError::NoVertexStorage`] on insufficient devices;
    /// [`RenderError::UnsupportedFormat`] if the device cannot render to the format or with the
    /// sample count; an error of the device.
    pub fn new(
        device: &Device,
        queue: &Queue,
        format: TextureFormat,
        samples: u32,
    ) -> Result<Self, RenderError> {
        let have = device.limits().max_storage_buffers_per_shader_stage;
        if have < STORAGE_BUFFERS {
            return Err(RenderError::LimitTooSmall {
                name: "max_storage_buffers_per_shader_stage",
                need: u64::from(STORAGE_BUFFERS),
                have: u64::from(have),
            });
        }
        if !is_supported(device, format, samples) {
            return Err(RenderError::UnsupportedFormat {
                format: format!("{format:?}"),
                samples,
            });
        }
        Ok(Self {
            pipelines: Pipelines::new(device, format, samples)?,
            device: device.clone(),
            queue: queue.clone(),
            format,
            samples,
        })
    }

    /// Creates a renderer for [`Offscreen`](super::Offscreen) images, multisampled if supported.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn offscreen(device: &Device, queue: &Queue) -> Result<Self, RenderError> {
        let samples = Self::supported_samples(device, OFFSCREEN);
        Self::new(device, queue, OFFSCREEN, samples)
    }

    /// Returns 4 if the device supports four samples per pixel in this format, else 1.
    #[must_use]
    pub fn supported_samples(device: &Device, format: TextureFormat) -> u32 {
        if is_supported(device, format, SAMPLES) {
            SAMPLES
        } else {
            1
        }
    }

    /// Returns the wgpu device.
    #[must_use]
    pub const fn device(&self) -> &Device {
        &self.device
    }

    /// Returns the queue of the device.
    #[must_use]
    pub const fn queue(&self) -> &Queue {
        &self.queue
    }

    /// Returns the format of the output textures.
    #[must_use]
    pub const fn format(&self) -> TextureFormat {
        self.format
    }

    /// Returns the samples per pixel.
    #[must_use]
    pub const fn samples(&self) -> u32 {
        self.samples
    }

    /// Encodes the render pass of an image, which overwrites `output`.
    ///
    /// `output` has the size of the attachments and the format of the renderer. One encoder may
    /// take any number of images; each shows bodies and overlays as of its submission.
    ///
    /// # Errors
    /// [`RenderError::AttachmentMismatch`] for attachments of another format or sample count;
    /// [`RenderError::TooFewPositions`] for a body whose positions were not updated after its
    /// topology; an error of the device.
    pub fn encode(
        &self,
        encoder: &mut CommandEncoder,
        attachments: &Attachments,
        output: &TextureView,
        view: &View,
        draw_list: &DrawList<'_>,
    ) -> Result<(), RenderError> {
        if attachments.format != (self.format, self.samples) {
            return Err(RenderError::AttachmentMismatch);
        }
        for body in draw_list.bodies {
            body.check()?;
        }
        let view = self.view_bind_group(view, attachments.size)?;
        scoped(&self.device, "encoding an image", || {
            let (target, resolve, store) = match &attachments.multisampled {
                Some(samples) => (samples, Some(output), StoreOp::Discard),
                None => (output, None, StoreOp::Store),
            };
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("image"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: target,
                    depth_slice: None,
                    resolve_target: resolve,
                    ops: Operations {
                        load: LoadOp::Clear(wgpu::Color::BLACK),
                        store,
                    },
                })],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &attachments.depth,
                    depth_ops: Some(Operations {
                        load: LoadOp::Clear(0.0),
                        store: StoreOp::Discard,
                    }),
                    stencil_ops: None,
                }),
                timestamp_writes: None,
                occlusion_query_set: None,
                multiview_mask: None,
            });
            pass.set_bind_group(0, &view, &[]);
            pass.set_pipeline(&self.pipelines.background);
            pass.draw(0..3, 0..1);
            pass.set_pipeline(&self.pipelines.surface);
            for body in draw_list.bodies {
                body.draw(&mut pass);
            }
            for overlay in draw_list.overlays {
                overlay.draw(&mut pass, &self.pipelines);
            }
        })
    }

    /// Creates the uniform buffer of a view and its bind group.
    ///
    /// Every image has its own, since images of one submission may have different views.
    fn view_bind_group(&self, view: &View, size: [u32; 2]) -> Result<BindGroup, RenderError> {
        let uniform = ViewUniform::new(view, size, !self.format.is_srgb());
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let bytes = bytemuck::bytes_of(&uniform);
        let buffer = create_buffer(&self.device, "view", bytes.len() as u64, usage)?;
        scoped(&self.device, "binding a view", || {
            self.queue.write_buffer(&buffer, 0, bytes);
            self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("view"),
                layout: &self.pipelines.view_layout,
                entries: &[wgpu::BindGroupEntry {
                    binding: 0,
                    resource: buffer.as_entire_binding(),
                }],
            })
        })
    }
}

/// Returns true if the device renders to this format and to depth with this sample count.
fn is_supported(device: &Device, format: TextureFormat, samples: u32) -> bool {
    let create = |format| {
        device.create_texture(&wgpu::TextureDescriptor {
            label: Some("format test"),
            size: extent(1, 1),
            mip_level_count: 1,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        })
    };
    scoped(device, "testing a format", || {
        [create(format), create(DEPTH)]
    })
    .is_ok()
}
