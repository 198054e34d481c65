//! The window: events in, pictures out.

mod act;
mod app;
mod events;
mod frames;
mod graph;
mod marks;
mod pace;
mod panel;
mod picture;
mod screen;

use crate::command::Settings;
use crate::error::ViewError;
use crate::pointer::{Eye, Pointer};
use crate::recording::{Recording, Replay};
use crate::session::Session;
use app::App;
use graph::Times;
use incise_mesh::Surface;
use incise_scene::BackendRequest;
use pace::Pace;
use picture::Picture;
use screen::Screen;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::event_loop::EventLoop;
use winit::window::Window;

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
    /// Whether time stands still at first.
    pub paused: bool,
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
    let events = EventLoop::new().map_err(|error| {
        // Before the reason stands where in the library it was found.
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
    pace: Pace,
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
