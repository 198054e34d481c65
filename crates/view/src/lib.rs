#![doc = include_str!("../README.md")]

mod command;
#[cfg(feature = "window")]
mod error;
pub mod keys;
mod pointer;
mod recording;
mod session;
#[cfg(feature = "window")]
mod window;

pub use command::{Command, Edge, Settings};
#[cfg(feature = "window")]
pub use error::ViewError;
pub use pointer::{Button, OrbitCamera, Pointer, Tool, slice_command};
pub use recording::{Entry, Recording, RecordingError, Replay, ReplayProgress};
pub use session::{BladeState, FrameReport, PickResult, Session, StatusMessage};
#[cfg(feature = "window")]
pub use window::{Save, WindowOptions, run};
