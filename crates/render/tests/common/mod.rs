//! Tests that need a device: each runs on every one of the machine, software too. Without any they show as ignored; with
//! `INCISE_REQUIRE_GPU` set they fail instead.
#![allow(dead_code, reason = "every test file uses a part of it")]

use incise_mesh::{Surface, TriangleId};
use incise_render::{
    Background, BodyView, Camera, Canvas, Color, Content, Light, Offscreen, Picture, Renderer, View,
};
use libtest_mimic::{Arguments, Completion, Trial};
use std::process::ExitCode;
use wgpu::{Device, Queue};

pub(crate) const WHITE: Color = Color::rgb(255, 255, 255);
pub(crate) const RED: Color = Color::rgb(220, 30, 20);
pub(crate) const BLUE: Color = Color::rgb(20, 40, 220);

/// An open device.
pub(crate) struct Gpu {
    pub(crate) device: Device,
    pub(crate) queue: Queue,
}

impl Gpu {
    /// Pictures of one sample a pixel: every pixel is what is at its middle.
    pub(crate) fn plain(&self) -> Renderer {
        let format = wgpu::TextureFormat::Rgba8UnormSrgb;
        Renderer::new(&self.device, &self.queue, format, 1).expect("one sample is everywhere")
    }

    /// Pictures with smooth edges.
    pub(crate) fn smooth(&self) -> Renderer {
        Renderer::offscreen(&self.device, &self.queue).expect("pictures can be drawn")
    }
}

/// A test by its name.
pub(crate) type Test = (&'static str, fn(&Gpu));

/// Runs the tests of a file, as its `main`.
pub(crate) fn run(tests: &[Test]) -> ExitCode {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    let mut trials = Vec::new();
    for &(name, test) in tests {
        for adapter in &adapters {
            let adapter = adapter.clone();
            let device = adapter.get_info().name.replace(' ', "_");
            trials.push(Trial::test(format!("{name}_on_{device}"), move || {
                let limits = wgpu::Limits::default().or_worse_values_from(&adapter.limits());
                let descriptor = wgpu::DeviceDescriptor {
                    required_limits: limits,
                    ..wgpu::DeviceDescriptor::default()
                };
                let opened = pollster::block_on(adapter.request_device(&descriptor));
                let (device, queue) = opened.map_err(|error| error.to_string())?;
                test(&Gpu { device, queue });
                Ok(())
            }));
        }
        if adapters.is_empty() {
            trials.push(Trial::ignorable_test(name, || {
                let absent = "there is no Vulkan, Metal or DX12 device; on Debian install mesa-vulkan-drivers and libvulkan1";
                let required = std::env::var("INCISE_REQUIRE_GPU").unwrap_or_default();
                if ["", "0"].contains(&required.as_str()) {
                    Ok(Completion::ignored_with(absent))
                } else {
                    Err(format!("INCISE_REQUIRE_GPU is set, and {absent}").into())
                }
            }));
        }
    }
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

/// Light from the eye alone: what faces it has its own color, and nothing is as bright as the background.
pub(crate) fn facing(camera: Camera) -> View {
    View {
        background: Background::Plain(WHITE),
        light: Light {
            direction: [0.0, 0.0, 1.0],
            key: 1.0,
            fill: 0.0,
            ambient: 0.0,
        },
        ..View::of(camera)
    }
}

/// A surface of these triangles, corners all apart.
pub(crate) fn triangles(corners: &[[[f32; 3]; 3]]) -> Surface {
    let count = u32::try_from(corners.len()).expect("a few");
    let faces: Vec<[u32; 3]> = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Surface::from_triangles(corners.as_flattened(), &faces).expect("no two of them touch")
}

/// A picture of one body.
pub(crate) fn picture(
    renderer: &Renderer,
    size: [u32; 2],
    view: &View,
    surface: &Surface,
    colors: impl FnMut(TriangleId) -> Option<Color>,
) -> Picture {
    let body = BodyView::of(renderer, surface, colors).expect("a body");
    draw(renderer, size, view, &[&body])
}

/// A picture of bodies.
pub(crate) fn draw(
    renderer: &Renderer,
    [width, height]: [u32; 2],
    view: &View,
    bodies: &[&BodyView],
) -> Picture {
    let content = Content {
        bodies,
        overlays: &[],
    };
    let offscreen = Offscreen::new(renderer, width, height).expect("a size");
    let drawn = offscreen.picture(renderer, view, &content);
    drawn.expect("a picture")
}

/// How many pixels have another color than `color`.
pub(crate) fn others(picture: &Picture, color: Color) -> usize {
    let pixels = picture.pixels().as_chunks::<4>().0.iter();
    pixels.filter(|&&pixel| pixel != color.0).count()
}

/// The bytes of a picture in any format of four bytes a pixel, as a window would get them; rows of 64 pixels or a
/// multiple.
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
    let arrived = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(4 * width * height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let canvas = Canvas::new(renderer, width, height).expect("a size");
    let output = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let content = Content {
        bodies,
        overlays: &[],
    };
    let mut encoder = gpu
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let encoded = renderer.encode(&mut encoder, &canvas, &output, view, &content);
    encoded.expect("a picture");
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(4 * width),
        rows_per_image: None,
    };
    let target = wgpu::TexelCopyBufferInfo {
        buffer: &arrived,
        layout,
    };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), target, size);
    gpu.queue.submit([encoder.finish()]);
    arrived
        .slice(..)
        .map_async(wgpu::MapMode::Read, |mapped| mapped.expect("bytes"));
    gpu.device
        .poll(wgpu::PollType::wait_indefinitely())
        .expect("a device");
    let bytes = arrived.slice(..).get_mapped_range().expect("bytes");
    bytes.to_vec()
}
