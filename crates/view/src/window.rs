//! The window: events in, pictures out.

mod graph;
mod panel;
mod picture;
mod screen;

use crate::command::{Command, Settings};
use crate::error::ViewError;
use crate::keys::{Action, action_of};
use crate::pointer::{Button, Eye, Pointer};
use crate::recording::{Progress, Recording, Replay};
use crate::session::Session;
use graph::Times;
use incise_mesh::Surface;
use incise_pbd_gpu::{AdapterKind, AdapterRequest};
use incise_refine::RefinementLevel;
use incise_render::Camera;
use incise_scene::{BackendChoice, BackendRequest, Scene, SceneParams};
use picture::Picture;
use screen::Screen;
use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{ElementState, MouseButton, MouseScrollDelta, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::keyboard::{Key, NamedKey};
use winit::window::{Window, WindowId};

/// Most frames that are stepped for one picture: a machine that is too slow shows motion slowed down, and answers.
const MOST_STEPS: u32 = 3;

/// Pixels of a touchpad that count as one notch of a wheel.
const NOTCH: f64 = 40.0;

/// What the pieces of a body are saved with; says what it did, or why it could not.
pub type Save = Box<dyn FnMut(&Surface) -> Result<String, String>>;

/// What to show, and how.
pub struct Options {
    /// What the window is called.
    pub title: String,
    /// The body.
    pub surface: Surface,
    /// What moves it. An adapter's name is also that of the one that draws.
    pub backend: BackendRequest,
    /// Pixels across and along.
    pub size: [u32; 2],
    /// What to do again.
    pub replay: Option<Recording>,
    /// Where the recording goes when it is saved.
    pub record_to: PathBuf,
    /// Saves the pieces.
    pub save: Save,
}

impl std::fmt::Debug for Options {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Options")
            .field("title", &self.title)
            .field("backend", &self.backend)
            .field("size", &self.size)
            .field("record_to", &self.record_to)
            .finish_non_exhaustive()
    }
}

/// How things look.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Look {
    wireframe: bool,
    pieces: bool,
    caps: bool,
    batches: bool,
    panel: bool,
    help: bool,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            wireframe: false,
            pieces: true,
            caps: true,
            batches: false,
            panel: true,
            help: false,
        }
    }
}

/// Shows a body until the window is closed.
///
/// # Errors
/// [`ViewError`]: no display, no device that draws in windows, a body that cannot be simulated, a device that fails.
pub fn run(options: Options) -> Result<(), ViewError> {
    let replay = options.replay.clone();
    let settings = replay
        .as_ref()
        .map_or_else(Settings::default, Recording::settings);
    let replay = replay.map(|r| r.replay(&options.surface)).transpose()?;
    let events = EventLoop::new().map_err(|error| ViewError::NoDisplay {
        message: error.to_string(),
    })?;
    let mut app = App {
        options,
        settings,
        replay,
        open: None,
        failure: None,
    };
    let ended = events.run_app(&mut app);
    if let Some(failure) = app.failure {
        return Err(failure);
    }
    ended.map_err(|error| ViewError::Window {
        message: error.to_string(),
    })
}

struct App {
    options: Options,
    settings: Settings,
    replay: Option<Replay>,
    open: Option<Open>,
    failure: Option<ViewError>,
}

