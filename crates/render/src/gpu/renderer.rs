//! Draws what there is on a canvas.

use super::body::BodyView;
use super::canvas::{Canvas, extent};
use super::overlay::Overlay;
use super::pipelines::{DEPTH, Pipelines};
use super::scope::{buffer, scoped};
use super::shaders::STORAGE_BUFFERS;
use super::uniforms::ViewUniform;
use super::view::View;
use crate::error::RenderError;
use wgpu::{
    BindGroup, BufferUsages, CommandEncoder, Device, LoadOp, Operations, Queue, StoreOp,
    TextureFormat, TextureUsages, TextureView,
};

/// What pictures for the host are drawn in.
pub(super) const OFFSCREEN: TextureFormat = TextureFormat::Rgba8UnormSrgb;

/// Samples of a pixel where a device has more than one: every device that has any has four.
const SAMPLES: u32 = 4;

/// The pipelines of a device for one format of texture and number of samples. Bodies and overlays of one renderer can be
/// drawn by any other on the same device.
#[derive(Debug)]
pub struct Renderer {
    device: Device,
    queue: Queue,
    pub(super) pipelines: Pipelines,
    format: TextureFormat,
    samples: u32,
}

/// What is in a picture.
#[derive(Debug, Clone, Copy, Default)]
pub struct Content<'a> {
    /// Opaque bodies, in any order.
    pub bodies: &'a [&'a BodyView],
    /// What lies over them, drawn one after the other.
    pub overlays: &'a [&'a Overlay],
}

impl Renderer {
    /// A renderer for textures of `format` with so many samples a pixel. In a format that is not sRGB colors are
    /// converted by the shaders, and translucent ones are mixed as they are shown instead of as light.
    ///
    /// # Errors
    /// [`RenderError::LimitTooSmall`] and [`RenderError::VertexStorage`] on devices that cannot do it,
    /// [`RenderError::Format`] if the format or the number of samples cannot be drawn in, and what the device says.
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
        if !has(device, format, samples) {
            return Err(RenderError::Format {
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

    /// A renderer for [`Offscreen`](super::Offscreen) pictures, with as many samples as the device has.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn offscreen(device: &Device, queue: &Queue) -> Result<Self, RenderError> {
        let samples = Self::supported_samples(device, OFFSCREEN);
        Self::new(device, queue, OFFSCREEN, samples)
    }

    /// Four samples a pixel where the device can draw them in this format, else one.
    #[must_use]
    pub fn supported_samples(device: &Device, format: TextureFormat) -> u32 {
        if has(device, format, SAMPLES) {
            SAMPLES
        } else {
            1
        }
    }

    /// The device.
    #[must_use]
    pub const fn device(&self) -> &Device {
        &self.device
    }

    /// Its queue.
    #[must_use]
    pub const fn queue(&self) -> &Queue {
        &self.queue
    }

    /// The format of the textures that are drawn in.
    #[must_use]
    pub const fn format(&self) -> TextureFormat {
        self.format
    }

    /// Samples of a pixel.
    #[must_use]
    pub const fn samples(&self) -> u32 {
        self.samples
    }

    /// Draws a picture in `output`, a texture of the canvas's size and this renderer's format, in the place of what was
    /// there. Any number of pictures may go into one encoder; each is drawn as bodies and overlays are on the queue when
    /// it is submitted.
    ///
    /// # Errors
    /// [`RenderError::ForeignCanvas`] for a canvas of another format or number of samples,
    /// [`RenderError::TooFewPositions`] for a body whose positions were not updated after its topology, and what the
    /// device says.
    pub fn encode(
        &self,
        encoder: &mut CommandEncoder,
        canvas: &Canvas,
        output: &TextureView,
        view: &View,
        content: &Content<'_>,
    ) -> Result<(), RenderError> {
        if canvas.kind != (self.format, self.samples) {
            return Err(RenderError::ForeignCanvas);
        }
        for body in content.bodies {
            body.check()?;
        }
        let view = self.view_group(view, canvas.size)?;
        scoped(&self.device, "drawing a picture", || {
            let (target, resolve, store) = match &canvas.samples {
                Some(samples) => (samples, Some(output), StoreOp::Discard),
                None => (output, None, StoreOp::Store),
            };
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("picture"),
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
                    view: &canvas.depth,
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
            for body in content.bodies {
                body.draw(&mut pass);
            }
            for overlay in content.overlays {
                overlay.draw(&mut pass, &self.pipelines);
            }
        })
    }

    /// A view's uniform in a buffer of its own: another picture of the same submission may have another view.
    fn view_group(&self, view: &View, size: [u32; 2]) -> Result<BindGroup, RenderError> {
        let uniform = ViewUniform::new(view, size, !self.format.is_srgb());
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let bytes = bytemuck::bytes_of(&uniform);
        let made = buffer(&self.device, "view", bytes.len() as u64, usage)?;
        scoped(&self.device, "a view", || {
            self.queue.write_buffer(&made, 0, bytes);
            self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("view"),
                layout: &self.pipelines.view_layout,
                entries: &[wgpu::BindGroupEntry {
                    binding: 0,
                    resource: made.as_entire_binding(),
                }],
            })
        })
    }
}

/// Whether the device draws in textures of this format with so many samples, and has depths to go with them.
fn has(device: &Device, format: TextureFormat, samples: u32) -> bool {
    let make = |format| {
        device.create_texture(&wgpu::TextureDescriptor {
            label: Some("a try"),
            size: extent(1, 1),
            mip_level_count: 1,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        })
    };
    scoped(device, "a try", || [make(format), make(DEPTH)]).is_ok()
}
