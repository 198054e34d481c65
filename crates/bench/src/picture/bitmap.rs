//! A backend of pixels. Lines and areas are plotters' own rasterizer's; letters are drawn from a font that is part of the
//! program, where plotters' own bitmaps ask for fonts of the system.

use incise_render::{Letters, RenderError};
use plotters::backend::DrawingBackend;
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingErrorKind,
};
use std::convert::Infallible;

/// A font's size over its em, as the SVG backend has it.
const SIZE_OVER_EM: f64 = 1.24;
/// From a text's anchor down to its baseline \[em\], as the SVG backend has it.
const TOP: f32 = 0.76;
const CENTER: f32 = 0.27;

/// Pixels by which a picture's own are drawn, along each side: text of nine of them is hard to read else.
pub(super) const FINE: u32 = 2;

/// A picture, whose pixels are [`FINE`] of the bitmap's wide.
pub(super) struct Bitmap<'a> {
    size: (u32, u32),
    canvas: Canvas<'a>,
    letters: Letters,
}

/// Pixels of three bytes each, row by row from above.
struct Canvas<'a> {
    size: (u32, u32),
    pixels: &'a mut [u8],
}

impl<'a> Bitmap<'a> {
    /// Draws a picture of that size onto pixels, three bytes each and [`FINE`] by [`FINE`] for each of the picture's.
    ///
    /// # Errors
    /// [`RenderError::Font`], which only a broken build has.
    pub(super) fn on(pixels: &'a mut [u8], size: (u32, u32)) -> Result<Self, RenderError> {
        Ok(Self {
            size,
            canvas: Canvas {
                size: (FINE * size.0, FINE * size.1),
                pixels,
            },
            letters: Letters::new()?,
        })
    }
}

/// A place of the picture in the bitmap.
fn fine((x, y): BackendCoord) -> BackendCoord {
    let fine = |x: i32| x.saturating_mul(FINE.cast_signed());
    (fine(x), fine(y))
}

/// A style with as wide lines as the bitmap's pixels are narrow.
struct Wide<'a, S>(&'a S);

impl<S: BackendStyle> BackendStyle for Wide<'_, S> {
    fn color(&self) -> BackendColor {
        self.0.color()
    }

    fn stroke_width(&self) -> u32 {
        FINE * self.0.stroke_width()
    }
}

impl Canvas<'_> {
    /// Mixes a color in; outside of the picture there is nothing to mix with.
    fn mix(&mut self, (x, y): BackendCoord, color: BackendColor, part: f64) {
        let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else {
            return;
        };
        if x >= self.size.0 || y >= self.size.1 {
            return;
        }
        let at = 3 * (y as usize * self.size.0 as usize + x as usize);
        let (r, g, b) = color.rgb;
        let part = (color.alpha * part).clamp(0.0, 1.0);
        for (old, new) in self.pixels[at..].iter_mut().zip([r, g, b]) {
            let mixed = f64::from(*old) * (1.0 - part) + f64::from(new) * part;
            *old = byte(mixed);
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a color between two others"
)]
fn byte(x: f64) -> u8 {
    x.round() as u8
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "a saturating cast of a place in a picture"
)]
fn pixel(x: f32) -> i32 {
    x as i32
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "the size of letters is a few pixels"
)]
fn em(size: f64) -> f32 {
    (size / SIZE_OVER_EM) as f32
}

type Done = Result<(), DrawingErrorKind<Infallible>>;

impl DrawingBackend for Canvas<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Done {
        Ok(())
    }

    fn present(&mut self) -> Done {
        Ok(())
    }

    fn draw_pixel(&mut self, at: BackendCoord, color: BackendColor) -> Done {
        self.mix(at, color, 1.0);
        Ok(())
    }
}

impl DrawingBackend for Bitmap<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Done {
        Ok(())
    }

    fn present(&mut self) -> Done {
        Ok(())
    }

    fn draw_pixel(&mut self, at: BackendCoord, color: BackendColor) -> Done {
        let (x, y) = fine(at);
        for k in 0..FINE * FINE {
            let at = (
                x.saturating_add_unsigned(k % FINE),
                y.saturating_add_unsigned(k / FINE),
            );
            self.canvas.mix(at, color, 1.0);
        }
        Ok(())
    }

    fn draw_line<S: BackendStyle>(&mut self, a: BackendCoord, b: BackendCoord, style: &S) -> Done {
        self.canvas.draw_line(fine(a), fine(b), &Wide(style))
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        a: BackendCoord,
        b: BackendCoord,
        style: &S,
        fill: bool,
    ) -> Done {
        self.canvas.draw_rect(fine(a), fine(b), &Wide(style), fill)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Done {
        (self.canvas).draw_path(path.into_iter().map(fine), &Wide(style))
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        center: BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Done {
        let center = fine(center);
        (self.canvas).draw_circle(center, FINE * radius, &Wide(style), fill)
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Done {
        let corners = corners.into_iter().map(fine);
        self.canvas.fill_polygon(corners, &Wide(style))
    }

    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, at: BackendCoord) -> Done {
        let at = fine(at);
        let em = em(style.size() * f64::from(FINE));
        let line = self.letters.line(text, em);
        let anchor = style.anchor();
        let left = match anchor.h_pos {
            HPos::Left => 0.0,
            HPos::Center => -line.width() / 2.0,
            HPos::Right => -line.width(),
        };
        let baseline = match anchor.v_pos {
            VPos::Top => TOP * em,
            VPos::Center => CENTER * em,
            VPos::Bottom => -CENTER * em,
        };
        let (transform, color) = (style.transform(), style.color());
        let corner = [left, baseline].map(|x| pixel(x.round()));
        let canvas = &mut self.canvas;
        line.draw(|[x, y], covered| {
            let [x, y] = [corner[0].saturating_add(x), corner[1].saturating_add(y)];
            let (x, y) = transform.transform(x, y);
            canvas.mix((at.0 + x, at.1 + y), color, f64::from(covered));
        });
        Ok(())
    }
}
