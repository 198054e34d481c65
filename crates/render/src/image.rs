//! Images in CPU memory: pixel access, composition and PNG output.

use crate::color::Color;
use crate::error::RenderError;
use std::io::{self, Write};
use std::path::Path;

/// Maximum side of an image \[px\]: its size is then below 2^32 bytes.
pub(crate) const MAX_SIDE: u32 = (1 << 15) - 1;

/// An RGBA image: rows from the top, sRGB with 8 bits per channel, straight alpha.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    width: u32,
    height: u32,
    /// Shape \[height\]\[width\]\[4\].
    pixels: Vec<u8>,
}

impl Image {
    /// Creates an image of one color.
    ///
    /// # Errors
    /// [`RenderError::InvalidSize`] and [`RenderError::OutOfMemory`].
    pub fn new(width: u32, height: u32, color: Color) -> Result<Self, RenderError> {
        check_size(width, height, MAX_SIDE)?;
        let bytes = 4 * width as usize * height as usize;
        let mut pixels = Vec::new();
        let reserved = pixels.try_reserve_exact(bytes);
        reserved.map_err(|_| RenderError::OutOfMemory { what: "an image" })?;
        pixels.resize(bytes, 0);
        for pixel in pixels.as_chunks_mut::<4>().0 {
            *pixel = color.0;
        }
        Ok(Self {
            width,
            height,
            pixels,
        })
    }

    /// Creates an image from RGBA bytes, shape \[height\]\[width\]\[4\].
    ///
    /// # Errors
    /// [`RenderError::InvalidSize`]; [`RenderError::PixelCount`] unless there are four bytes per
    /// pixel.
    pub fn from_pixels(width: u32, height: u32, pixels: Vec<u8>) -> Result<Self, RenderError> {
        check_size(width, height, MAX_SIDE)?;
        if pixels.len() != 4 * width as usize * height as usize {
            let bytes = pixels.len();
            return Err(RenderError::PixelCount {
                width,
                height,
                bytes,
            });
        }
        Ok(Self {
            width,
            height,
            pixels,
        })
    }

    /// Returns the width \[px\].
    #[must_use]
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Returns the height \[px\].
    #[must_use]
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// Returns the RGBA bytes, shape \[height\]\[width\]\[4\].
    #[must_use]
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// Returns the RGBA bytes for writing, shape \[height\]\[width\]\[4\].
    #[must_use]
    pub fn pixels_mut(&mut self) -> &mut [u8] {
        &mut self.pixels
    }

    /// Returns the color at column `x` and row `y`, or `None` outside of the image.
    #[must_use]
    pub fn color(&self, x: u32, y: u32) -> Option<Color> {
        if x >= self.width || y >= self.height {
            return None;
        }
        let i = y as usize * self.width as usize + x as usize;
        Some(Color(self.pixels.as_chunks::<4>().0[i]))
    }

    /// Copies another image into this one, its upper left corner at column `x` and row `y`.
    ///
    /// Pixels outside are clipped. Alpha is copied like the other channels, not blended.
    pub fn blit(&mut self, other: &Self, x: i64, y: i64) {
        let (columns, from_x, to_x) = clip(x, other.width, self.width);
        let (rows, from_y, to_y) = clip(y, other.height, self.height);
        if columns == 0 {
            return;
        }
        for row in 0..rows {
            let from = 4 * ((from_y + row) * other.width as usize + from_x);
            let to = 4 * ((to_y + row) * self.width as usize + to_x);
            let line = &other.pixels[from..from + 4 * columns];
            self.pixels[to..to + 4 * columns].copy_from_slice(line);
        }
    }

    /// Blends a color into the pixel at column `x` and row `y` with weight `coverage`, 0 to 1.
    ///
    /// Positions outside of the image are ignored.
    pub(crate) fn blend(&mut self, x: i64, y: i64, color: Color, coverage: f32) {
        let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else {
            return;
        };
        if x >= self.width || y >= self.height {
            return;
        }
        let at = 4 * (y as usize * self.width as usize + x as usize);
        for (old, new) in self.pixels[at..at + 4].iter_mut().zip(color.0) {
            *old = lerp(*old, new, coverage);
        }
    }

    /// Encodes the image as a PNG file tagged as sRGB.
    ///
    /// # Errors
    /// [`RenderError::Png`].
    pub fn to_png(&self) -> Result<Vec<u8>, RenderError> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.width, self.height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.pixels)?;
        writer.finish()?;
        Ok(file)
    }

    /// Writes the image as a PNG file and replaces an existing file atomically.
    ///
    /// # Errors
    /// [`RenderError::Png`] and [`RenderError::Write`]; an existing file is then unchanged and no
    /// partial file remains.
    pub fn write_png(&self, path: &Path) -> Result<(), RenderError> {
        let file = self.to_png()?;
        replace(path, &file).map_err(|source| RenderError::Write {
            path: path.to_owned(),
            source,
        })
    }
}

