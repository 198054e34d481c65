//! Pictures beside each other, in rows, as a figure of a paper has them.

use crate::color::Color;
use crate::error::RenderError;
use crate::letters::Letters;
use crate::picture::{MAX_SIDE, Picture, check_size};

const PAPER: Color = Color::rgb(255, 255, 255);
const INK: Color = Color::rgb(24, 28, 34);

/// Letters are this part of a panel's height, and a panel's distance from the next one is this part of a letter.
const EM: f64 = 1.0 / 19.0;
const GAP: f32 = 0.7;
/// A label's height, and from its top to its baseline \[em\].
const LABEL: f32 = 1.7;
const BASELINE: f32 = 1.2;
/// The fewest pixels of an em that can be read.
const SMALLEST: f32 = 9.0;

/// A sheet of paper with room for panels of one size in rows: above each row a line of text, below each panel another one.
#[derive(Debug, Clone)]
pub struct Panels {
    letters: Letters,
    picture: Picture,
    panel: [u32; 2],
    columns: u32,
    rows: u32,
    em: f32,
}

/// What a sheet's size follows from \[px\].
struct Spaces {
    gap: u32,
    label: u32,
}

impl Spaces {
    fn of(em: f32) -> Self {
        let [gap, label] = [GAP, LABEL].map(|part| whole(part * em));
        Self { gap, label }
    }
}

/// How large letters are beside a panel of this height \[px an em\].
#[expect(
    clippy::cast_possible_truncation,
    reason = "the size of letters is a few pixels"
)]
fn em(height: u32) -> f32 {
    ((f64::from(height) * EM) as f32).max(SMALLEST)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a place in a picture"
)]
fn whole(x: f32) -> u32 {
    x.round() as u32
}

impl Panels {
    /// The size of a sheet with so many panels of `panel` pixels across and along in a row, and so many rows \[px\].
    #[must_use]
    pub fn size(panel: [u32; 2], columns: u32, rows: u32) -> [u32; 2] {
        let Spaces { gap, label } = Spaces::of(em(panel[1]));
        let [across, along] = [
            panel[0].saturating_add(gap),
            panel[1].saturating_add(2 * label),
        ];
        [
            columns.saturating_mul(across).saturating_add(gap),
            rows.saturating_mul(along).saturating_add(gap),
        ]
    }

    /// An empty sheet.
    ///
    /// # Errors
    /// [`RenderError::Size`] for panels or sheets without pixels, or with too many, [`RenderError::OutOfMemory`] and
    /// [`RenderError::Font`].
    pub fn new(panel: [u32; 2], columns: u32, rows: u32) -> Result<Self, RenderError> {
        check_size(panel[0], panel[1], MAX_SIDE)?;
        check_size(columns, rows, MAX_SIDE)?;
        let [width, height] = Self::size(panel, columns, rows);
        Ok(Self {
            letters: Letters::new()?,
            picture: Picture::new(width, height, PAPER)?,
            panel,
            columns,
            rows,
            em: em(panel[1]),
        })
    }

    /// Writes a line of text above a row. A row that there is not is left out.
    pub fn title(&mut self, row: u32, text: &str) {
        if row < self.rows {
            let [left, top] = self.corner(0, row);
            let label = i64::from(Spaces::of(self.em).label);
            let width = self.picture.width();
            self.write(text, [left, top - label], width);
        }
    }

    /// Puts a picture of a panel's size in a row and a column, and a text below it, smaller if it is long. A place that
    /// there is not is left out.
    pub fn put(&mut self, [column, row]: [u32; 2], picture: &Picture, text: &str) {
        if column < self.columns && row < self.rows {
            let [left, top] = self.corner(column, row);
            self.picture.blit(picture, left, top);
            let [width, height] = self.panel;
            self.write(text, [left, top + i64::from(height)], width);
        }
    }

    /// The sheet.
    #[must_use]
    pub fn into_picture(self) -> Picture {
        self.picture
    }

