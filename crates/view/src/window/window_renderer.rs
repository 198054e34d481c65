//! Presents the body and the panel in the window with wgpu.

use crate::error::ViewError;
use incise_pbd_gpu::wgpu;
use incise_pbd_gpu::{AdapterKind, AdapterRequest, Context, GpuError};
use incise_render::{Attachments, DrawList, Renderer, View};
use std::cell::RefCell;
use std::sync::Arc;
use winit::event_loop::ActiveEventLoop;
use winit::window::Window;

/// The window's swapchain, the GPU device, and the renderers of body and panel.
pub(super) struct WindowRenderer {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    adapter: wgpu::Adapter,
    context: Context,
    renderer: Renderer,
    attachments: Attachments,
    ui: egui_wgpu::Renderer,
    textures: egui::TexturesDelta,
}

/// The tessellated panel.
pub(super) struct PanelShapes {
    pub(super) shapes: Vec<egui::ClippedPrimitive>,
    /// Pixels per point.
    pub(super) scale: f32,
}

impl WindowRenderer {
    /// Opens the requested adapter that can present to the window.
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
            if crashes_on_surface_query(&name) {
                unasked.replace(Some(name));
                return false;
            }
            adapter.is_surface_supported(&surface)
        };
        let opened = Context::open_among(adapters, request, draws);
        let (context, adapter) = opened.map_err(|error| match (error, unasked.take()) {
            (GpuError::NoAdapter { .. }, Some(adapter)) => ViewError::NoPresentation { adapter },
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
        // The panel blends in sRGB, so a format without sRGB conversion is preferred.
        let plain = [
            wgpu::TextureFormat::Bgra8Unorm,
            wgpu::TextureFormat::Rgba8Unorm,
        ];
        if let Some(format) = plain.into_iter().find(|f| formats.contains(f)) {
            config.format = format;
        }
        let made = context.scoped("a window's surface", || surface.configure(device, &config));
        made?;
        // Multisampling is too slow for software adapters.
        let samples = match context.adapter().kind {
            AdapterKind::Software => 1,
            _ => Renderer::supported_samples(device, config.format),
        };
        let renderer = Renderer::new(device, context.queue(), config.format, samples)?;
        let attachments = Attachments::new(&renderer, config.width, config.height)?;
        let options = egui_wgpu::RendererOptions::default();
        let ui = context.scoped("the panel", || {
            egui_wgpu::Renderer::new(device, config.format, options)
        })?;
        Ok(Self {
            surface,
            config,
            adapter,
            renderer,
            attachments,
            ui,
            context,
            textures: egui::TexturesDelta::default(),
        })
    }

    /// Returns the context of the GPU device.
    pub(super) fn context(&self) -> &Context {
        &self.context
    }

    /// Returns a second context on the same GPU device, for the scene.
    pub(super) fn second_context(&self) -> Result<Context, GpuError> {
        let (device, queue) = (self.context.device(), self.context.queue());
        Context::from_device(&self.adapter, device.clone(), queue.clone())
    }

    /// Returns the renderer of the body.
    pub(super) fn scene_renderer(&self) -> &Renderer {
        &self.renderer
    }

    /// Returns width and height \[px\].
    pub(super) fn size(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// Resizes the swapchain and the attachments.
    pub(super) fn resize(&mut self, size: [u32; 2]) -> Result<(), ViewError> {
        // A minimized window has no pixels.
        if size.contains(&0) || size == self.size() {
            return Ok(());
        }
        let limit = self.context.device().limits().max_texture_dimension_2d;
        let [width, height] = size.map(|pixels| pixels.min(limit));
        (self.config.width, self.config.height) = (width, height);
        self.attachments = Attachments::new(&self.renderer, width, height)?;
        self.configure()
    }

    /// Queues texture changes of the panel for the next redraw.
    pub(super) fn take_textures(&mut self, textures: egui::TexturesDelta) {
        self.textures.append(textures);
    }

    fn configure(&self) -> Result<(), ViewError> {
        let device = self.context.device();
        let configure = || self.surface.configure(device, &self.config);
        Ok(self.context.scoped("a window's surface", configure)?)
    }

    /// Draws body and panel and presents them; does nothing while the window is not visible.
    pub(super) fn draw(
        &mut self,
        view: &View,
        draw_list: &DrawList<'_>,
        ui: PanelShapes,
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
        (self.renderer).encode(&mut encoder, &self.attachments, &target, view, draw_list)?;
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

/// Returns true if querying surface support crashes the driver.
///
/// The `SwiftShader` of browsers has no support for X or Wayland windows. With another driver that
/// has, the Vulkan loader passes the query on to both, and `SwiftShader` crashes.
fn crashes_on_surface_query(adapter: &str) -> bool {
    !cfg!(windows) && adapter.to_lowercase().contains("swiftshader")
}

impl Drop for WindowRenderer {
    /// Clears pending texture changes, which egui requires to be consumed.
    fn drop(&mut self) {
        self.textures.clear();
    }
}
