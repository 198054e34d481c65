#![doc = include_str!("../README.md")]

mod cut;
mod error;
mod params;
mod patch;
mod table;

pub use cut::{PaperOutcome, cut};
pub use error::PaperError;
pub use params::PaperParams;
pub use patch::{Patch, RefineReport, fill, mean_rim_length, refine, triangulate};
pub use table::{PublishedRow, TABLE_1};
