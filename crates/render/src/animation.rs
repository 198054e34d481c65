//! Animated PNG: a sequence of images of one size in one file.

use crate::error::RenderError;
use crate::image::{Image, replace};
use std::path::Path;

/// Writes images as an animated PNG that repeats, and replaces an existing file atomically.
///
/// Every frame after the first one holds the rectangle that differs from the frame before. Programs
/// that know PNG alone show the first frame.
///
/// # Errors
/// [`RenderError::NoFrames`] and [`RenderError::FrameSize`]; errors of the images;
/// [`RenderError::Png`] and [`RenderError::Write`]. An existing file is then unchanged.
pub fn write_animation(
    path: &Path,
    frames_per_second: u16,
    images: impl ExactSizeIterator<Item = Result<Image, RenderError>>,
) -> Result<(), RenderError> {
    let file = encode(frames_per_second, images)?;
    replace(path, &file).map_err(|source| RenderError::Write {
        path: path.to_owned(),
        source,
    })
}

fn encode(
    frames_per_second: u16,
    mut images: impl ExactSizeIterator<Item = Result<Image, RenderError>>,
) -> Result<Vec<u8>, RenderError> {
    let count = u32::try_from(images.len()).unwrap_or(u32::MAX);
    let mut previous = images.next().ok_or(RenderError::NoFrames)??;
    let (width, height) = (previous.width(), previous.height());
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.set_compression(png::Compression::High);
    encoder.set_animated(count, 0)?;
    encoder.set_frame_delay(1, frames_per_second.max(1))?;
    encoder.set_blend_op(png::BlendOp::Source)?;
    let mut writer = encoder.write_header()?;
    writer.write_image_data(previous.pixels())?;
    for image in images {
        let image = image?;
        if (image.width(), image.height()) != (width, height) {
            return Err(RenderError::FrameSize {
                width: image.width(),
                height: image.height(),
                expected: [width, height],
            });
        }
        let [x, y, width, height] = changed_rectangle(&previous, &image);
        // The position first: the rectangle must always be within the image.
        writer.reset_frame_position()?;
        writer.set_frame_dimension(width, height)?;
        writer.set_frame_position(x, y)?;
        writer.write_image_data(&crop(&image, [x, y, width, height]))?;
        previous = image;
    }
    writer.finish()?;
    Ok(file)
}

/// Returns x, y, width and height of the smallest rectangle with all differences of two images of
/// one size; of one pixel if there are none.
fn changed_rectangle(a: &Image, b: &Image) -> [u32; 4] {
    let ([mut left, mut top], [mut right, mut bottom]) = ([u32::MAX; 2], [0; 2]);
    for y in 0..a.height() {
        for x in 0..a.width() {
            if a.color(x, y) != b.color(x, y) {
                (left, top) = (left.min(x), top.min(y));
                (right, bottom) = (right.max(x + 1), bottom.max(y + 1));
            }
        }
    }
    if right == 0 {
        return [0, 0, 1, 1];
    }
    [left, top, right - left, bottom - top]
}

/// Returns the RGBA bytes of a rectangle within an image.
fn crop(image: &Image, [x, y, width, height]: [u32; 4]) -> Vec<u8> {
    let [x, width] = [x, width].map(|pixels| 4 * pixels as usize);
    let rows = image.pixels().chunks_exact(4 * image.width() as usize);
    let rows = rows.skip(y as usize).take(height as usize);
    rows.flat_map(|row| &row[x..x + width]).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Color;

    const SIZE: [u32; 2] = [13, 7];

    /// Returns an image with a square of two by two pixels.
    fn frame(x: i64, y: i64) -> Image {
        let mut image = Image::new(SIZE[0], SIZE[1], Color::rgb(250, 250, 250)).unwrap();
        image.blit(&Image::new(2, 2, Color::rgb(9, 90, 200)).unwrap(), x, y);
        image
    }

    #[test]
    fn frames_decode_to_the_same_pixels() {
        let frames = [
            frame(0, 0),
            frame(3, 1),
            frame(3, 1),
            frame(12, 6),
            frame(5, 5),
        ];
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write_animation(&path, 25, frames.iter().cloned().map(Ok)).unwrap();
        let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let control = *reader.info().animation_control().unwrap();
        assert_eq!((control.num_frames, control.num_plays), (5, 0));
        let mut shown = Image::new(SIZE[0], SIZE[1], Color::rgb(0, 0, 0)).unwrap();
        for expected in &frames {
            let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
            let info = reader.next_frame(&mut bytes).unwrap();
            bytes.truncate(info.buffer_size());
            let frame = *reader.info().frame_control().unwrap();
            assert_eq!((frame.delay_num, frame.delay_den), (1, 25));
            let part = Image::from_pixels(info.width, info.height, bytes).unwrap();
            shown.blit(&part, frame.x_offset.into(), frame.y_offset.into());
            assert_eq!(&shown, expected);
        }
    }

    #[test]
    fn no_frames_and_other_sizes_are_errors() {
        let path = Path::new("/nonexistent/a.png");
        let none = write_animation(path, 1, std::iter::empty());
        assert!(matches!(none, Err(RenderError::NoFrames)));
        let small = Image::new(1, 1, Color::rgb(0, 0, 0)).unwrap();
        let frames = [frame(0, 0), small].map(Ok);
        let error = write_animation(path, 1, frames.into_iter()).unwrap_err();
        assert!(matches!(error, RenderError::FrameSize { width: 1, .. }));
    }
}
