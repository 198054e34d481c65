//! Renderers, views and comparisons of rendered images.

use incise_mesh::{Surface, TriangleId};
use incise_pbd_gpu::Context;
use incise_pbd_gpu::wgpu::{self, Device, Queue};
use incise_render::{
    Attachments, Background, BodyView, Camera, Color, DrawList, Image, Light, Offscreen, Renderer,
    View,
};
use std::cell::OnceCell;

pub(crate) const WHITE: Color = Color::rgb(255, 255, 255);
pub(crate) const RED: Color = Color::rgb(220, 30, 20);
pub(crate) const BLUE: Color = Color::rgb(20, 40, 220);

/// A device and its renderers, whose pipelines are compiled once.
pub(crate) struct Gpu {
    pub(crate) device: Device,
    pub(crate) queue: Queue,
    plain: OnceCell<Renderer>,
    smooth: OnceCell<Renderer>,
}

impl Gpu {
    pub(crate) fn new(context: &Context) -> Self {
        Self {
            device: context.device().clone(),
            queue: context.queue().clone(),
            plain: OnceCell::new(),
            smooth: OnceCell::new(),
        }
    }

    /// Returns a renderer with one sample per pixel, at its center.
    pub(crate) fn plain(&self) -> &Renderer {
        self.plain.get_or_init(|| {
            let format = wgpu::TextureFormat::Rgba8UnormSrgb;
            Renderer::new(&self.device, &self.queue, format, 1).expect("one sample is everywhere")
        })
    }

    /// Returns a multisampling renderer.
    pub(crate) fn smooth(&self) -> &Renderer {
        self.smooth.get_or_init(|| {
            Renderer::offscreen(&self.device, &self.queue).expect("images can be drawn")
        })
    }
}

/// A test of images.
pub(crate) type Test = fn(&Gpu);

/// Returns a view with light from the camera only: front-facing triangles have their own color.
pub(crate) fn facing(camera: Camera) -> View {
    View {
        background: Background::Plain(WHITE),
        light: Light {
            direction: [0.0, 0.0, 1.0],
            key: 1.0,
            fill: 0.0,
            ambient: 0.0,
        },
        ..View::from_camera(camera)
    }
}

/// Returns a surface of disconnected triangles.
pub(crate) fn triangles(corners: &[[[f32; 3]; 3]]) -> Surface {
    let count = u32::try_from(corners.len()).expect("a few");
    let faces: Vec<[u32; 3]> = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Surface::from_triangles(corners.as_flattened(), &faces).expect("no two of them touch")
}

/// Renders one body.
pub(crate) fn image(
    renderer: &Renderer,
    size: [u32; 2],
    view: &View,
    surface: &Surface,
    colors: impl FnMut(TriangleId) -> Option<Color>,
) -> Image {
    let body = BodyView::from_surface(renderer, surface, colors).expect("a body");
    draw(renderer, size, view, &[&body])
}

/// Renders several bodies.
pub(crate) fn draw(
    renderer: &Renderer,
    [width, height]: [u32; 2],
    view: &View,
    bodies: &[&BodyView],
) -> Image {
    let content = DrawList {
        bodies,
        overlays: &[],
    };
    let offscreen = Offscreen::new(renderer, width, height).expect("a size");
    let drawn = offscreen.render(renderer, view, &content);
    drawn.expect("an image")
}

/// Returns the number of pixels that differ from `color`.
pub(crate) fn count_other(image: &Image, color: Color) -> usize {
    let pixels = image.pixels().as_chunks::<4>().0.iter();
    pixels.filter(|&&pixel| pixel != color.0).count()
}

/// Renders in any format of four bytes per pixel and returns the bytes.
///
/// The width must be a multiple of 64 pixels.
pub(crate) fn draw_raw(
    gpu: &Gpu,
    renderer: &Renderer,
    [width, height]: [u32; 2],
    view: &View,
    bodies: &[&BodyView],
) -> Vec<u8> {
    let size = wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    };
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: renderer.format(),
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let readback = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(4 * width * height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let attachments = Attachments::new(renderer, width, height).expect("a size");
    let output = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let content = DrawList {
        bodies,
        overlays: &[],
    };
    let mut encoder = gpu
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let encoded = renderer.encode(&mut encoder, &attachments, &output, view, &content);
    encoded.expect("an image");
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(4 * width),
        rows_per_image: None,
    };
    let target = wgpu::TexelCopyBufferInfo {
        buffer: &readback,
        layout,
    };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), target, size);
    gpu.queue.submit([encoder.finish()]);
    readback
        .slice(..)
        .map_async(wgpu::MapMode::Read, |mapped| mapped.expect("bytes"));
    gpu.device
        .poll(wgpu::PollType::wait_indefinitely())
        .expect("the device works");
    let bytes = readback.slice(..).get_mapped_range().expect("bytes");
    bytes.to_vec()
}
