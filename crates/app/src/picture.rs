//! [`PictureOptions`]: appearance of images, as options and as keys of scene files.

mod values;

use incise_mesh::Aabb;
use incise_render::{Background, Camera, Color, View, Wireframe};
use serde::Deserialize;
pub use values::{Size, size};
use values::{Viewpoint, backdrop, color, parsed, viewpoint};

/// Appearance of an image.
#[derive(Debug, Clone, Default, clap::Args, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct PictureOptions {
    /// Size of the image [pixels]. [default: 960x720]
    #[arg(long, value_name = "WxH", value_parser = size)]
    #[serde(deserialize_with = "parsed::size")]
    size: Option<Size>,
    /// Position of the camera: azimuth around the y axis (0 on positive z, 90 on positive x) and
    /// elevation [degrees], and distance [diagonals of the scene]. Without a distance the scene
    /// fills the image.
    #[arg(
        long,
        value_name = "AZIMUTH,ELEVATION[,DISTANCE]",
        value_parser = viewpoint,
        allow_hyphen_values = true
    )]
    #[serde(deserialize_with = "parsed::viewpoint")]
    camera: Option<Viewpoint>,
    /// Draw the edges of triangles.
    #[arg(long)]
    wireframe: bool,
    /// The color of the surface, as #rrggbb. [default: #9aaec6]
    #[arg(long, value_name = "COLOR", value_parser = color)]
    #[serde(deserialize_with = "parsed::color")]
    color: Option<Color>,
    /// The color of caps. [default: #de5c42]
    #[arg(long, value_name = "COLOR", value_parser = color)]
    #[serde(deserialize_with = "parsed::color")]
    cap_color: Option<Color>,
    /// Color each piece differently; caps keep their color.
    #[arg(long)]
    color_pieces: bool,
    /// Background: one color, or the colors of the upper and the lower edge.
    #[arg(long, value_name = "COLOR[,COLOR]", value_parser = backdrop)]
    #[serde(deserialize_with = "parsed::backdrop")]
    background: Option<Background>,
}

/// Default color of surfaces.
const BODY: Color = Color::rgb(154, 174, 198);
/// Default color of caps.
const CAP: Color = Color::rgb(222, 92, 66);

impl PictureOptions {
    /// Adds the options of `other` in place of missing ones.
    pub(crate) fn or(self, other: Self) -> Self {
        Self {
            size: self.size.or(other.size),
            camera: self.camera.or(other.camera),
            wireframe: self.wireframe || other.wireframe,
            color: self.color.or(other.color),
            cap_color: self.cap_color.or(other.cap_color),
            color_pieces: self.color_pieces || other.color_pieces,
            background: self.background.or(other.background),
        }
    }

    /// Returns width and height [pixels].
    pub(crate) fn size(&self) -> [u32; 2] {
        self.size.map_or([960, 720], |Size(pixels)| pixels)
    }

    /// Returns the color of a triangle of a piece.
    pub(crate) fn triangle_color(&self, is_cap: bool, piece: usize) -> Color {
        match (is_cap, self.color_pieces) {
            (true, _) => self.cap_color.unwrap_or(CAP),
            (false, true) => Color::for_piece(piece),
            (false, false) => self.color.unwrap_or(BODY),
        }
    }

    /// Returns the view of points \[m\], which are all in the image unless the camera has a
    /// distance.
    pub(crate) fn view<I: Iterator<Item = [f32; 3]>>(&self, points: impl Fn() -> I) -> View {
        View {
            background: self.background.unwrap_or_default(),
            wireframe: self.wireframe.then(Wireframe::default),
            ..View::from_camera(self.camera(points))
        }
    }

    fn camera<I: Iterator<Item = [f32; 3]>>(&self, points: impl Fn() -> I) -> Camera {
        let [width, height] = self.size().map(f64::from);
        let aspect = width / height;
        let Some(Viewpoint { angles, distance }) = self.camera else {
            return Camera::default().frame(points(), aspect);
        };
        let [azimuth, elevation] = angles;
        let camera = Camera::from_angles(azimuth, elevation);
        match distance {
            None => camera.frame(points(), aspect),
            Some(distance) => {
                let bounds = Aabb::around(points());
                Camera {
                    distance: distance * bounds.diagonal(),
                    ..camera.fit(&bounds, aspect)
                }
            }
        }
    }
}
