//! Renders the built-in bunny with a translucent plane through it to a PNG file.
//!
//! `cargo run -p incise-render --example render_png -- bunny.png`

use incise_models::{Model, build_model};
use incise_render::{BodyView, Camera, Color, DrawList, Offscreen, Overlay, OverlayTriangle};
use incise_render::{Renderer, View};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (device, queue) = open_device()?;
    let renderer = Renderer::offscreen(&device, &queue)?;
    let surface = build_model(Model::Bunny);
    let color = Color::rgb(154, 174, 198);
    let body = BodyView::from_surface(&renderer, &surface, |_| Some(color))?;
    let plane = OverlayTriangle {
        corners: [[0.0, -0.5, -0.5], [0.0, -0.5, 0.7], [0.0, 0.9, 0.0]],
        color: Color::rgb(60, 120, 200).with_alpha(90),
    };
    let overlay = Overlay::new(&renderer, &[plane], &[])?;
    let draw_list = DrawList {
        bodies: &[&body],
        overlays: &[&overlay],
    };
    let camera = Camera::from_angles(0.6, 0.3).fit(&surface.bounds(), 4.0 / 3.0);
    let target = Offscreen::new(&renderer, 960, 720)?;
    let image = target.render(&renderer, &View::from_camera(camera), &draw_list)?;
    let path = std::env::args().nth(1);
    image.write_png(path.as_deref().unwrap_or("bunny.png").as_ref())?;
    Ok(())
}

/// Opens the default adapter, with the default limits where the adapter supports them.
fn open_device() -> Result<(wgpu::Device, wgpu::Queue), Box<dyn std::error::Error>> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let request = instance.request_adapter(&wgpu::RequestAdapterOptions::default());
    let adapter = pollster::block_on(request)?;
    let descriptor = wgpu::DeviceDescriptor {
        required_limits: wgpu::Limits::default().or_worse_values_from(&adapter.limits()),
        ..wgpu::DeviceDescriptor::default()
    };
    Ok(pollster::block_on(adapter.request_device(&descriptor))?)
}
