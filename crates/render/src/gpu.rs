//! Rendering with wgpu: pipelines, bodies, overlays and render targets.

mod attachments;
mod body;
mod error_scope;
mod offscreen;
mod overlay;
mod pipelines;
mod renderer;
mod shaders;
mod uniforms;
mod view;

pub use attachments::Attachments;
pub use body::BodyView;
pub use offscreen::Offscreen;
pub use overlay::{Line, Overlay, OverlayTriangle};
pub use renderer::{DrawList, Renderer};
pub use view::{Background, Light, View, Wireframe};
