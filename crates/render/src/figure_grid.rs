//! Arranges images of one size in labeled rows and columns, like a figure of a paper.

use crate::color::Color;
use crate::error::RenderError;
use crate::font::Font;
use crate::image::{Image, MAX_SIDE, check_size};

const PAPER: Color = Color::rgb(255, 255, 255);
const INK: Color = Color::rgb(24, 28, 34);

/// Font size relative to the height of a panel.
const EM: f64 = 1.0 / 19.0;
/// Distance between panels \[em\].
const GAP: f32 = 0.7;
/// Height of a label \[em\].
const LABEL: f32 = 1.7;
/// Distance from the top of a label to its baseline \[em\].
const BASELINE: f32 = 1.2;
/// Minimum readable font size \[px\].
const MIN_EM: f32 = 9.0;

/// A grid of panels of one size, with a title above each row and a label below each panel.
#[derive(Debug, Clone)]
pub struct FigureGrid {
    font: Font,
    image: Image,
    panel: [u32; 2],
    columns: u32,
    rows: u32,
    em: f32,
}

/// Distances that determine the size of a grid \[px\].
struct Spacing {
    gap: u32,
    label: u32,
}

impl Spacing {
    fn from_em(em: f32) -> Self {
        let [gap, label] = [GAP, LABEL].map(|part| whole(part * em));
        Self { gap, label }
    }
}

/// Returns the font size for panels of this height \[px\].
#[expect(
    clippy::cast_possible_truncation,
    reason = "a font size is a few pixels"
)]
fn em(height: u32) -> f32 {
    ((f64::from(height) * EM) as f32).max(MIN_EM)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a pixel coordinate"
)]
fn whole(x: f32) -> u32 {
    x.round() as u32
}

impl FigureGrid {
    /// Returns width and height of a grid of panels with `panel` pixels (width, height) \[px\].
    #[must_use]
    pub fn size(panel: [u32; 2], columns: u32, rows: u32) -> [u32; 2] {
        let Spacing { gap, label } = Spacing::from_em(em(panel[1]));
        let [across, along] = [
            panel[0].saturating_add(gap),
            panel[1].saturating_add(2 * label),
        ];
        [
            columns.saturating_mul(across).saturating_add(gap),
            rows.saturating_mul(along).saturating_add(gap),
        ]
    }

    /// Creates an empty grid.
    ///
    /// # Errors
    /// [`RenderError::InvalidSize`] for panels or grids without pixels or with too many;
    /// [`RenderError::OutOfMemory`]; [`RenderError::InvalidFont`].
    pub fn new(panel: [u32; 2], columns: u32, rows: u32) -> Result<Self, RenderError> {
        check_size(panel[0], panel[1], MAX_SIDE)?;
        check_size(columns, rows, MAX_SIDE)?;
        let [width, height] = Self::size(panel, columns, rows);
        Ok(Self {
            font: Font::new()?,
            image: Image::new(width, height, PAPER)?,
            panel,
            columns,
            rows,
            em: em(panel[1]),
        })
    }

    /// Writes a title above a row. A row outside of the grid is ignored.
    pub fn title(&mut self, row: u32, text: &str) {
        if row < self.rows {
            let [left, top] = self.corner(0, row);
            let label = i64::from(Spacing::from_em(self.em).label);
            let width = self.image.width();
            self.write(text, [left, top - label], width);
        }
    }

    /// Places an image in a cell and a label below it; long labels are scaled to fit.
    ///
    /// A cell outside of the grid is ignored.
    pub fn put(&mut self, [column, row]: [u32; 2], image: &Image, text: &str) {
        if column < self.columns && row < self.rows {
            let [left, top] = self.corner(column, row);
            self.image.blit(image, left, top);
            let [width, height] = self.panel;
            self.write(text, [left, top + i64::from(height)], width);
        }
    }

    /// Returns the whole grid as one image.
    #[must_use]
    pub fn into_image(self) -> Image {
        self.image
    }

