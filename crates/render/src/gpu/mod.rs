//! What draws, on any device that wgpu reaches.

mod body;
mod canvas;
mod offscreen;
mod overlay;
mod pipelines;
mod renderer;
mod scope;
mod shaders;
mod uniforms;
mod view;

pub use body::BodyView;
pub use canvas::Canvas;
pub use offscreen::Offscreen;
pub use overlay::{Line, Overlay, Sheet};
pub use renderer::{Content, Renderer};
pub use view::{Background, Light, View, Wireframe};