/// Everything that there is once there is a window.
struct Open {
    window: Arc<Window>,
    screen: Screen,
    picture: Picture,
    egui: egui_winit::State,
    session: Session,
    eye: Eye,
    pointer: Pointer,
    shift: bool,
    look: Look,
    times: Times,
    /// What draws and what moves, and why.
    device: String,
    paused: bool,
    replay: Option<Replay>,
    /// When the last picture was begun.
    last: Instant,
    /// Time that is not simulated yet.
    owed: Duration,
    /// What was saved or not.
    told: Option<(String, bool)>,
    record_to: PathBuf,
    save: Save,
    is_over: bool,
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
        let request = AdapterRequest {
            name: self.options.backend.adapter.clone(),
            allow_software: true,
            ..AdapterRequest::default()
        };
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
            paused: false,
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

impl Open {
    /// Returns until when to wait for the next event, if that has changed.
    fn event(&mut self, event: &WindowEvent) -> Result<Option<ControlFlow>, ViewError> {
        if let WindowEvent::RedrawRequested = event {
            return self.redraw().map(Some);
        }
        let answer = self.egui.on_window_event(&self.window, event);
        if answer.repaint {
            self.window.request_redraw();
        }
        match event {
            WindowEvent::CloseRequested => self.is_over = true,
            WindowEvent::Resized(size) => {
                self.screen.resize([size.width, size.height])?;
                self.eye.size = self.screen.size();
                self.eye.covered = self.covered();
                self.window.request_redraw();
            }
            WindowEvent::ModifiersChanged(modifiers) => {
                self.shift = modifiers.state().shift_key();
            }
            WindowEvent::Focused(false) => self.pointer.cancel(&mut self.session),
            WindowEvent::CursorMoved { position, .. } => {
                let to = [position.x, position.y];
                self.pointer.go(to, &mut self.eye, &mut self.session)?;
                if self.pointer.is_busy() {
                    self.window.request_redraw();
                }
            }
            WindowEvent::MouseInput { state, button, .. } => {
                let button = match button {
                    MouseButton::Left => Button::Left,
                    MouseButton::Middle => Button::Middle,
                    MouseButton::Right => Button::Right,
                    _ => return Ok(None),
                };
                self.click(button, *state == ElementState::Pressed)?;
            }
            WindowEvent::MouseWheel { delta, .. } if !self.is_over_panel() => {
                self.eye.zoom(match delta {
                    MouseScrollDelta::LineDelta(_, lines) => f64::from(*lines),
                    MouseScrollDelta::PixelDelta(pixels) => pixels.y / NOTCH,
                });
                self.window.request_redraw();
            }
            WindowEvent::KeyboardInput { event, .. } if event.state == ElementState::Pressed => {
                if self.egui.egui_ctx().text_edit_focused() {
                    return Ok(None);
                }
                let name = match &event.logical_key {
                    Key::Character(character) => character.as_str(),
                    Key::Named(NamedKey::Space) => "Space",
                    Key::Named(NamedKey::Escape) => {
                        self.look.help = false;
                        self.pointer.cancel(&mut self.session);
                        ""
                    }
                    _ => "",
                };
                // A plus is a shifted equals sign on many keyboards.
                let name = if name == "=" { "+" } else { name };
                if let Some(action) = action_of(name) {
                    self.act(action)?;
                }
                self.window.request_redraw();
            }
            _ => {}
        }
        Ok(None)
    }

    fn click(&mut self, button: Button, is_down: bool) -> Result<(), ViewError> {
        if !is_down {
            self.pointer.release(button, &self.eye, &mut self.session)?;
        } else if !self.is_over_panel() {
            self.session.dismiss();
            self.told = None;
            let (eye, session) = (&self.eye, &mut self.session);
            self.pointer.press(button, self.shift, eye, session)?;
        }
        self.window.request_redraw();
        Ok(())
    }

    /// Whether the pointer is over the panel, or over a window of its own.
    fn is_over_panel(&self) -> bool {
        let context = self.egui.egui_ctx();
        let scale = f64::from(context.pixels_per_point());
        let [x, y] = self.pointer.at();
        let at = egui::Pos2::from([x / scale, y / scale].map(panel::narrow));
        let layer = context.layer_id_at(at);
        let is_window = layer.is_some_and(|layer| layer.order != egui::Order::Background);
        is_window || x > f64::from(self.eye.size[0]) - self.eye.covered
    }

    /// How much of the window the panel covers \[px\].
    fn covered(&self) -> f64 {
        if self.look.panel {
            f64::from(panel::WIDTH * self.egui.egui_ctx().pixels_per_point())
        } else {
            0.0
        }
    }

    fn fit(&mut self) -> Result<(), ViewError> {
        let mut bounds = self.session.bounds()?;
        if self.session.settings().ground {
            bounds.min[1] = bounds.min[1].min(self.session.ground());
        }
        self.eye.fit(&bounds);
        Ok(())
    }

    fn act(&mut self, action: Action) -> Result<(), ViewError> {
        let mut settings = *self.session.settings();
        match action {
            Action::Take(tool) => self.pointer.tool = tool,
            Action::Pause => self.paused = !self.paused,
            Action::Step => {
                self.paused = true;
                self.step()?;
            }
            Action::Reset => {
                self.session.apply(Command::Reset);
                self.told = None;
            }
            Action::Undo => self.session.apply(Command::Undo),
            Action::Redo => self.session.apply(Command::Redo),
            Action::Unpin => self.session.apply(Command::Unpin),
            Action::Fit => self.fit()?,
            Action::Wireframe => self.look.wireframe ^= true,
            Action::PieceColors => self.look.pieces ^= true,
            Action::CapColors => self.look.caps ^= true,
            Action::Batches => self.look.batches ^= true,
            Action::Coarser => settings.level = next_level(settings.level, false),
            Action::Finer => settings.level = next_level(settings.level, true),
            Action::FewerSubsteps => settings.substeps = (settings.substeps - 1).max(1),
            Action::MoreSubsteps => settings.substeps = (settings.substeps + 1).min(panel::MOST),
            Action::Save => {
                self.session.read()?;
                let saved = (self.save)(self.session.surface());
                self.told = Some(match saved {
                    Ok(text) => (text, false),
                    Err(text) => (text, true),
                });
            }
            Action::SaveRecording => self.save_recording()?,
            Action::Panel => {
                self.look.panel ^= true;
                self.eye.covered = self.covered();
            }
            Action::Help => self.look.help ^= true,
            Action::Quit => self.is_over = true,
        }
        if settings != *self.session.settings() {
            self.session.apply(Command::Set(settings));
        }
        Ok(())
    }

