//! A window to cut, pull and watch soft bodies in.
//!
//! - [`Session`]: a body, a blade and what is done to them, as [`Command`]s. It knows no window.
//! - [`Recording`]: the commands with their frames, written as lines of JSON, and [`Replay`].
//! - [`Pointer`] and [`Eye`]: what gestures mean, and from where the body is seen.
//! - [`keys`]: the keyboard.
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
