//! The exported functions, one module for each object. See the README for what holds for all.

pub mod bodies;
pub mod check;
pub mod cut;
pub mod cut_result;
pub mod mesh;
pub mod parameters;
pub mod scene;
