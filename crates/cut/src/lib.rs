#![doc = include_str!("../README.md")]

mod affine;
mod blade_position;
mod cap_marker;
mod curves;
mod cutter;
mod error;
mod exact;
mod incision;
mod intersection;
mod outcome;
mod params;
mod search;
mod separate;
mod sizing;
mod stroke;
mod sweep;

pub use blade_position::blade_starts_inside;
pub use cap_marker::CapMarker;
pub use curves::{Curve, CurvePoint, Curves, EdgeCrossing};
pub use cutter::Cutter;
pub use error::CutError;
pub use incision::{Incision, IncisionState};
pub use outcome::{CutOutcome, CutReport};
pub use params::{Caps, CutParams};
pub use stroke::{Stroke, StrokeError};
pub use sweep::Sweep;
