//! Screenshots of the window and their comparison.

/// RGB pixels of a part of the screen, row by row.
pub(super) struct Screenshot {
    pub(super) width: usize,
    pub(super) colors: Vec<[u8; 3]>,
}

impl Screenshot {
    /// Returns the number of pixels with such a color.
    pub(super) fn count(&self, has_color: fn([u8; 3]) -> bool) -> usize {
        self.colors.iter().filter(|&&c| has_color(c)).count()
    }

    /// Returns the number of corners of the image with such a color.
    pub(super) fn corner_count(&self, has_color: fn([u8; 3]) -> bool) -> usize {
        let (all, width) = (self.colors.len(), self.width);
        let corners = [0, width - 1, all - width, all - 1];
        corners
            .into_iter()
            .filter(|&i| has_color(self.colors[i]))
            .count()
    }

    /// Returns the number of pixels that differ visibly from another screenshot.
    pub(super) fn difference(&self, other: &Self) -> usize {
        let pairs = self.colors.iter().zip(&other.colors);
        pairs
            .filter(|(a, b)| (0..3).any(|k| a[k].abs_diff(b[k]) > 12))
            .count()
    }

    /// Returns the mean row of the pixels with such a color.
    pub(super) fn mean_row(&self, has_color: fn([u8; 3]) -> bool) -> usize {
        self.center(has_color)[1]
    }

    /// Returns the mean column and row of the pixels with such a color.
    pub(super) fn center(&self, has_color: fn([u8; 3]) -> bool) -> [usize; 2] {
        let coordinates = self.coordinates(has_color);
        let (sum, count) =
            coordinates.fold(([0, 0], 0), |([a, b], n), [x, y]| ([a + x, b + y], n + 1));
        sum.map(|sum| sum / count.max(1))
    }

    /// Returns the first and the last row with such a color.
    pub(super) fn rows(&self, has_color: fn([u8; 3]) -> bool) -> Option<[usize; 2]> {
        let mut rows = self.coordinates(has_color).map(|[_, y]| y);
        let first = rows.next()?;
        Some([first, rows.last().unwrap_or(first)])
    }

    /// Returns columns and rows of the pixels with such a color, row by row.
    fn coordinates(&self, has_color: fn([u8; 3]) -> bool) -> impl Iterator<Item = [usize; 2]> + '_ {
        let all = self.colors.iter().enumerate();
        let counted = all.filter(move |&(_, &color)| has_color(color));
        counted.map(|(i, _)| [i % self.width, i / self.width])
    }
}

/// Returns true for the color of the first piece in any light.
pub(super) fn is_blue([r, g, b]: [u8; 3]) -> bool {
    b > g && g > r && b - r > 35
}

/// Returns true for the color of the second piece.
pub(super) fn is_yellow([r, g, b]: [u8; 3]) -> bool {
    r > g && g > b && r - b > 55 && u16::from(g) * 10 > u16::from(r) * 7
}

/// Returns true for the color of caps and of error messages.
pub(super) fn is_red([r, g, b]: [u8; 3]) -> bool {
    r > 60 && u16::from(r) * 10 > u16::from(g) * 18 && u16::from(r) * 10 > u16::from(b) * 18
}
