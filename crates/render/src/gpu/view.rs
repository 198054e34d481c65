//! How a picture is to look, apart from what is in it.

use crate::camera::Camera;
use crate::color::Color;

/// How a picture is to look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// From where.
    pub camera: Camera,
    /// What is behind everything.
    pub background: Background,
    /// Edges of triangles, if they are to be seen.
    pub wireframe: Option<Wireframe>,
    /// What makes shapes visible.
    pub light: Light,
}

impl View {
    /// The usual look, without edges.
    #[must_use]
    pub fn of(camera: Camera) -> Self {
        Self {
            camera,
            background: Background::default(),
            wireframe: None,
            light: Light::default(),
        }
    }
}

/// What is behind everything.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Background {
    /// One color.
    Plain(Color),
    /// From the upper to the lower edge.
    Gradient {
        /// At the upper edge.
        top: Color,
        /// At the lower edge.
        bottom: Color,
    },
}

impl Default for Background {
    /// A light neutral gray that gets darker to the bottom.
    fn default() -> Self {
        Self::Gradient {
            top: Color::rgb(248, 249, 250),
            bottom: Color::rgb(214, 218, 223),
        }
    }
}

/// Edges of triangles, drawn on them. Where triangles are only a few pixels large edges fade, or nothing but edges would
/// be left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wireframe {
    /// Their color; alpha says how strong they are.
    pub color: Color,
    /// Their width \[px\].
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

/// Light that goes with the camera, so that a body looks as well from everywhere: a key from one side, a weaker fill
/// from the other, and some from all around, more of it from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Toward the key light: right, up and back as the picture has it, of any length.
    pub direction: [f64; 3],
    /// The key's strength: how much of a white facet's light it gives where it falls straight on it.
    pub key: f32,
    /// The fill's strength.
    pub fill: f32,
    /// What comes from all around.
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
