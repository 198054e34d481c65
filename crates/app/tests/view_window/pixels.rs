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

    /// How many pixels differ from those of another picture.
    pub(super) fn differ(&self, other: &Self) -> usize {
        let pairs = self.colors.iter().zip(&other.colors);
        pairs
            .filter(|(a, b)| (0..3).any(|k| a[k].abs_diff(b[k]) > 12))
            .count()
    }

    /// The mean row of pixels that count.
    pub(super) fn height(&self, is_counted: fn([u8; 3]) -> bool) -> usize {
        let rows = self.colors.chunks(self.width).enumerate();
        let of_row = |row: &[[u8; 3]]| row.iter().filter(|&&c| is_counted(c)).count();
        let (sum, count) = rows.fold((0, 0), |(sum, count), (y, row)| {
            let n = of_row(row);
            (sum + y * n, count + n)
        });
        sum / count.max(1)
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
