//! The window: options, state and the entry point `run`.

mod actions;
mod annotations;
mod app;
mod events;
mod frame_loop;
mod frame_times;
mod panel;
mod playback_speed;
mod scene_view;
mod window_renderer;

use crate::command::Settings;
use crate::error::ViewError;
use crate::pointer::{OrbitCamera, Pointer};
use crate::recording::{Recording, Replay};
use crate::session::Session;
use app::App;
use frame_times::FrameTimes;
use incise_cut::Caps;
use incise_mesh::Surface;
use incise_scene::BackendRequest;
use playback_speed::PlaybackSpeed;
use scene_view::SceneView;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use window_renderer::WindowRenderer;
use winit::event_loop::EventLoop;
use winit::window::Window;

/// A function that saves the pieces of a surface and returns a message for the user.
pub type Save = Box<dyn FnMut(&Surface) -> Result<String, Box<dyn std::error::Error>>>;

/// Options of the window.
pub struct WindowOptions {
    /// Title of the window.
    pub title: String,
    /// Initial surface of the body.
    pub surface: Surface,
    /// Simulation backend; a named adapter also renders.
    pub backend: BackendRequest,
    /// Width and height \[px\].
    pub size: [u32; 2],
    /// Starts with the simulation paused.
    pub paused: bool,
    /// Curves along which caps close cuts; a recording to replay has its own.
    pub caps: Caps,
    /// Recording to replay.
    pub replay: Option<Recording>,
    /// File for saved recordings.
    pub record_to: PathBuf,
    /// Function that saves the pieces.
    pub save: Save,
}

impl std::fmt::Debug for WindowOptions {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("WindowOptions")
            .field("title", &self.title)
            .field("backend", &self.backend)
            .field("size", &self.size)
            .field("record_to", &self.record_to)
            .finish_non_exhaustive()
    }
}

/// Display options that keys and the panel toggle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct DisplayOptions {
    wireframe: bool,
    pieces: bool,
    caps: bool,
    batches: bool,
    panel: bool,
    help: bool,
}

impl Default for DisplayOptions {
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

/// Opens a window and runs until it is closed.
///
/// # Errors
/// [`ViewError`]: no display, no adapter for windows, a body that cannot be simulated, or a GPU
/// failure.
pub fn run(options: WindowOptions) -> Result<(), ViewError> {
    let replay = options.replay.clone();
    let mut chosen = Settings::for_surface(&options.surface);
    chosen.scene.cut.caps = options.caps;
    let settings = replay.as_ref().map_or(chosen, Recording::settings);
    let replay = replay.map(|r| r.replay(&options.surface)).transpose()?;
    let events = EventLoop::new().map_err(|error| {
        // The reason follows the library's location of the error.
        let message = error.to_string();
        let message = message.rsplit(": ").next().unwrap_or_default().to_owned();
        ViewError::NoDisplay { message }
    })?;
    let mut app = App::new(options, settings, replay);
    let ended = events.run_app(&mut app);
    app.outcome()?;
    ended.map_err(|error| ViewError::Window {
        message: error.to_string(),
    })
}

/// The state of an open window.
struct OpenWindow {
    window: Arc<Window>,
    renderer: WindowRenderer,
    scene_view: SceneView,
    egui: egui_winit::State,
    session: Session,
    orbit: OrbitCamera,
    pointer: Pointer,
    shift: bool,
    display: DisplayOptions,
    times: FrameTimes,
    /// Name of the rendering adapter, for the panel.
    adapter: String,
    paused: bool,
    speed: PlaybackSpeed,
    replay: Option<Replay>,
    /// Start of the last redraw.
    last_redraw: Instant,
    /// Time that is not simulated yet.
    accumulator: Duration,
    /// Message of the window, and true for an error.
    message: Option<(String, bool)>,
    record_to: PathBuf,
    save: Save,
    is_closing: bool,
}
