//! Offscreen rendering: a render target that is read back to an image.

use super::attachments::{Attachments, extent};
use super::error_scope::{WAIT, create_buffer, scoped, wait};
use super::renderer::{DrawList, OFFSCREEN, Renderer};
use super::view::View;
use crate::error::RenderError;
use crate::image::Image;
use std::sync::mpsc::{RecvTimeoutError, channel};
use wgpu::{Buffer, BufferUsages, MapMode, Texture, TextureUsages, TextureView};

/// A render target of one size with a readback buffer, reusable for any number of images.
#[derive(Debug)]
pub struct Offscreen {
    attachments: Attachments,
    texture: Texture,
    view: TextureView,
    readback: Buffer,
    /// Row pitch in the readback buffer \[bytes\].
    stride: u32,
}

impl Offscreen {
    /// Creates a target of `width` by `height` pixels for a [`Renderer::offscreen`] renderer.
    ///
    /// # Errors
    /// [`RenderError::InvalidSize`] for sizes that textures of the device cannot have;
    /// [`RenderError::UnsupportedFormat`] for a renderer of another format; an error of the device.
    pub fn new(renderer: &Renderer, width: u32, height: u32) -> Result<Self, RenderError> {
        if renderer.format() != OFFSCREEN {
            return Err(RenderError::UnsupportedFormat {
                format: format!("{:?} for offscreen images", renderer.format()),
                samples: renderer.samples(),
            });
        }
        let attachments = Attachments::new(renderer, width, height)?;
        let stride = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let device = renderer.device();
        let bytes = u64::from(stride) * u64::from(height);
        let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let readback = create_buffer(device, "image readback", bytes, usage)?;
        let texture = scoped(device, "creating a render target", || {
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
            attachments,
            texture,
            readback,
            stride,
        })
    }

    /// Renders an image and blocks until its pixels are read back.
    ///
    /// # Errors
    /// As [`Renderer::encode`], [`RenderError::Timeout`] and [`RenderError::DeviceLost`].
    pub fn render(
        &self,
        renderer: &Renderer,
        view: &View,
        draw_list: &DrawList<'_>,
    ) -> Result<Image, RenderError> {
        let (device, queue) = (renderer.device(), renderer.queue());
        let [width, height] = self.attachments.size();
        let label = Some("offscreen");
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
        renderer.encode(&mut encoder, &self.attachments, &self.view, view, draw_list)?;
        let submission = scoped(device, "rendering an image", || {
            encoder.copy_texture_to_buffer(
                self.texture.as_image_copy(),
                wgpu::TexelCopyBufferInfo {
                    buffer: &self.readback,
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
        let (sender, receiver) = channel();
        self.readback
            .slice(..)
            .map_async(MapMode::Read, move |mapped| {
                // The receiver is gone after a timeout.
                let _ = sender.send(mapped);
            });
        wait(device, submission)?;
        let lost = |reason: String| RenderError::DeviceLost { reason };
        // The callback may run on another thread that waits for the device.
        match receiver.recv_timeout(WAIT) {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(lost(error.to_string())),
            Err(RecvTimeoutError::Timeout) => {
                return Err(RenderError::Timeout {
                    seconds: WAIT.as_secs(),
                });
            }
            Err(error) => return Err(lost(format!("the image was not read back: {error}"))),
        }
        let image = self.mapped_image(width, height);
        self.readback.unmap();
        image
    }

    /// Copies the mapped rows to an image, without the row padding.
    fn mapped_image(&self, width: u32, height: u32) -> Result<Image, RenderError> {
        let bytes = self.readback.slice(..).get_mapped_range();
        let bytes = bytes.map_err(|error| RenderError::DeviceLost {
            reason: error.to_string(),
        })?;
        let mut pixels = Vec::new();
        let row = 4 * width as usize;
        pixels
            .try_reserve_exact(row * height as usize)
            .map_err(|_| RenderError::OutOfMemory { what: "an image" })?;
        for line in bytes
            .chunks_exact(self.stride as usize)
            .take(height as usize)
        {
            pixels.extend_from_slice(&line[..row]);
        }
        Image::from_pixels(width, height, pixels)
    }
}
