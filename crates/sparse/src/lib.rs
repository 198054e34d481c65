#![doc = include_str!("../README.md")]

mod cholesky;
mod lower_triangle;

pub use cholesky::{Cholesky, Columns, Scratch};
pub use lower_triangle::Entry;
