//! Pictures that nobody looks at while they are drawn.

use super::canvas::{Canvas, extent};
use super::renderer::{Content, OFFSCREEN, Renderer};
use super::scope::{buffer, scoped, wait};
use super::view::View;
use crate::error::RenderError;
use crate::picture::Picture;
use wgpu::{Buffer, BufferUsages, MapMode, Texture, TextureUsages, TextureView};

/// A texture of one size, and the way to the host. It can be drawn on again and again.
#[derive(Debug)]
pub struct Offscreen {
    canvas: Canvas,
    texture: Texture,
    view: TextureView,
    arrived: Buffer,
    /// From one row to the next on its way \[bytes\].
    stride: u32,
}

impl Offscreen {
    /// Pictures of so many pixels, by a renderer that [`Renderer::offscreen`] made.
    ///
    /// # Errors
    /// [`RenderError::Size`] for no pixels or more than the device's textures have, [`RenderError::Format`] for a
    /// renderer that draws something else, and what the device says.
    pub fn new(renderer: &Renderer, width: u32, height: u32) -> Result<Self, RenderError> {
        if renderer.format() != OFFSCREEN {
            return Err(RenderError::Format {
                format: format!("{:?} pictures for the host", renderer.format()),
                samples: renderer.samples(),
            });
        }
        let canvas = Canvas::new(renderer, width, height)?;
        let stride = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let device = renderer.device();
        let bytes = u64::from(stride) * u64::from(height);
        let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let arrived = buffer(device, "a picture on its way", bytes, usage)?;
        let texture = scoped(device, "a picture's texture", || {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("offscreen"),
                size: extent(width, height),
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: OFFSCREEN,
                usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC,
                view_formats: &[],
            })
        })?;
        Ok(Self {
            view: texture.create_view(&wgpu::TextureViewDescriptor::default()),
            canvas,
            texture,
            arrived,
            stride,
        })
    }

    /// Draws a picture and waits for it.
    ///
    /// # Errors
    /// As [`Renderer::encode`], [`RenderError::Timeout`] and [`RenderError::DeviceLost`].
    pub fn picture(
        &self,
        renderer: &Renderer,
        view: &View,
        content: &Content<'_>,
    ) -> Result<Picture, RenderError> {
        let (device, queue) = (renderer.device(), renderer.queue());
        let [width, height] = self.canvas.size();
        let label = Some("offscreen");
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
        renderer.encode(&mut encoder, &self.canvas, &self.view, view, content)?;
        let submission = scoped(device, "drawing a picture", || {
            encoder.copy_texture_to_buffer(
                self.texture.as_image_copy(),
                wgpu::TexelCopyBufferInfo {
                    buffer: &self.arrived,
                    layout: wgpu::TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(self.stride),
                        rows_per_image: None,
                    },
                },
                extent(width, height),
            );
            queue.submit([encoder.finish()])
        })?;
        let (tell, told) = std::sync::mpsc::channel();
        self.arrived
            .slice(..)
            .map_async(MapMode::Read, move |mapped| {
                // Who waited may have given up.
                let _ = tell.send(mapped);
            });
        wait(device, submission)?;
        let lost = |reason: String| RenderError::DeviceLost { reason };
        match told.try_recv() {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(lost(error.to_string())),
            Err(error) => return Err(lost(format!("the picture did not come back: {error}"))),
        }
        let picture = self.copy(width, height);
        self.arrived.unmap();
        picture
    }

    /// The rows that have arrived, without what is between them.
    fn copy(&self, width: u32, height: u32) -> Result<Picture, RenderError> {
        let bytes = self.arrived.slice(..).get_mapped_range();
        let bytes = bytes.map_err(|error| RenderError::DeviceLost {
            reason: error.to_string(),
        })?;
        let mut pixels = Vec::new();
        let row = 4 * width as usize;
        pixels
            .try_reserve_exact(row * height as usize)
            .map_err(|_| RenderError::OutOfMemory { what: "a picture" })?;
        for line in bytes
            .chunks_exact(self.stride as usize)
            .take(height as usize)
        {
            pixels.extend_from_slice(&line[..row]);
        }
        Picture::from_pixels(width, height, pixels)
    }
}
