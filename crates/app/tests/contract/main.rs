//! Tests of the program without images.

mod bodies;
mod check;
#[path = "../common/mod.rs"]
mod common;
mod cut;
mod cut_options;
mod cut_path;
mod cut_several;
mod devices;
mod fill;
#[cfg(feature = "gpu")]
mod gallery;
mod output;
mod pieces;
#[cfg(feature = "gpu")]
mod render;
mod scene_files;
mod sheets;
mod simulate;
mod simulate_bodies;
#[cfg(feature = "gpu")]
mod simulate_output;
mod simulate_path;
