//! The program as the system sees it: the window is opened, and events are handed to it.

use super::pace::Pace;
use super::picture::Picture;
use super::screen::Screen;
use super::{Look, Open, Options, Times, panel};
use crate::command::Settings;
use crate::error::ViewError;
use crate::pointer::{Eye, Pointer};
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

/// A window that is there or is to come.
pub(super) struct App {
    options: Options,
    settings: Settings,
    replay: Option<Replay>,
    open: Option<Open>,
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
        let done = open.event(&event);
        match done {
            Ok(_) if open.is_over => events.exit(),
            Ok(None) => {}
            Ok(Some(wait)) => events.set_control_flow(wait),
            // A body that has left the numbers can be reset.
            Err(ViewError::Scene(error)) => {
                open.told = Some((error.to_string(), true));
                open.window.request_redraw();
            }
            Err(failure) => self.fail(events, failure),
        }
    }
}

impl App {
    pub(super) fn new(options: Options, settings: Settings, replay: Option<Replay>) -> Self {
        Self {
            options,
            settings,
            replay,
            open: None,
            failure: None,
        }
    }

    /// What the window was closed for, if it was not the user.
    pub(super) fn outcome(self) -> Result<(), ViewError> {
        self.failure.map_or(Ok(()), Err)
    }

    fn fail(&mut self, events: &ActiveEventLoop, failure: ViewError) {
        self.failure = Some(failure);
        events.exit();
    }

    fn open(&mut self, events: &ActiveEventLoop) -> Result<Open, ViewError> {
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
        let screen = Screen::open(events, Arc::clone(&window), &request)?;
        let (scene, device) = self.scene(&screen)?;
        let surface = self.options.surface.clone();
        let session = Session::with_settings(surface, scene, self.settings)?;
        let picture = Picture::new(&screen, &session)?;
        let size = screen.size();
        let egui = panel::state(&window);
        let mut open = Open {
            window,
            screen,
            picture,
            egui,
            session,
            eye: Eye {
                camera: Camera::default(),
                size,
                covered: 0.0,
            },
            pointer: Pointer::default(),
            shift: false,
            look: Look::default(),
            times: Times::default(),
            device,
            paused: self.options.paused,
            pace: Pace::new(Instant::now()),
            replay: self.replay.take(),
            last: Instant::now(),
            owed: Duration::ZERO,
            told: None,
            record_to: self.options.record_to.clone(),
            save: std::mem::replace(&mut self.options.save, Box::new(|_| Ok(String::new()))),
            is_over: false,
        };
        open.eye.covered = open.covered();
        open.fit()?;
        open.window.request_redraw();
        Ok(open)
    }

    /// The scene on the screen's device if it is to move bodies, and what to say of it.
    fn scene(&self, screen: &Screen) -> Result<(Scene, String), ViewError> {
        let adapter = screen.context().adapter();
        let name = &adapter.name;
        let mut request = self.options.backend.clone();
        let is_software = adapter.kind == AdapterKind::Software;
        if is_software && request.choice == BackendChoice::Auto {
            request.choice = BackendChoice::Cpu;
        }
        let params = SceneParams::default();
        let scene = match request.choice {
            BackendChoice::Cpu => Scene::new(params),
            _ => Scene::with_context(params, &request, screen.second_context()?)?,
        };
        let drawn = if is_software {
            format!("{name}; there is no GPU, so large windows are slow")
        } else {
            name.clone()
        };
        Ok((scene, drawn))
    }
}
