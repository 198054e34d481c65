#![doc = include_str!("../README.md")]

mod blade_position;
mod cutter;
mod error;
mod exact;
mod incision;
mod interpolate;
mod intersection;
mod outcome;
mod paper;
mod params;
mod separate;
mod sweep;

pub use blade_position::blade_starts_inside;
pub use cutter::Cutter;
#[cfg(feature = "serde")]
pub use cutter::SavedCutter;
pub use error::CutError;
pub use incision::Incision;
#[cfg(feature = "serde")]
pub use incision::SavedIncision;
pub use outcome::{CutOutcome, CutReport};
pub use params::{Caps, CutMethod, CutParams, ExactParams, PaperParams};
pub use sweep::Sweep;
