//! Parsers of the values of images, in options and scene files: size, camera, colors.

use crate::numbers::numbers;
use incise_render::{Background, Color};

/// Width and height \[pixels\].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size(pub [u32; 2]);

/// Position of the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Viewpoint {
    /// Azimuth and elevation \[rad\].
    pub(super) angles: [f64; 2],
    /// Distance [diagonals of the scene].
    pub(super) distance: Option<f64>,
}

/// Parses a width and a height, such as 960x720.
///
/// # Errors
/// A message for the command line.
pub fn size(text: &str) -> Result<Size, String> {
    let side = |text: &str| text.trim().parse().ok().filter(|&side: &u32| side > 0);
    let sides = text.split_once(['x', 'X']);
    let sides = sides.and_then(|(width, height)| Some([side(width)?, side(height)?]));
    sides.map(Size).ok_or_else(|| {
        format!("'{text}' is not a size: expected width x height in pixels, such as 960x720")
    })
}

/// Parses an azimuth, an elevation and an optional distance.
pub(super) fn viewpoint(text: &str) -> Result<Viewpoint, String> {
    let (angles, distance) = match text.split(',').count() {
        3 => {
            let [azimuth, elevation, distance] = numbers::<3>(text)?.0;
            ([azimuth, elevation], Some(distance))
        }
        _ => (numbers::<2>(text)?.0, None),
    };
    if angles[1].abs() > 90.0 {
        return Err(format!(
            "an elevation of {} degrees: expected -90 to 90",
            angles[1]
        ));
    }
    if distance.is_some_and(|distance| distance <= 0.0) {
        return Err(String::from("the distance is not positive"));
    }
    Ok(Viewpoint {
        angles: angles.map(f64::to_radians),
        distance,
    })
}

/// Parses a color.
pub(super) fn color(text: &str) -> Result<Color, String> {
    text.trim().parse::<Color>().map_err(|e| e.to_string())
}

/// Parses one color or two.
pub(super) fn backdrop(text: &str) -> Result<Background, String> {
    Ok(match text.split_once(',') {
        None => Background::Plain(color(text)?),
        Some((top, bottom)) => Background::Gradient {
            top: color(top)?,
            bottom: color(bottom)?,
        },
    })
}

/// The values as text in scene files.
pub(super) mod parsed {
    use incise_render::{Background, Color};
    use serde::de::Error;
    use serde::{Deserialize, Deserializer};

    pub(in crate::picture) fn size<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<super::Size>, D::Error> {
        parse(deserializer, super::size)
    }

    pub(in crate::picture) fn viewpoint<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<super::Viewpoint>, D::Error> {
        parse(deserializer, super::viewpoint)
    }

    pub(in crate::picture) fn color<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<Color>, D::Error> {
        parse(deserializer, super::color)
    }

    pub(in crate::picture) fn backdrop<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<Background>, D::Error> {
        parse(deserializer, super::backdrop)
    }

    fn parse<'de, D: Deserializer<'de>, T>(
        deserializer: D,
        parse: fn(&str) -> Result<T, String>,
    ) -> Result<Option<T>, D::Error> {
        let text = String::deserialize(deserializer)?;
        parse(&text).map(Some).map_err(D::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_width_and_height() {
        assert_eq!(size("960x720"), Ok(Size([960, 720])));
        assert_eq!(size("1 X 2"), Ok(Size([1, 2])));
        for bad in [
            "",
            "960",
            "0x1",
            "1x0",
            "-1x1",
            "1x2x3",
            "1.5x2",
            "axb",
            "4294967296x1",
        ] {
            let error = size(bad).unwrap_err();
            assert!(error.contains("960x720"), "{error}");
        }
    }

    #[test]
    fn viewpoints_have_two_angles_and_an_optional_distance() {
        let turn = std::f64::consts::FRAC_PI_2;
        let [found, far] = ["90,-90", "-90, 0, 2.5"].map(|text| viewpoint(text).unwrap());
        assert_eq!((found.angles, found.distance), ([turn, -turn], None));
        assert_eq!((far.angles, far.distance), ([-turn, 0.0], Some(2.5)));
        for (bad, message) in [
            ("1", "expected 2"),
            ("1,2,3,4", "expected 2"),
            ("1,x", "'x', is not a number"),
            ("1,2,nan", "is not finite"),
            ("0,91", "-90 to 90"),
            ("0,0,0", "not positive"),
        ] {
            let error = viewpoint(bad).unwrap_err();
            assert!(error.contains(message), "{bad}: {error}");
        }
    }

    #[test]
    fn backgrounds_have_one_or_two_colors() {
        let (white, black) = (Color::rgb(255, 255, 255), Color::rgb(0, 0, 0));
        assert_eq!(backdrop("#fff"), Ok(Background::Plain(white)));
        let (top, bottom) = (white, black);
        assert_eq!(
            backdrop("fff, 000"),
            Ok(Background::Gradient { top, bottom })
        );
        for bad in ["", "#fff,", ",#fff", "#fff,#000,#fff", "white"] {
            assert!(backdrop(bad).is_err(), "{bad}");
        }
    }
}
