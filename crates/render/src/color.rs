//! sRGB colors: parsing, formatting and conversion to linear light.

use std::fmt;
use std::str::FromStr;

/// An sRGB color with 8 bits per channel and straight (not premultiplied) alpha.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Color(pub [u8; 4]);

/// The text is not a color.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("not a color; write #rgb, #rrggbb or #rrggbbaa in hexadecimal digits")]
pub struct InvalidColor;

/// Colors that are distinct from each other and from the red of cut sections.
const PIECES: [Color; 8] = [
    Color::rgb(124, 156, 196),
    Color::rgb(226, 184, 92),
    Color::rgb(126, 176, 140),
    Color::rgb(174, 146, 194),
    Color::rgb(104, 180, 188),
    Color::rgb(202, 166, 134),
    Color::rgb(158, 166, 176),
    Color::rgb(216, 166, 190),
];

impl Color {
    /// Returns an opaque color.
    #[must_use]
    pub const fn rgb(red: u8, green: u8, blue: u8) -> Self {
        Self([red, green, blue, 255])
    }

    /// Returns this color with another alpha.
    #[must_use]
    pub const fn with_alpha(self, alpha: u8) -> Self {
        let [red, green, blue, _] = self.0;
        Self([red, green, blue, alpha])
    }

    /// Returns the color of a piece by its index; the eight colors repeat.
    #[must_use]
    pub const fn for_piece(piece: usize) -> Self {
        PIECES[piece % PIECES.len()]
    }

    /// Returns the color in linear light, 0 to 1, with alpha unchanged.
    #[must_use]
    pub fn linear(self) -> [f32; 4] {
        let [red, green, blue, alpha] = self.0.map(|c| f32::from(c) / 255.0);
        let linear = |c: f32| {
            if c <= 0.04045 {
                c / 12.92
            } else {
                ((c + 0.055) / 1.055).powf(2.4)
            }
        };
        [linear(red), linear(green), linear(blue), alpha]
    }
}

impl FromStr for Color {
    type Err = InvalidColor;

    fn from_str(text: &str) -> Result<Self, InvalidColor> {
        let digits = text.strip_prefix('#').unwrap_or(text);
        let digit = |c: char| c.to_digit(16).and_then(|d| u8::try_from(d).ok());
        let digits: Option<Vec<u8>> = digits.chars().map(digit).collect();
        match *digits.as_deref().ok_or(InvalidColor)? {
            [r, g, b] => Ok(Self::rgb(17 * r, 17 * g, 17 * b)),
            [r, s, g, h, b, c] => Ok(Self::rgb(16 * r + s, 16 * g + h, 16 * b + c)),
            [r, s, g, h, b, c, a, d] => {
                Ok(Self::rgb(16 * r + s, 16 * g + h, 16 * b + c).with_alpha(16 * a + d))
            }
            _ => Err(InvalidColor),
        }
    }
}

impl fmt::Display for Color {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b, a] = self.0;
        write!(f, "#{r:02x}{g:02x}{b:02x}")?;
        if a == 255 {
            return Ok(());
        }
        write!(f, "{a:02x}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parsing_and_formatting_round_trip() {
        let color = Color([1, 35, 69, 255]);
        assert_eq!("#012345".parse(), Ok(color));
        assert_eq!(color.to_string(), "#012345");
        assert_eq!("01234567".parse(), Ok(color.with_alpha(0x67)));
        assert_eq!(color.with_alpha(0x67).to_string(), "#01234567");
        assert_eq!("#f80".parse(), Ok(Color::rgb(255, 136, 0)));
        for bad in [
            "", "#", "red", "#12", "#1234", "#12345", "#12345g", "#é23456", "##123",
        ] {
            assert_eq!(bad.parse::<Color>(), Err(InvalidColor), "{bad}");
        }
    }

    #[test]
    fn linear_light_increases_from_zero_to_one() {
        let light = |c| Color::rgb(c, c, c).linear()[0];
        assert_eq!((light(0), light(255)), (0.0, 1.0));
        assert!((1..=255).all(|c| light(c) > light(c - 1)));
        // Middle gray reflects about a fifth.
        assert!((light(118) - 0.18).abs() < 2e-3, "{}", light(118));
    }
}
