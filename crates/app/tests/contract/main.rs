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
mod output;
mod pieces;
mod scene_files;
mod sheets;
mod simulate;
mod simulate_bodies;
mod simulate_path;
