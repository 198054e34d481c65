//! Stepping on any device that wgpu reaches.

mod layout;
mod shaders;
