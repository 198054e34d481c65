//! The winit application: opens the window and dispatches its events.

use super::playback_speed::PlaybackSpeed;
use super::scene_view::SceneView;
use super::window_renderer::WindowRenderer;
use super::{DisplayOptions, FrameTimes, OpenWindow, WindowOptions, panel};
use crate::command::Settings;
use crate::error::ViewError;
use crate::pointer::{OrbitCamera, Pointer};
use crate::recording::Replay;
use crate::session::Session;
use incise_pbd_gpu::{AdapterKind, AdapterRequest};
use incise_render::Camera;
use incise_scene::{BackendChoice, Scene, SceneParams};
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::ActiveEventLoop;
use winit::window::{Window, WindowId};

/// The application, before and after its window is open.
pub(super) struct App {
    options: WindowOptions,
    settings: Settings,
    replay: Option<Replay>,
    open: Option<OpenWindow>,
    failure: Option<ViewError>,
}
impl ApplicationHandler for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.open.is_some() {
            return;
        }
        match self.open(events) {
            Ok(open) => self.open = Some(open),
            Err(failure) => self.fail(events, failure),
        }
    }

    fn new_events(&mut self, _events: &ActiveEventLoop, cause: StartCause) {
        if let (StartCause::ResumeTimeReached { .. }, Some(open)) = (cause, &self.open) {
            open.window.request_redraw();
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        let done = open.handle(&event);
        match done {
            Ok(_) if open.is_closing => events.exit(),
            Ok(None) => {}
            Ok(Some(wait)) => events.set_control_flow(wait),
            // A body with invalid positions can be reset, so the window stays open.
            Err(ViewError::Scene(error)) => {
                open.message = Some((error.to_string(), true));
                open.window.request_redraw();
            }
            Err(failure) => self.fail(events, failure),
        }
    }
}

impl App {
    pub(super) fn new(options: WindowOptions, settings: Settings, replay: Option<Replay>) -> Self {
        Self {
            options,
            settings,
            replay,
            open: None,
            failure: None,
        }
    }

    /// Returns the error that closed the window, if any.
    pub(super) fn outcome(self) -> Result<(), ViewError> {
        self.failure.map_or(Ok(()), Err)
    }

    fn fail(&mut self, events: &ActiveEventLoop, failure: ViewError) {
        self.failure = Some(failure);
        events.exit();
    }

    fn open(&mut self, events: &ActiveEventLoop) -> Result<OpenWindow, ViewError> {
        let [width, height] = self.options.size;
        let attributes = Window::default_attributes()
            .with_title(self.options.title.clone())
            .with_inner_size(PhysicalSize::new(width, height));
        let window = events
            .create_window(attributes)
            .map_err(|error| ViewError::Window {
                message: error.to_string(),
            })?;
        let window = Arc::new(window);
        let request = AdapterRequest::any(self.options.backend.adapter.clone());
        let renderer = WindowRenderer::open(events, Arc::clone(&window), &request)?;
        let (scene, adapter) = self.create_scene(&renderer)?;
        let surface = self.options.surface.clone();
        let session = Session::with_settings(surface, scene, self.settings)?;
        let scene_view = SceneView::new(renderer.scene_renderer(), &session)?;
        let size = renderer.size();
        let egui = panel::state(&window);
        let mut open = OpenWindow {
            window,
            renderer,
            scene_view,
            egui,
            session,
            orbit: OrbitCamera {
                camera: Camera::default(),
                size,
                panel_width: 0.0,
            },
            pointer: Pointer::default(),
            shift: false,
            display: DisplayOptions::default(),
            times: FrameTimes::default(),
            adapter,
            paused: self.options.paused,
            speed: PlaybackSpeed::new(Instant::now()),
            replay: self.replay.take(),
            last_redraw: Instant::now(),
            accumulator: Duration::ZERO,
            message: None,
            record_to: self.options.record_to.clone(),
            save: std::mem::replace(&mut self.options.save, Box::new(|_| Ok(String::new()))),
            is_closing: false,
        };
        open.orbit.panel_width = open.panel_width();
        open.fit()?;
        open.window.request_redraw();
        Ok(open)
    }

    /// Creates the scene, on the renderer's GPU device if requested, and describes the adapter.
    fn create_scene(&self, renderer: &WindowRenderer) -> Result<(Scene, String), ViewError> {
        let adapter = renderer.context().adapter();
        let name = &adapter.name;
        let mut request = self.options.backend.clone();
        let is_software = adapter.kind == AdapterKind::Software;
        if is_software && request.choice == BackendChoice::Auto {
            request.choice = BackendChoice::Cpu;
        }
        let params = SceneParams::default();
        let scene = match request.choice {
            BackendChoice::Cpu => Scene::new(params),
            _ => Scene::with_context(params, &request, renderer.second_context()?)?,
        };
        let description = if is_software {
            format!("{name}: software rendering, slow for large windows")
        } else {
            name.clone()
        };
        Ok((scene, description))
    }
}
