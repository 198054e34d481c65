//! Pictures of triangle surfaces, offscreen or in a window, on any device that wgpu reaches.
//!
//! - [`Camera`]: where the eye is, what it frames, and the ray through a pixel.
//! - [`Color`] and [`Picture`]: pixels on the host, which are put together and written as PNG.
//! - [`Letters`]: text, in a font that is part of the program. [`Panels`]: pictures with labels, in rows.
//! - [`Renderer`]: the pipelines of a device. It draws [`BodyView`]s, which follow a surface or use a solver's
//!   positions in place, and [`Overlay`]s of translucent sheets and lines.
//! - [`Offscreen`]: a texture to draw on, and the way back to the host.
//!
//! Facets are flat: the normal is that of the triangle's three positions as the device has them, so a body that
//! moves there is drawn without a trip through the host. What draws is behind the feature `gpu`, which is on by
//! default.
//!
#![cfg_attr(feature = "gpu", doc = "```no_run")]
#![cfg_attr(not(feature = "gpu"), doc = "```ignore")]
//! use incise_mesh::{Model, build_model};
//! use incise_render::{BodyView, Camera, Color, Content, Offscreen, Renderer, View};
//!
//! # fn show(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<(), incise_render::RenderError> {
//! let bunny = build_model(Model::Bunny);
//! let renderer = Renderer::offscreen(device, queue)?;
//! let body = BodyView::of(&renderer, &bunny, |_| Some(Color::rgb(170, 185, 200)))?;
//! let camera = Camera::default().fit(&bunny.bounds(), 4.0 / 3.0);
//! let content = Content { bodies: &[&body], overlays: &[] };
//! let picture = Offscreen::new(&renderer, 800, 600)?.picture(&renderer, &View::of(camera), &content)?;
//! picture.write_png("bunny.png".as_ref())?;
//! # Ok(())
//! # }
//! ```

mod camera;
mod color;
mod error;
#[cfg(feature = "gpu")]
mod gpu;
mod letters;
mod panels;
mod picture;

pub use camera::{Camera, Ray};
pub use color::{Color, InvalidColor};
pub use error::RenderError;
#[cfg(feature = "gpu")]
pub use gpu::{
    Background, BodyView, Canvas, Content, Light, Line, Offscreen, Overlay, Renderer, Sheet, View,
    Wireframe,
};
pub use letters::{LetterLine, Letters};
pub use panels::Panels;
pub use picture::Picture;
