//! Plots as files: SVG and PNG.

use crate::output::{OutputError, OutputFile};
use incise_render::DEJAVU_SANS;
use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::style::{FontStyle, WHITE, register_font};
use std::path::Path;

/// Font of all text: the viewer's in an SVG, the embedded one in a PNG.
pub(crate) const FONT: &str = "sans-serif";

/// An error of drawing or writing a picture.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PictureError {
    /// An error of the plotting backend.
    #[error("a picture cannot be drawn: {0}; the rows are not affected")]
    Chart(String),
    /// An error of the PNG encoder.
    #[error("a picture cannot be encoded: {0}; the rows are not affected")]
    Png(#[from] png::EncodingError),
    /// An error of a file.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// The drawing error of a backend.
pub(crate) type Fault<B> = DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>;

/// An image for any backend.
pub(crate) trait Image {
    /// Draws on a white area.
    ///
    /// # Errors
    /// An error of the backend.
    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), Fault<B>>
    where
        B::ErrorType: 'static;
}

/// The SVG and PNG files of a picture.
#[derive(Debug)]
pub(crate) struct PictureFile {
    svg: OutputFile,
    png: OutputFile,
}

impl PictureFile {
    /// Opens both files before the run; `svg` and `png` replace the path's extension.
    ///
    /// # Errors
    /// As [`OutputFile::open`].
    pub(crate) fn open(path: &Path) -> Result<Self, OutputError> {
        Ok(Self {
            svg: OutputFile::open(&path.with_extension("svg"))?,
            png: OutputFile::open(&path.with_extension("png"))?,
        })
    }

    /// Draws a picture of `size` \[px\] and replaces the files.
    ///
    /// # Errors
    /// [`PictureError`].
    pub(crate) fn draw(
        &mut self,
        size: (u32, u32),
        picture: &impl Image,
    ) -> Result<(), PictureError> {
        self.svg.write(svg(size, picture)?)?;
        Ok(self.png.write(png(size, picture)?)?)
    }
}

/// Draws a picture of `size` \[px\] as SVG.
///
/// # Errors
/// [`PictureError::Chart`].
pub(crate) fn svg(size: (u32, u32), picture: &impl Image) -> Result<String, PictureError> {
    let mut text = String::new();
    draw(SVGBackend::with_string(&mut text, size), picture)?;
    Ok(text)
}

/// Draws a picture as a PNG file.
fn png(size: (u32, u32), picture: &impl Image) -> Result<Vec<u8>, PictureError> {
    let (width, height) = size;
    let mut pixels = vec![0; 3 * width as usize * height as usize];
    draw(BitMapBackend::with_buffer(&mut pixels, size), picture)?;
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels)?;
    writer.finish()?;
    Ok(file)
}

fn draw<B: DrawingBackend>(backend: B, picture: &impl Image) -> Result<(), PictureError>
where
    B::ErrorType: 'static,
{
    let failed = |fault: Fault<B>| PictureError::Chart(fault.to_string());
    register_font(FONT, FontStyle::Normal, DEJAVU_SANS)
        .map_err(|_| PictureError::Chart("the embedded font is broken".to_owned()))?;
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

    impl Image for Sign {
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
        file.draw((60, 20), &Sign).unwrap();
        let svg = std::fs::read_to_string(place.path().join("sign.svg")).unwrap();
        assert!(svg.contains("HIH") && svg.contains("#FF0000"), "{svg}");
        let png = std::fs::File::open(place.path().join("sign.png")).unwrap();
        let mut reader = png::Decoder::new(std::io::BufReader::new(png))
            .read_info()
            .unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let shape = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((shape.width, shape.height), (60, 20));
        let at = |x: usize, y: usize| &pixels[3 * (60 * y + x)..][..3];
        assert_eq!((at(5, 10), at(11, 10)), (&[255, 0, 0][..], &[255; 3][..]));
        // The embedded font draws the letters: three upright strokes and more are black.
        let black = (12..60).filter(|&x| at(x, 10).iter().all(|&c| c < 100));
        assert!(black.count() >= 3, "no letters");
    }
}
