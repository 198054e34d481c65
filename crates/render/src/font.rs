//! Text layout and rasterization in an embedded font, for systems without fonts.

use crate::error::RenderError;
use ab_glyph::{Font as _, FontRef, Glyph, PxScale, ScaleFont, point};

/// The bytes of the embedded font, `DejaVu Sans` reduced to printable ASCII and a few signs.
pub const DEJAVU_SANS: &[u8] = include_bytes!("../fonts/DejaVuSans-ascii.ttf");

/// The embedded sans-serif font: printable ASCII, degree, middle dot, times and minus signs.
#[derive(Debug, Clone)]
pub struct Font {
    font: FontRef<'static>,
    /// Distance from the descender to the ascender \[em\].
    height: f32,
}

/// A line of text with positioned glyphs.
#[derive(Debug, Clone)]
pub struct TextLine<'a> {
    font: &'a Font,
    glyphs: Vec<Glyph>,
    scale: PxScale,
    width: f32,
}

impl Font {
    /// Loads the embedded font.
    ///
    /// # Errors
    /// [`RenderError::InvalidFont`] in a broken build.
    pub fn new() -> Result<Self, RenderError> {
        let font = FontRef::try_from_slice(DEJAVU_SANS).map_err(|_| RenderError::InvalidFont)?;
        let height = font.height_unscaled() / font.units_per_em().unwrap_or(1.0);
        Ok(Self { font, height })
    }

    /// Lays out a line of text at font size `em` \[px\].
    #[must_use]
    pub fn line(&self, text: &str, em: f32) -> TextLine<'_> {
        let scale = PxScale::from(em * self.height);
        let font = self.font.as_scaled(scale);
        let (mut glyphs, mut caret, mut last) = (Vec::new(), 0.0, None);
        for letter in text.chars() {
            let mut glyph = font.scaled_glyph(letter);
            caret += last.map_or(0.0, |last| font.kern(last, glyph.id));
            glyph.position = point(caret, 0.0);
            caret += font.h_advance(glyph.id);
            last = Some(glyph.id);
            glyphs.push(glyph);
        }
        TextLine {
            font: self,
            glyphs,
            scale,
            width: caret,
        }
    }
}

impl TextLine<'_> {
    /// Returns the width of the line \[px\].
    #[must_use]
    pub const fn width(&self) -> f32 {
        self.width
    }

    /// Calls `put` with the position and coverage (0 to 1) of every pixel of the text.
    ///
    /// Positions are right and down from the start of the baseline \[px\].
    pub fn draw(&self, mut put: impl FnMut([i32; 2], f32)) {
        let font = self.font.font.as_scaled(self.scale);
        for glyph in &self.glyphs {
            let Some(outline) = font.outline_glyph(glyph.clone()) else {
                continue;
            };
            let corner = outline.px_bounds().min;
            let [left, top] = [corner.x, corner.y].map(pixel);
            outline.draw(|x, y, coverage| {
                let at = [
                    left.saturating_add_unsigned(x),
                    top.saturating_add_unsigned(y),
                ];
                put(at, coverage);
            });
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "a saturating cast of a pixel coordinate"
)]
fn pixel(x: f32) -> i32 {
    x as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns left, top, right and bottom of the pixels with a coverage of at least one half.
    fn extent(text: &str, em: f32) -> Option<[i32; 4]> {
        let font = Font::new().unwrap();
        let mut found: Option<[i32; 4]> = None;
        font.line(text, em).draw(|[x, y], coverage| {
            if coverage >= 0.5 {
                let [a, b, c, d] = found.unwrap_or([x, y, x, y]);
                found = Some([a.min(x), b.min(y), c.max(x), d.max(y)]);
            }
        });
        found
    }

    #[test]
    fn glyphs_have_the_requested_size_and_baseline() {
        let [left, top, right, bottom] = extent("HIH", 40.0).unwrap();
        assert_eq!(bottom, -1, "nothing is below the line");
        // Capitals of this font are 0.73 em high.
        assert!((top + 29).abs() <= 1, "{top}");
        let width = Font::new().unwrap().line("HIH", 40.0).width();
        assert!(
            left >= 0 && (right as f32) < width,
            "{left} {right} {width}"
        );
        let deep = extent("gap", 40.0).unwrap()[3];
        assert!(deep > 5, "{deep}");
        assert_eq!(extent(" ", 40.0), None);
        assert_eq!(extent("", 40.0), None);
    }
}
