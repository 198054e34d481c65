#![doc = include_str!("../README.md")]

mod absorb;
mod body;
mod cell;
mod change;
mod content;
mod copies;
mod crossings;
mod divided;
mod embed;
mod error;
mod follow;
mod grid;
mod lattice;
mod lines;
#[cfg(feature = "serde")]
mod load;
mod measures;
mod nodes;
mod overlap;
#[cfg(feature = "serde")]
mod pairs;
mod params;
mod parents;
mod parts;
mod projection;
mod set;
mod thin;
mod work;

pub use change::{AddedCopy, AddedNode, LatticeChange, NodeSource, OldCopy};
#[cfg(feature = "serde")]
pub use error::InvalidLattice;
pub use error::LatticeError;
pub use grid::Grid;
pub use lattice::{Lattice, Moments, NO_COPY};
pub use params::LatticeParams;
