//! A window to cut, pull and watch soft bodies in.
//!
//! - [`Session`]: a body, a blade and what is done to them, as [`Command`]s. It knows no window.
//! - [`Recording`]: the commands with their frames, written as lines of JSON, and [`Replay`].
//! - [`Pointer`] and [`Eye`]: what gestures mean, and from where the body is seen.
//! - [`keys`]: the keyboard.
//!
//! How `examples/recorded_slice.rs` begins:
//!
//! ```
//! use incise_mesh::{Model, build_model};
//! use incise_scene::{Scene, SceneParams};
//! use incise_view::{Command, Progress, Session};
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let ball = build_model(Model::Sphere768);
//!     let mut session = Session::new(ball.clone(), Scene::new(SceneParams::default()))?;
//!     let from = [[-2.0, 0.0, -2.0], [-2.0, 0.0, 2.0]]; // a blade's edge, left of the ball
//!     let to = from.map(|[x, _, z]| [-x, 0.2, z]); // and right of it
//!     session.apply(Command::Slice { from, to });
//!     (0..60).for_each(|_| session.frame());
//!     // and on
//! # Ok(())
//! }
//! ```
//!
//! The window is behind the feature `window`, which is on by default.

mod command;
#[cfg(feature = "window")]
mod error;
pub mod keys;
mod pointer;
mod recording;
mod session;
#[cfg(feature = "window")]
mod window;

pub use command::{Command, Edge, Method, Settings};
#[cfg(feature = "window")]
pub use error::ViewError;
pub use pointer::{Button, Eye, Pointer, Tool, slice};
pub use recording::{Entry, Progress, Recording, RecordingError, Replay};
pub use session::{BladePlace, Frame, Notice, Picked, Session};
#[cfg(feature = "window")]
pub use window::{Options, Save, run};
