//! Draws the built-in rabbit with a sheet through it, on any device of the machine: `cargo run --example picture -- rabbit.png`.

use incise_mesh::{Model, build_model};
use incise_render::{
    BodyView, Camera, Color, Content, Offscreen, Overlay, Renderer, Sheet, View, Wireframe,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("name a PNG file")?;
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let request = instance.request_adapter(&wgpu::RequestAdapterOptions::default());
    let adapter = pollster::block_on(request)?;
    let limits = wgpu::Limits::default().or_worse_values_from(&adapter.limits());
    let descriptor = wgpu::DeviceDescriptor {
        required_limits: limits,
        ..wgpu::DeviceDescriptor::default()
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))?;

    let rabbit = build_model(Model::Bunny);
    let renderer = Renderer::offscreen(&device, &queue)?;
    let body = BodyView::of(&renderer, &rabbit, |t| {
        Some(Color::of_piece(usize::from(
            rabbit.triangle_positions(t)[0].x > 0.0,
        )))
    })?;
    let sheet = Sheet {
        corners: [[0.0, -0.5, -0.5], [0.0, -0.5, 0.7], [0.0, 0.9, 0.0]],
        color: Color::rgb(60, 120, 200).with_alpha(90),
    };
    let overlay = Overlay::new(&renderer, &[sheet], &[])?;
    let camera = Camera::looking(0.6, 0.3).fit(&rabbit.bounds(), 4.0 / 3.0);
    let view = View {
        wireframe: Some(Wireframe::default()),
        ..View::of(camera)
    };
    let content = Content {
        bodies: &[&body],
        overlays: &[&overlay],
    };
    let picture = Offscreen::new(&renderer, 960, 720)?.picture(&renderer, &view, &content)?;
    picture.write_png(path.as_ref())?;
    Ok(())
}
