//! What is seen of the window.

/// Red, green and blue of the picture beside the panel, row by row.
pub(super) struct Pixels {
    pub(super) width: usize,
    pub(super) colors: Vec<[u8; 3]>,
}

impl Pixels {
    pub(super) fn count(&self, is_counted: fn([u8; 3]) -> bool) -> usize {
        self.colors.iter().filter(|&&c| is_counted(c)).count()
    }

    /// How many of the four corners count.
    pub(super) fn corners(&self, is_counted: fn([u8; 3]) -> bool) -> usize {
        let (all, width) = (self.colors.len(), self.width);
        let corners = [0, width - 1, all - width, all - 1];
        corners
            .into_iter()
            .filter(|&i| is_counted(self.colors[i]))
            .count()
    }

    /// How many pixels differ from those of another picture.
    pub(super) fn differ(&self, other: &Self) -> usize {
        let pairs = self.colors.iter().zip(&other.colors);
        pairs
            .filter(|(a, b)| (0..3).any(|k| a[k].abs_diff(b[k]) > 12))
            .count()
    }

    /// The mean row of pixels that count.
    pub(super) fn height(&self, is_counted: fn([u8; 3]) -> bool) -> usize {
        self.center(is_counted)[1]
    }

    /// The mean column and row of pixels that count.
    pub(super) fn center(&self, is_counted: fn([u8; 3]) -> bool) -> [usize; 2] {
        let places = self.places(is_counted);
        let (sum, count) = places.fold(([0, 0], 0), |([a, b], n), [x, y]| ([a + x, b + y], n + 1));
        sum.map(|sum| sum / count.max(1))
    }

    /// The first and the last row with pixels that count.
    pub(super) fn rows(&self, is_counted: fn([u8; 3]) -> bool) -> Option<[usize; 2]> {
        let mut rows = self.places(is_counted).map(|[_, y]| y);
        let first = rows.next()?;
        Some([first, rows.last().unwrap_or(first)])
    }

    /// Columns and rows of pixels that count, row by row.
    fn places(&self, is_counted: fn([u8; 3]) -> bool) -> impl Iterator<Item = [usize; 2]> + '_ {
        let all = self.colors.iter().enumerate();
        let counted = all.filter(move |&(_, &color)| is_counted(color));
        counted.map(|(i, _)| [i % self.width, i / self.width])
    }
}

/// The first piece's color, in any light.
pub(super) fn is_blue([r, g, b]: [u8; 3]) -> bool {
    b > g && g > r && b - r > 35
}

/// The second piece's.
pub(super) fn is_yellow([r, g, b]: [u8; 3]) -> bool {
    r > g && g > b && r - b > 55 && u16::from(g) * 10 > u16::from(r) * 7
}

/// That of caps.
pub(super) fn is_red([r, g, b]: [u8; 3]) -> bool {
    r > 60 && u16::from(r) * 10 > u16::from(g) * 18 && u16::from(r) * 10 > u16::from(b) * 18
}
