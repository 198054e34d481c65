#![doc = include_str!("../README.md")]

mod absorb;
mod error;
mod fragments;
mod grid;
mod lattice;
mod overlap;
mod params;
mod parts;
mod scan;
mod skin;

pub use error::LatticeError;
pub use grid::Grid;
pub use lattice::{Lattice, Moments, NO_COPY};
pub use params::LatticeParams;
