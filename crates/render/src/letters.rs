//! Letters of a font that is part of the program: a system may have none.

use crate::error::RenderError;
use ab_glyph::{Font, FontRef, Glyph, PxScale, ScaleFont, point};

const FONT: &[u8] = include_bytes!("../fonts/DejaVuSans-ascii.ttf");

/// A sans-serif font: the characters of ASCII, the degree sign, the middle dot, the times sign and the minus sign.
#[derive(Debug, Clone)]
pub struct Letters {
    font: FontRef<'static>,
    /// From the deepest to the highest line of the font \[em\].
    height: f32,
}

/// A line of text, each letter in its place.
#[derive(Debug, Clone)]
pub struct LetterLine<'a> {
    letters: &'a Letters,
    glyphs: Vec<Glyph>,
    scale: PxScale,
    width: f32,
}

impl Letters {
    /// The letters.
    ///
    /// # Errors
    /// [`RenderError::Font`], which only a broken build has.
    pub fn new() -> Result<Self, RenderError> {
        let font = FontRef::try_from_slice(FONT).map_err(|_| RenderError::Font)?;
        let height = font.height_unscaled() / font.units_per_em().unwrap_or(1.0);
        Ok(Self { font, height })
    }

    /// A line of text in letters of this size \[px an em\].
    #[must_use]
    pub fn line(&self, text: &str, em: f32) -> LetterLine<'_> {
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
        LetterLine {
            letters: self,
            glyphs,
            scale,
            width: caret,
        }
    }
}

impl LetterLine<'_> {
    /// How long the line is \[px\].
    #[must_use]
    pub const fn width(&self) -> f32 {
        self.width
    }

    /// Offers all pixels of the letters, rightward and downward from where the line begins on its baseline, and how much
    /// of each is covered, 0 to 1.
    pub fn draw(&self, mut put: impl FnMut([i32; 2], f32)) {
        let font = self.letters.font.as_scaled(self.scale);
        for glyph in &self.glyphs {
            let Some(outline) = font.outline_glyph(glyph.clone()) else {
                continue;
            };
            let corner = outline.px_bounds().min;
            let [left, top] = [corner.x, corner.y].map(pixel);
            outline.draw(|x, y, covered| {
                let at = [
                    left.saturating_add_unsigned(x),
                    top.saturating_add_unsigned(y),
                ];
                put(at, covered);
            });
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "a saturating cast of a place in a picture"
)]
fn pixel(x: f32) -> i32 {
    x as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Left, top, right and bottom of all that is covered by half.
    fn extent(text: &str, em: f32) -> Option<[i32; 4]> {
        let letters = Letters::new().unwrap();
        let mut found: Option<[i32; 4]> = None;
        letters.line(text, em).draw(|[x, y], covered| {
            if covered >= 0.5 {
                let [a, b, c, d] = found.unwrap_or([x, y, x, y]);
                found = Some([a.min(x), b.min(y), c.max(x), d.max(y)]);
            }
        });
        found
    }

    #[test]
    fn letters_stand_on_their_line_and_are_as_large_as_asked() {
        let [left, top, right, bottom] = extent("HIH", 40.0).unwrap();
        assert_eq!(bottom, -1, "nothing is below the line");
        // Capitals of this font are 0.73 em high.
        assert!((top + 29).abs() <= 1, "{top}");
        let width = Letters::new().unwrap().line("HIH", 40.0).width();
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
