//! Draws the built-in rabbit with a sheet through it, on any device of the machine.
//!
//! `cargo run -p incise-render --example picture -- rabbit.png`

use incise_mesh::{Model, build_model};
use incise_render::{BodyView, Camera, Color, Content, Offscreen, Overlay, Renderer, Sheet, View};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (device, queue) = device()?; // of wgpu
    let renderer = Renderer::offscreen(&device, &queue)?;
    let rabbit = build_model(Model::Bunny);
    let body = BodyView::of(&renderer, &rabbit, |_| Some(Color::rgb(154, 174, 198)))?;
    let sheet = Sheet {
        corners: [[0.0, -0.5, -0.5], [0.0, -0.5, 0.7], [0.0, 0.9, 0.0]],
        color: Color::rgb(60, 120, 200).with_alpha(90),
    };
    let overlay = Overlay::new(&renderer, &[sheet], &[])?;
    let content = Content {
        bodies: &[&body],
        overlays: &[&overlay],
    };
    let camera = Camera::looking(0.6, 0.3).fit(&rabbit.bounds(), 4.0 / 3.0);
    let picture = Offscreen::new(&renderer, 960, 720)?;
    let picture = picture.picture(&renderer, &View::of(camera), &content)?;
    let path = std::env::args().nth(1);
    picture.write_png(path.as_deref().unwrap_or("rabbit.png").as_ref())?;
    Ok(())
}

/// Any device.
fn device() -> Result<(wgpu::Device, wgpu::Queue), Box<dyn std::error::Error>> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let request = instance.request_adapter(&wgpu::RequestAdapterOptions::default());
    let adapter = pollster::block_on(request)?;
    let descriptor = wgpu::DeviceDescriptor {
        required_limits: wgpu::Limits::default().or_worse_values_from(&adapter.limits()),
        ..wgpu::DeviceDescriptor::default()
    };
    Ok(pollster::block_on(adapter.request_device(&descriptor))?)
}
