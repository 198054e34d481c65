//! A window's surface and the device that draws on it.

use crate::error::ViewError;
use incise_pbd_gpu::wgpu;
use incise_pbd_gpu::{AdapterKind, AdapterRequest, Context, GpuError};
use incise_render::{Canvas, Content, Renderer, View};
use std::cell::RefCell;
use std::sync::Arc;
use winit::event_loop::ActiveEventLoop;
use winit::window::Window;

/// Draws in a window.
pub(super) struct Screen {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    adapter: wgpu::Adapter,
    context: Context,
    renderer: Renderer,
    canvas: Canvas,
    ui: egui_wgpu::Renderer,
    textures: egui::TexturesDelta,
}

/// What lies over the picture.
pub(super) struct Ui {
    pub(super) shapes: Vec<egui::ClippedPrimitive>,
    /// Pixels a point.
    pub(super) scale: f32,
}

impl Screen {
    pub(super) fn open(
        events: &ActiveEventLoop,
        window: Arc<Window>,
        request: &AdapterRequest,
    ) -> Result<Self, ViewError> {
        let display = Box::new(events.owned_display_handle());
        let mut descriptor = wgpu::InstanceDescriptor::new_with_display_handle(display);
        descriptor.flags = wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL.with_env();
        let instance = wgpu::Instance::new(descriptor);
        let size = window.inner_size();
        let surface = instance
            .create_surface(window)
            .map_err(|error| ViewError::NoSurface {
                message: error.to_string(),
            })?;
        let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
        let unasked = RefCell::new(None);
        let draws = |adapter: &wgpu::Adapter| {
            let name = adapter.get_info().name;
            if crashes_when_asked(&name) {
                unasked.replace(Some(name));
                return false;
            }
            adapter.is_surface_supported(&surface)
        };
        let opened = Context::open_among(adapters, request, draws);
        let (context, adapter) = opened.map_err(|error| match (error, unasked.take()) {
            (GpuError::NoAdapter { .. }, Some(adapter)) => ViewError::NotInWindows { adapter },
            (error, _) => error.into(),
        })?;
        let device = context.device();
        let (width, height) = (size.width.max(1), size.height.max(1));
        let limit = device.limits().max_texture_dimension_2d;
        let (width, height) = (width.min(limit), height.min(limit));
        let config = surface.get_default_config(&adapter, width, height);
        let mut config = config.ok_or_else(|| ViewError::NoSurface {
            message: format!("{} cannot draw in it", context.adapter().name),
        })?;
        let formats = surface.get_capabilities(&adapter).formats;
        // The panel mixes its colors as they are shown, and the renderer follows.
        let plain = [
            wgpu::TextureFormat::Bgra8Unorm,
            wgpu::TextureFormat::Rgba8Unorm,
        ];
        if let Some(format) = plain.into_iter().find(|f| formats.contains(f)) {
            config.format = format;
        }
        let made = context.scoped("a window's surface", || surface.configure(device, &config));
        made?;
        // Every sample costs a processor that draws as much as a pixel.
        let samples = match context.adapter().kind {
            AdapterKind::Software => 1,
            _ => Renderer::supported_samples(device, config.format),
        };
        let renderer = Renderer::new(device, context.queue(), config.format, samples)?;
        let canvas = Canvas::new(&renderer, config.width, config.height)?;
        let options = egui_wgpu::RendererOptions::default();
        let ui = context.scoped("the panel", || {
            egui_wgpu::Renderer::new(device, config.format, options)
        })?;
        Ok(Self {
            surface,
            config,
            adapter,
            renderer,
            canvas,
            ui,
            context,
            textures: egui::TexturesDelta::default(),
        })
    }

    /// The open device.
    pub(super) fn context(&self) -> &Context {
        &self.context
    }

    /// The same device once more, for a scene.
    pub(super) fn second_context(&self) -> Result<Context, GpuError> {
        let (device, queue) = (self.context.device(), self.context.queue());
        Context::from_device(&self.adapter, device.clone(), queue.clone())
    }

    pub(super) fn renderer(&self) -> &Renderer {
        &self.renderer
    }

    /// Pixels across and along.
    pub(super) fn size(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    pub(super) fn resize(&mut self, size: [u32; 2]) -> Result<(), ViewError> {
        // A window that is out of sight has no pixels.
        if size.contains(&0) || size == self.size() {
            return Ok(());
        }
        let limit = self.context.device().limits().max_texture_dimension_2d;
        let [width, height] = size.map(|pixels| pixels.min(limit));
        (self.config.width, self.config.height) = (width, height);
        self.canvas = Canvas::new(&self.renderer, width, height)?;
        self.configure()
    }

    /// Takes over what has changed of the panel's textures; the next picture is drawn with it.
    pub(super) fn take_textures(&mut self, textures: egui::TexturesDelta) {
        self.textures.append(textures);
    }

    fn configure(&self) -> Result<(), ViewError> {
        let device = self.context.device();
        let configure = || self.surface.configure(device, &self.config);
        Ok(self.context.scoped("a window's surface", configure)?)
    }

    /// Draws a picture and what lies over it, and shows it. A window that cannot show anything now is passed over.
    pub(super) fn draw(
        &mut self,
        view: &View,
        content: &Content<'_>,
        ui: Ui,
    ) -> Result<(), ViewError> {
        use wgpu::CurrentSurfaceTexture as Now;
        self.context.check()?;
        let mut now = self.surface.get_current_texture();
        if matches!(now, Now::Outdated | Now::Lost | Now::Suboptimal(_)) {
            drop(now);
            self.configure()?;
            now = self.surface.get_current_texture();
        }
        let (Now::Success(texture) | Now::Suboptimal(texture)) = now else {
            return Ok(());
        };
        let (device, queue) = (self.context.device(), self.context.queue());
        let target = texture.texture.create_view(&wgpu::TextureViewDescriptor {
            format: Some(self.config.format),
            ..wgpu::TextureViewDescriptor::default()
        });
        let label = Some("window");
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
        (self.renderer).encode(&mut encoder, &self.canvas, &target, view, content)?;
        let textures = &mut self.textures;
        self.context.scoped("drawing the window", || {
            for (id, changes) in &textures.set {
                for change in changes {
                    self.ui.update_texture(device, queue, *id, change);
                }
            }
            let size = egui_wgpu::ScreenDescriptor {
                size_in_pixels: [self.config.width, self.config.height],
                pixels_per_point: ui.scale,
            };
            let mut commands =
                (self.ui).update_buffers(device, queue, &mut encoder, &ui.shapes, &size);
            let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("panel"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &target,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Load,
                        store: wgpu::StoreOp::Store,
                    },
                })],
                depth_stencil_attachment: None,
                timestamp_writes: None,
                occlusion_query_set: None,
                multiview_mask: None,
            });
            self.ui
                .render(&mut pass.forget_lifetime(), &ui.shapes, &size);
            for id in &textures.free {
                self.ui.free_texture(id);
            }
            textures.clear();
            commands.push(encoder.finish());
            queue.submit(commands);
            queue.present(texture);
        })?;
        Ok(())
    }
}

/// Whether a driver of that name may not be asked if it draws in a window. `SwiftShader` as browsers bring it has nothing for
/// windows of X or Wayland; where another driver has, the system takes the question for both, and `SwiftShader` crashes.
fn crashes_when_asked(adapter: &str) -> bool {
    !cfg!(windows) && adapter.to_lowercase().contains("swiftshader")
}

impl Drop for Screen {
    /// Changes of textures that nobody draws with any more are to be cleared, else they panic.
    fn drop(&mut self) {
        self.textures.clear();
    }
}
