//! Pictures as files: every one as SVG, and as PNG beside it for what shows no SVG.

mod bitmap;

use crate::output::{OutputError, OutputFile};
use bitmap::{Bitmap, FINE};
use plotters::backend::{DrawingBackend, SVGBackend};
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::style::WHITE;
use std::path::Path;

/// The font of all text in pictures: the reader's own in an SVG, that of the program in a PNG.
pub(crate) const FONT: &str = "sans-serif";

/// Why a picture cannot be drawn.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PictureError {
    /// A chart does not come about.
    #[error("a picture cannot be drawn: {0}; the rows are unharmed")]
    Chart(String),
    /// Pixels cannot be packed.
    #[error("a picture cannot be packed: {0}; the rows are unharmed")]
    Png(#[from] png::EncodingError),
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// What a backend says when it cannot draw.
pub(crate) type Fault<B> = DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>;

/// Something to draw, on any backend.
pub(crate) trait Picture {
    /// Width and height \[px\].
    const SIZE: (u32, u32);

    /// Draws on a white area of that size.
    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), Fault<B>>
    where
        B::ErrorType: 'static;
}

/// Where a picture goes.
#[derive(Debug)]
pub(crate) struct PictureFile {
    svg: OutputFile,
    png: OutputFile,
}

impl PictureFile {
    /// Opens both files before there is anything to draw; they end with `svg` and `png`, whatever the path does.
    ///
    /// # Errors
    /// As [`OutputFile::open`].
    pub(crate) fn open(path: &Path) -> Result<Self, OutputError> {
        Ok(Self {
            svg: OutputFile::open(&path.with_extension("svg"))?,
            png: OutputFile::open(&path.with_extension("png"))?,
        })
    }

    /// Draws, in the place of what was there.
    ///
    /// # Errors
    /// [`PictureError`].
    pub(crate) fn draw(&mut self, picture: &impl Picture) -> Result<(), PictureError> {
        self.svg.write(svg(picture)?)?;
        Ok(self.png.write(png(picture)?)?)
    }
}

/// A picture as lines and letters.
pub(crate) fn svg<P: Picture>(picture: &P) -> Result<String, PictureError> {
    let mut text = String::new();
    draw(SVGBackend::with_string(&mut text, P::SIZE), picture)?;
    Ok(text)
}

/// A picture as a file of pixels.
fn png<P: Picture>(picture: &P) -> Result<Vec<u8>, PictureError> {
    let (width, height) = (FINE * P::SIZE.0, FINE * P::SIZE.1);
    let mut pixels = vec![0; 3 * width as usize * height as usize];
    let bitmap = Bitmap::on(&mut pixels, P::SIZE);
    let bitmap = bitmap.map_err(|fault| PictureError::Chart(fault.to_string()))?;
    draw(bitmap, picture)?;
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels)?;
    writer.finish()?;
    Ok(file)
}

fn draw<B: DrawingBackend>(backend: B, picture: &impl Picture) -> Result<(), PictureError>
where
    B::ErrorType: 'static,
{
    let failed = |fault: Fault<B>| PictureError::Chart(fault.to_string());
    let root = backend.into_drawing_area();
    root.fill(&WHITE).map_err(failed)?;
    picture.draw(&root).map_err(failed)?;
    root.present().map_err(failed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotters::element::{Rectangle, Text};
    use plotters::style::{Color, IntoFont, RGBColor};

    /// A red square, and a text to the right of it.
    struct Sign;

    impl Picture for Sign {
        const SIZE: (u32, u32) = (60, 20);

        fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), Fault<B>>
        where
            B::ErrorType: 'static,
        {
            let red = RGBColor(255, 0, 0);
            area.draw(&Rectangle::new([(0, 0), (9, 19)], red.filled()))?;
            area.draw(&Text::new("HIH", (14, 4), (FONT, 14).into_font()))
        }
    }

    #[test]
    fn both_files_show_the_same() {
        let place = tempfile::tempdir().unwrap();
        let mut file = PictureFile::open(&place.path().join("sign.png")).unwrap();
        file.draw(&Sign).unwrap();
        let svg = std::fs::read_to_string(place.path().join("sign.svg")).unwrap();
        assert!(svg.contains("HIH") && svg.contains("#FF0000"), "{svg}");
        let png = std::fs::File::open(place.path().join("sign.png")).unwrap();
        let mut reader = png::Decoder::new(std::io::BufReader::new(png))
            .read_info()
            .unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let shape = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((shape.width, shape.height), (120, 40));
        let at = |x: usize, y: usize| &pixels[3 * (120 * 2 * y + 2 * x)..][..3];
        assert_eq!((at(5, 10), at(11, 10)), (&[255, 0, 0][..], &[255; 3][..]));
        // The letters are there although no font was looked for: three upright strokes and more are black.
        let black = (12..60).filter(|&x| at(x, 10).iter().all(|&c| c < 100));
        assert!(black.count() >= 3, "no letters");
    }
}
