#![cfg_attr(feature = "gpu", doc = include_str!("../README.md"))]
#![cfg_attr(
    not(feature = "gpu"),
    doc = "Cameras, colors, text and images of incise-render."
)]

mod animation;
mod camera;
mod color;
mod error;
mod figure_grid;
mod font;
#[cfg(feature = "gpu")]
mod gpu;
mod image;

pub use animation::write_animation;
pub use camera::{Camera, Ray};
pub use color::{Color, InvalidColor};
pub use error::RenderError;
pub use figure_grid::FigureGrid;
pub use font::{DEJAVU_SANS, Font, TextLine};
#[cfg(feature = "gpu")]
pub use gpu::{
    Attachments, Background, BodyView, DrawList, Light, Line, Offscreen, Overlay, OverlayTriangle,
    Renderer, View, Wireframe,
};
pub use image::Image;