    /// Where a panel is.
    #[must_use]
    pub fn corner(&self, column: u32, row: u32) -> [i64; 2] {
        let Spaces { gap, label } = Spaces::of(self.em);
        let [across, along] = [self.panel[0] + gap, self.panel[1] + 2 * label];
        [
            i64::from(gap) + i64::from(column) * i64::from(across),
            i64::from(gap / 2) + i64::from(label) + i64::from(row) * i64::from(along),
        ]
    }

    /// Writes a line whose upper left corner is there, no longer than `room` \[px\].
    fn write(&mut self, text: &str, [left, top]: [i64; 2], room: u32) {
        #[expect(
            clippy::cast_precision_loss,
            reason = "a picture has fewer than 2^15 pixels a side"
        )]
        let room = room as f32;
        let full = self.letters.line(text, self.em);
        let fit = (room / full.width().max(1.0)).min(1.0);
        let line = self.letters.line(text, self.em * fit);
        let baseline = top + i64::from(whole(BASELINE * self.em));
        let picture = &mut self.picture;
        line.draw(|[x, y], covered| {
            picture.mix(left + i64::from(x), baseline + i64::from(y), INK, covered);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Color = Color::rgb(255, 0, 0);

    fn ink(picture: &Picture, [left, top]: [i64; 2], [width, height]: [i64; 2]) -> usize {
        let places = (top..top + height).flat_map(|y| (left..left + width).map(move |x| (x, y)));
        let at = |(x, y)| picture.color(u32::try_from(x).unwrap(), u32::try_from(y).unwrap());
        places
            .filter_map(at)
            .filter(|color| color.0[0] < 128)
            .count()
    }

    #[test]
    fn panels_stand_in_rows_with_their_texts() {
        let size = [100, 80];
        let mut sheet = Panels::new(size, 3, 2).unwrap();
        let panel = Picture::new(100, 80, RED).unwrap();
        sheet.put([2, 1], &panel, "(a) text");
        sheet.title(0, "a row");
        sheet.put([3, 1], &panel, "there is no such column");
        sheet.title(2, "nor such a row");
        let (corner, first) = (sheet.corner(2, 1), sheet.corner(0, 0));
        let picture = sheet.into_picture();
        let [width, height] = Panels::size(size, 3, 2);
        assert_eq!([picture.width(), picture.height()], [width, height]);
        let pixels = picture.pixels().as_chunks::<4>().0;
        let red = pixels.iter().filter(|&&pixel| pixel == RED.0).count();
        assert_eq!(red, 100 * 80, "one panel, all of it");
        let [x, y] = corner.map(|x| u32::try_from(x).unwrap());
        assert_eq!(picture.color(x, y), Some(RED));
        assert_eq!(picture.color(x + 99, y + 79), Some(RED));
        let below = [corner[0], corner[1] + 80];
        assert!(ink(&picture, below, [100, 15]) > 20, "a label");
        assert!(
            ink(&picture, [first[0], 0], [100, first[1]]) > 20,
            "a title"
        );
        let all = ink(&picture, [0, 0], [width, height].map(i64::from));
        let both = ink(&picture, below, [100, 15]) + ink(&picture, [0, 0], [100, first[1]]);
        assert_eq!(all, both, "nothing else is written");
    }

    #[test]
    fn long_labels_stay_below_their_panel() {
        let mut sheet = Panels::new([200, 200], 2, 1).unwrap();
        let panel = Picture::new(200, 200, PAPER).unwrap();
        sheet.put(
            [0, 0],
            &panel,
            "a label that is much longer than its panel is wide",
        );
        let [right, top] = sheet.corner(1, 0);
        let picture = sheet.into_picture();
        assert!(ink(&picture, [0, top + 200], [right, 15]) > 20);
        assert_eq!(ink(&picture, [right, top], [200, 215]), 0);
    }

    #[test]
    fn sheets_that_are_none_are_refused() {
        for (panel, columns, rows) in [
            ([0, 1], 1, 1),
            ([1, 1], 0, 1),
            ([1, 1], 1, 0),
            ([MAX_SIDE, 10], 2, 1),
            ([10, 10], u32::MAX, 1),
        ] {
            let error = Panels::new(panel, columns, rows).unwrap_err();
            assert!(matches!(error, RenderError::Size { .. }), "{error}");
        }
    }
}