    fn save_recording(&mut self) -> Result<(), ViewError> {
        let recording = self.session.finished_recording()?;
        let path = self.record_to.display();
        let written = File::create(&self.record_to).and_then(|file| {
            let mut out = BufWriter::new(file);
            recording.write(&mut out)?;
            std::io::Write::flush(&mut out)
        });
        self.told = Some(match written {
            Ok(()) => (format!("{path}: the recording so far"), false),
            Err(error) => (format!("{path}: {error}"), true),
        });
        Ok(())
    }

    /// Steps by a frame, with what the recording has for it.
    fn step(&mut self) -> Result<(), ViewError> {
        if let Some(replay) = &mut self.replay
            && let Progress::Over(is_same) = replay.follow(&mut self.session)?
        {
            self.replay = None;
            self.paused = true;
            self.told = Some(match is_same {
                Some(true) => ("the replay is over: the same to the bit".to_owned(), false),
                Some(false) => ("the replay is over and differs".to_owned(), true),
                None => ("the replay is over".to_owned(), false),
            });
            return Ok(());
        }
        self.session.frame();
        let frame = self.session.last();
        self.times.push(frame.time, frame.stats.cutting());
        Ok(())
    }

    /// Whether time goes on.
    fn is_moving(&self) -> bool {
        let rests = self.session.is_asleep() && self.session.held_vertex().is_none();
        !self.paused && (!rests || self.replay.is_some())
    }

    /// Steps as many frames as time has passed.
    fn advance(&mut self) -> Result<(), ViewError> {
        let now = Instant::now();
        let passed = now - std::mem::replace(&mut self.last, now);
        let dt = Duration::from_secs_f32(SceneParams::default().dt);
        if !self.is_moving() {
            self.owed = dt;
            return Ok(());
        }
        self.owed = (self.owed + passed).min(dt * MOST_STEPS);
        let begin = Instant::now();
        while self.owed >= dt && self.is_moving() {
            self.owed -= dt;
            self.step()?;
            // The picture matters more than the clock.
            if begin.elapsed() > dt / 2 {
                self.owed = self.owed.min(dt);
                break;
            }
        }
        Ok(())
    }

    fn redraw(&mut self) -> Result<ControlFlow, ViewError> {
        let begin = Instant::now();
        self.advance()?;
        let input = self.egui.take_egui_input(&self.window);
        let context = self.egui.egui_ctx().clone();
        let mut asked = panel::Asked::of(&self.session);
        let output = context.run_ui(input, |ui| panel::show(ui, self, &mut asked));
        self.screen.take_textures(output.textures_delta);
        let repaint = output
            .viewport_output
            .values()
            .map(|viewport| viewport.repaint_delay)
            .min();
        self.egui
            .handle_platform_output(&self.window, output.platform_output);
        let ui = screen::Ui {
            shapes: context.tessellate(output.shapes, output.pixels_per_point),
            scale: output.pixels_per_point,
        };
        self.picture
            .update(&self.screen, &mut self.session, self.look, &self.eye)?;
        let view = self.picture.view(&self.eye, self.look);
        let drawn = self.picture.content();
        self.screen.draw(&view, &drawn.content(), ui)?;
        self.times.picture(begin.elapsed());
        for action in asked.actions {
            self.act(action)?;
            self.window.request_redraw();
        }
        if asked.settings != *self.session.settings() {
            self.session.apply(Command::Set(asked.settings));
            self.window.request_redraw();
        }
        if self.is_moving() {
            let dt = Duration::from_secs_f32(SceneParams::default().dt);
            return Ok(ControlFlow::WaitUntil(begin + dt));
        }
        let soon = repaint.and_then(|delay| begin.checked_add(delay));
        Ok(soon.map_or(ControlFlow::Wait, ControlFlow::WaitUntil))
    }
}

/// The next of the five levels in a direction.
fn next_level(level: RefinementLevel, is_finer: bool) -> RefinementLevel {
    let z = level.z();
    let mut five = RefinementLevel::FIVE.into_iter();
    if is_finer {
        five.find(|l| l.z() < z).unwrap_or(RefinementLevel::Finer2)
    } else {
        five.rfind(|l| l.z() > z)
            .unwrap_or(RefinementLevel::Coarser2)
    }
}