/// Interpolates between two channel values.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a channel between two others"
)]
fn lerp(from: u8, to: u8, t: f32) -> u8 {
    let (from, to) = (f32::from(from), f32::from(to));
    (from + (to - from) * t.clamp(0.0, 1.0)).round() as u8
}

/// Returns an error unless both sides have 1 to `limit` pixels.
pub(crate) fn check_size(width: u32, height: u32, limit: u32) -> Result<(), RenderError> {
    let is_side = |side| (1..=limit).contains(&side);
    if is_side(width) && is_side(height) {
        return Ok(());
    }
    Err(RenderError::InvalidSize {
        width,
        height,
        limit,
    })
}

/// Clips an interval of `len` pixels at `at` to `target_len` pixels at 0.
///
/// Returns the length of the overlap and its start in the interval and in the target.
fn clip(at: i64, len: u32, target_len: u32) -> (usize, usize, usize) {
    let begin = at.clamp(0, i64::from(target_len));
    let end = at
        .saturating_add(i64::from(len))
        .clamp(begin, i64::from(target_len));
    let place = |x: i64| usize::try_from(x).unwrap_or(0);
    (
        place(end - begin),
        place(begin.saturating_sub(at)),
        place(begin),
    )
}

/// Writes a temporary file beside `path` and renames it once it is complete.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let name = path.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
    let mut name = name.to_owned();
    name.push(format!(".{}.part", std::process::id()));
    let part = path.with_file_name(name);
    let mut file = std::fs::File::create(&part)?;
    let written = (file.write_all(bytes)).and_then(|()| std::fs::rename(&part, path));
    if written.is_err() {
        // The first error is the one to report.
        let _ = std::fs::remove_file(&part);
    }
    written
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Color = Color::rgb(255, 0, 0);
    const BLUE: Color = Color::rgb(0, 0, 255);

    /// Returns an image of distinct pixels.
    fn chart(width: u32, height: u32) -> Image {
        let bytes = (0..4 * width * height).map(|i| u8::try_from(i * 37 % 251).unwrap());
        Image::from_pixels(width, height, bytes.collect()).unwrap()
    }

    #[test]
    fn written_png_decodes_to_the_same_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        std::fs::write(&path, "old").unwrap();
        let image = chart(13, 7);
        image.write_png(&path).unwrap();
        let file = io::BufReader::new(std::fs::File::open(&path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!((info.width, info.height), (13, 7));
        assert_eq!(info.color_type, png::ColorType::Rgba);
        assert_eq!(bytes, image.pixels());
        assert!(reader.info().srgb.is_some(), "the file is tagged as sRGB");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn failed_write_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("folder.png");
        std::fs::create_dir(&target).unwrap();
        let error = chart(1, 1).write_png(&target).unwrap_err();
        assert!(matches!(&error, RenderError::Write { path, .. } if *path == target));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn blit_copies_the_overlap_and_clips_the_rest() {
        let (small, background) = (chart(3, 2), Image::new(5, 4, RED).unwrap());
        for x in -4..=6 {
            for y in -3..=5 {
                let mut image = background.clone();
                image.blit(&small, x, y);
                for (column, row) in (0..5).flat_map(|c| (0..4).map(move |r| (c, r))) {
                    let at = |p: u32, origin: i64| u32::try_from(i64::from(p) - origin).ok();
                    let own = at(column, x).zip(at(row, y));
                    let own = own.and_then(|(c, r)| small.color(c, r)).unwrap_or(RED);
                    assert_eq!(image.color(column, row), Some(own), "{x} {y}");
                }
            }
        }
        let mut image = background.clone();
        for far in [i64::MIN, i64::MAX] {
            image.blit(&small, far, 0);
            image.blit(&small, 0, far);
        }
        assert_eq!(image, background, "positions far outside change nothing");
    }

    #[test]
    fn invalid_sizes_and_byte_counts_are_errors() {
        for (width, height) in [(0, 1), (1, 0), (MAX_SIDE + 1, 1), (1, u32::MAX)] {
            let error = Image::new(width, height, BLUE).unwrap_err();
            assert!(matches!(error, RenderError::InvalidSize { .. }), "{error}");
            let error = Image::from_pixels(width, height, Vec::new()).unwrap_err();
            assert!(matches!(error, RenderError::InvalidSize { .. }), "{error}");
        }
        let error = Image::from_pixels(2, 2, vec![0; 15]).unwrap_err();
        assert!(
            matches!(error, RenderError::PixelCount { bytes: 15, .. }),
            "{error}"
        );
        assert_eq!(chart(2, 2).color(2, 0), None);
        assert_eq!(chart(2, 2).color(0, 2), None);
    }
}