    /// Returns the upper left corner of a panel \[px\].
    #[must_use]
    pub fn corner(&self, column: u32, row: u32) -> [i64; 2] {
        let Spacing { gap, label } = Spacing::from_em(self.em);
        let [across, along] = [self.panel[0] + gap, self.panel[1] + 2 * label];
        [
            i64::from(gap) + i64::from(column) * i64::from(across),
            i64::from(gap / 2) + i64::from(label) + i64::from(row) * i64::from(along),
        ]
    }

    /// Writes a line of text at an upper left corner, at most `max_width` wide \[px\].
    fn write(&mut self, text: &str, [left, top]: [i64; 2], max_width: u32) {
        #[expect(
            clippy::cast_precision_loss,
            reason = "an image has fewer than 2^15 pixels per side"
        )]
        let max_width = max_width as f32;
        let full = self.font.line(text, self.em);
        let fit = (max_width / full.width().max(1.0)).min(1.0);
        let line = self.font.line(text, self.em * fit);
        let baseline = top + i64::from(whole(BASELINE * self.em));
        let image = &mut self.image;
        line.draw(|[x, y], coverage| {
            image.blend(left + i64::from(x), baseline + i64::from(y), INK, coverage);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Color = Color::rgb(255, 0, 0);

    /// Returns the number of dark pixels in a rectangle.
    fn ink(image: &Image, [left, top]: [i64; 2], [width, height]: [i64; 2]) -> usize {
        let places = (top..top + height).flat_map(|y| (left..left + width).map(move |x| (x, y)));
        let at = |(x, y)| image.color(u32::try_from(x).unwrap(), u32::try_from(y).unwrap());
        places
            .filter_map(at)
            .filter(|color| color.0[0] < 128)
            .count()
    }

    #[test]
    fn panels_are_in_rows_with_titles_and_labels() {
        let size = [100, 80];
        let mut grid = FigureGrid::new(size, 3, 2).unwrap();
        let panel = Image::new(100, 80, RED).unwrap();
        grid.put([2, 1], &panel, "(a) text");
        grid.title(0, "a row");
        grid.put([3, 1], &panel, "there is no such column");
        grid.title(2, "nor such a row");
        let (corner, first) = (grid.corner(2, 1), grid.corner(0, 0));
        let image = grid.into_image();
        let [width, height] = FigureGrid::size(size, 3, 2);
        assert_eq!([image.width(), image.height()], [width, height]);
        let pixels = image.pixels().as_chunks::<4>().0;
        let red = pixels.iter().filter(|&&pixel| pixel == RED.0).count();
        assert_eq!(red, 100 * 80, "one panel, all of it");
        let [x, y] = corner.map(|x| u32::try_from(x).unwrap());
        assert_eq!(image.color(x, y), Some(RED));
        assert_eq!(image.color(x + 99, y + 79), Some(RED));
        let below = [corner[0], corner[1] + 80];
        assert!(ink(&image, below, [100, 15]) > 20, "a label");
        assert!(ink(&image, [first[0], 0], [100, first[1]]) > 20, "a title");
        let all = ink(&image, [0, 0], [width, height].map(i64::from));
        let both = ink(&image, below, [100, 15]) + ink(&image, [0, 0], [100, first[1]]);
        assert_eq!(all, both, "nothing else is written");
    }

    #[test]
    fn long_labels_fit_the_width_of_their_panel() {
        let mut grid = FigureGrid::new([200, 200], 2, 1).unwrap();
        let panel = Image::new(200, 200, PAPER).unwrap();
        grid.put(
            [0, 0],
            &panel,
            "a label that is much longer than its panel is wide",
        );
        let [right, top] = grid.corner(1, 0);
        let image = grid.into_image();
        assert!(ink(&image, [0, top + 200], [right, 15]) > 20);
        assert_eq!(ink(&image, [right, top], [200, 215]), 0);
    }

    #[test]
    fn invalid_sizes_are_errors() {
        for (panel, columns, rows) in [
            ([0, 1], 1, 1),
            ([1, 1], 0, 1),
            ([1, 1], 1, 0),
            ([MAX_SIDE, 10], 2, 1),
            ([10, 10], u32::MAX, 1),
        ] {
            let error = FigureGrid::new(panel, columns, rows).unwrap_err();
            assert!(matches!(error, RenderError::InvalidSize { .. }), "{error}");
        }
    }
}
