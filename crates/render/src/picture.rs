//! Pixels on the host.

use crate::color::Color;
use crate::error::RenderError;
use std::io::{self, Write};
use std::path::Path;

/// The longest side of a picture: its bytes are then still fewer than 2^32.
pub(crate) const MAX_SIDE: u32 = (1 << 15) - 1;

/// A picture: rows from the top, pixels from the left, sRGB with 8 bits a channel, alpha not multiplied in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    width: u32,
    height: u32,
    /// Shape \[height\]\[width\]\[4\].
    pixels: Vec<u8>,
}

impl Picture {
    /// A picture of one color.
    ///
    /// # Errors
    /// [`RenderError::Size`], and [`RenderError::OutOfMemory`].
    pub fn new(width: u32, height: u32, color: Color) -> Result<Self, RenderError> {
        check_size(width, height, MAX_SIDE)?;
        let bytes = 4 * width as usize * height as usize;
        let mut pixels = Vec::new();
        let room = pixels.try_reserve_exact(bytes);
        room.map_err(|_| RenderError::OutOfMemory { what: "a picture" })?;
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

    /// A picture of pixels that somebody has, shape \[height\]\[width\]\[4\].
    ///
    /// # Errors
    /// [`RenderError::Size`], and [`RenderError::Pixels`] when there are not four bytes a pixel.
    pub fn from_pixels(width: u32, height: u32, pixels: Vec<u8>) -> Result<Self, RenderError> {
        check_size(width, height, MAX_SIDE)?;
        if pixels.len() != 4 * width as usize * height as usize {
            let bytes = pixels.len();
            return Err(RenderError::Pixels {
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

    /// Pixels in a row.
    #[must_use]
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    #[must_use]
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// All bytes, shape \[height\]\[width\]\[4\].
    #[must_use]
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// All bytes, to be changed.
    #[must_use]
    pub fn pixels_mut(&mut self) -> &mut [u8] {
        &mut self.pixels
    }

    /// The color at column `x` and row `y`; none outside.
    #[must_use]
    pub fn color(&self, x: u32, y: u32) -> Option<Color> {
        if x >= self.width || y >= self.height {
            return None;
        }
        let i = y as usize * self.width as usize + x as usize;
        Some(Color(self.pixels.as_chunks::<4>().0[i]))
    }

    /// Puts another picture on this one, its upper left corner at column `x` and row `y`. What comes to lie outside is
    /// left out; alpha is copied like the other channels.
    pub fn blit(&mut self, other: &Self, x: i64, y: i64) {
        let (columns, from_x, to_x) = shared(x, other.width, self.width);
        let (rows, from_y, to_y) = shared(y, other.height, self.height);
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

    /// Mixes a color into the pixel at column `x` and row `y`, `part` of it, 0 to 1. Outside of the picture there is
    /// nothing to mix with.
    pub(crate) fn mix(&mut self, x: i64, y: i64, color: Color, part: f32) {
        let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else {
            return;
        };
        if x >= self.width || y >= self.height {
            return;
        }
        let at = 4 * (y as usize * self.width as usize + x as usize);
        for (old, new) in self.pixels[at..at + 4].iter_mut().zip(color.0) {
            *old = between(*old, new, part);
        }
    }

    /// The picture as the bytes of a PNG file, marked as sRGB.
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

    /// Writes the picture as PNG. A file that is there stays as it is unless all of the new one could be written.
    ///
    /// # Errors
    /// [`RenderError::Png`] and [`RenderError::Write`]; nothing is left of the attempt then.
    pub fn write_png(&self, path: &Path) -> Result<(), RenderError> {
        let file = self.to_png()?;
        replace(path, &file).map_err(|source| RenderError::Write {
            path: path.to_owned(),
            source,
        })
    }
}

/// A channel on the way from one value to another.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a channel between two others"
)]
fn between(from: u8, to: u8, part: f32) -> u8 {
    let (from, to) = (f32::from(from), f32::from(to));
    (from + (to - from) * part.clamp(0.0, 1.0)).round() as u8
}

/// Refuses sides without pixels and sides longer than `limit`.
pub(crate) fn check_size(width: u32, height: u32, limit: u32) -> Result<(), RenderError> {
    let is_side = |side| (1..=limit).contains(&side);
    if is_side(width) && is_side(height) {
        return Ok(());
    }
    Err(RenderError::Size {
        width,
        height,
        limit,
    })
}

/// Where a line of `len` that begins at `at` meets one of `room` that begins at 0: how much of it does, and where that
/// begins in either.
fn shared(at: i64, len: u32, room: u32) -> (usize, usize, usize) {
    let begin = at.clamp(0, i64::from(room));
    let end = at
        .saturating_add(i64::from(len))
        .clamp(begin, i64::from(room));
    let place = |x: i64| usize::try_from(x).unwrap_or(0);
    (
        place(end - begin),
        place(begin.saturating_sub(at)),
        place(begin),
    )
}

/// Writes a sibling file and gives it the name `path` once it is whole.
fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let name = path.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
    let mut name = name.to_owned();
    name.push(format!(".{}.part", std::process::id()));
    let part = path.with_file_name(name);
    let mut file = std::fs::File::create(&part)?;
    let written = (file.write_all(bytes)).and_then(|()| std::fs::rename(&part, path));
    if written.is_err() {
        // The first error is the one to tell.
        let _ = std::fs::remove_file(&part);
    }
    written
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Color = Color::rgb(255, 0, 0);
    const BLUE: Color = Color::rgb(0, 0, 255);

    /// A picture whose pixels are all different.
    fn chart(width: u32, height: u32) -> Picture {
        let bytes = (0..4 * width * height).map(|i| u8::try_from(i * 37 % 251).unwrap());
        Picture::from_pixels(width, height, bytes.collect()).unwrap()
    }

    #[test]
    fn what_is_written_reads_back_to_the_same_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        std::fs::write(&path, "old").unwrap();
        let picture = chart(13, 7);
        picture.write_png(&path).unwrap();
        let file = io::BufReader::new(std::fs::File::open(&path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!((info.width, info.height), (13, 7));
        assert_eq!(info.color_type, png::ColorType::Rgba);
        assert_eq!(bytes, picture.pixels());
        assert!(
            reader.info().srgb.is_some(),
            "what the numbers mean is said"
        );
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_file_that_cannot_be_written_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("folder.png");
        std::fs::create_dir(&target).unwrap();
        let error = chart(1, 1).write_png(&target).unwrap_err();
        assert!(matches!(&error, RenderError::Write { path, .. } if *path == target));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn pictures_are_put_on_pictures_wherever_they_meet() {
        let (small, background) = (chart(3, 2), Picture::new(5, 4, RED).unwrap());
        for x in -4..=6 {
            for y in -3..=5 {
                let mut picture = background.clone();
                picture.blit(&small, x, y);
                for (column, row) in (0..5).flat_map(|c| (0..4).map(move |r| (c, r))) {
                    let at = |p: u32, origin: i64| u32::try_from(i64::from(p) - origin).ok();
                    let own = at(column, x).zip(at(row, y));
                    let own = own.and_then(|(c, r)| small.color(c, r)).unwrap_or(RED);
                    assert_eq!(picture.color(column, row), Some(own), "{x} {y}");
                }
            }
        }
        let mut picture = background.clone();
        for far in [i64::MIN, i64::MAX] {
            picture.blit(&small, far, 0);
            picture.blit(&small, 0, far);
        }
        assert_eq!(picture, background, "what is far away changes nothing");
    }

    #[test]
    fn sizes_and_bytes_that_are_none_are_refused() {
        for (width, height) in [(0, 1), (1, 0), (MAX_SIDE + 1, 1), (1, u32::MAX)] {
            let error = Picture::new(width, height, BLUE).unwrap_err();
            assert!(matches!(error, RenderError::Size { .. }), "{error}");
            let error = Picture::from_pixels(width, height, Vec::new()).unwrap_err();
            assert!(matches!(error, RenderError::Size { .. }), "{error}");
        }
        let error = Picture::from_pixels(2, 2, vec![0; 15]).unwrap_err();
        assert!(
            matches!(error, RenderError::Pixels { bytes: 15, .. }),
            "{error}"
        );
        assert_eq!(chart(2, 2).color(2, 0), None);
        assert_eq!(chart(2, 2).color(0, 2), None);
    }
}
