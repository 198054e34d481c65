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
//! How `examples/picture.rs` begins:
//!
#![cfg_attr(feature = "gpu", doc = "```no_run")]
#![cfg_attr(not(feature = "gpu"), doc = "```ignore")]
//! use incise_mesh::{Model, build_model};
//! use incise_render::{BodyView, Camera, Color, Content, Offscreen, Overlay, Renderer, Sheet, View};
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let (device, queue) = device()?; // of wgpu
//!     let renderer = Renderer::offscreen(&device, &queue)?;
//!     let rabbit = build_model(Model::Bunny);
//!     let body = BodyView::of(&renderer, &rabbit, |_| Some(Color::rgb(154, 174, 198)))?;
//!     let sheet = Sheet {
//!         corners: [[0.0, -0.5, -0.5], [0.0, -0.5, 0.7], [0.0, 0.9, 0.0]],
//!         color: Color::rgb(60, 120, 200).with_alpha(90),
//!     };
//!     let overlay = Overlay::new(&renderer, &[sheet], &[])?;
//!     // and on
//! # Ok(())
//! }
//! # fn device() -> Result<(wgpu::Device, wgpu::Queue), Box<dyn std::error::Error>> {
//! #     unreachable!("this is not run")
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
