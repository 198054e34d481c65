//! View settings of an image: camera, background, wireframe and light.

use crate::camera::Camera;
use crate::color::Color;

/// Camera, background, wireframe and light of an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Camera.
    pub camera: Camera,
    /// Background.
    pub background: Background,
    /// Wireframe over the bodies, if any.
    pub wireframe: Option<Wireframe>,
    /// Light.
    pub light: Light,
}

impl View {
    /// Returns default background and light for a camera, without wireframe.
    #[must_use]
    pub fn from_camera(camera: Camera) -> Self {
        Self {
            camera,
            background: Background::default(),
            wireframe: None,
            light: Light::default(),
        }
    }
}

/// The background of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Background {
    /// One color.
    Plain(Color),
    /// Vertical gradient.
    Gradient {
        /// Color at the upper edge.
        top: Color,
        /// Color at the lower edge.
        bottom: Color,
    },
}

impl Default for Background {
    /// Returns a light gray gradient that darkens toward the bottom.
    fn default() -> Self {
        Self::Gradient {
            top: Color::rgb(248, 249, 250),
            bottom: Color::rgb(214, 218, 223),
        }
    }
}

/// Style of triangle edges. Edges of triangles of a few pixels fade out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wireframe {
    /// Color; alpha is the opacity.
    pub color: Color,
    /// Width \[px\].
    pub width: f32,
}

impl Default for Wireframe {
    fn default() -> Self {
        Self {
            color: Color::rgb(24, 30, 38).with_alpha(190),
            width: 1.1,
        }
    }
}

/// A light rig that moves with the camera: key light, weaker fill light, and ambient light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Direction toward the key light in image axes (right, up, back), of any length.
    pub direction: [f64; 3],
    /// Strength of the key light: its share of a white facet's brightness at normal incidence.
    pub key: f32,
    /// Strength of the fill light.
    pub fill: f32,
    /// Strength of the ambient light.
    pub ambient: f32,
}

impl Default for Light {
    fn default() -> Self {
        Self {
            direction: [-0.45, 0.65, 0.75],
            key: 0.86,
            fill: 0.17,
            ambient: 0.25,
        }
    }
}
