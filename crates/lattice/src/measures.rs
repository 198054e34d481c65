//! [`Sums`]: moments of a part along the scanlines, from which those of copies and nodes follow.

use crate::grid::is_upper;
use crate::lattice::Moments;
use crate::lines::{LINES, in_cell};

/// Length of all scanlines of a full cell, along three axes [half cells].
const FULL: f64 = 96.0;
const _: () = assert!(
    6 * LINES * LINES == 96,
    "two half cells for each line of three axes"
);

/// Volume below which a part may belong to a neighbor [cells].
///
/// A node has the mass of one cell where eight full ones meet, and an eighth of its part's where it
/// has one copy: 0.015 of that at this volume. Chosen on a prototype, whose lightest nodes were
/// above a tenth of the mean with it.
const MAX_SMALL_VOLUME: f64 = 0.12;

/// Moments of a part along the scanlines, from the center of a cell [half cells].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Sums {
    /// Of 1, x, y, z, yz, zx, xy and xyz: all that is linear along each axis.
    linear: [f64; 8],
    /// Of the squares of x, y and z.
    squares: [f64; 3],
}

impl Sums {
    pub(crate) const EMPTY: Self = Self {
        linear: [0.0; 8],
        squares: [0.0; 3],
    };

    /// Returns the moments of a full cell.
    pub(crate) fn full() -> Self {
        let mut sums = Self::EMPTY;
        for axis in 0..3 {
            for number in 0..LINES * LINES {
                let mut place = [0.0; 3];
                for (i, number) in (1..).zip([number % LINES, number / LINES]) {
                    let k = (axis + i) % 3;
                    place[k] = in_cell(k, number);
                }
                sums.add_span(axis, place, 2.0);
            }
        }
        sums
    }

    /// Adds a part of a scanline, given its middle.
    pub(crate) fn add_span(&mut self, axis: usize, middle: [f64; 3], length: f64) {
        let [x, y, z] = middle;
        let values = [1.0, x, y, z, y * z, z * x, x * y, x * y * z];
        for (sum, value) in self.linear.iter_mut().zip(values) {
            *sum += length * value;
        }
        let width = 2.0 / f64::from(LINES);
        for (k, sum) in self.squares.iter_mut().enumerate() {
            let own = if k == axis { length } else { width };
            *sum += length * (middle[k] * middle[k] + own * own / 12.0);
        }
    }

    /// Adds the moments of a part in another cell, given the center of that cell.
    pub(crate) fn add_shifted(&mut self, other: &Self, center: [f64; 3]) {
        let [a, b, c] = center;
        let [m, x, y, z, yz, zx, xy, xyz] = other.linear;
        let shifted = [
            m,
            x + a * m,
            y + b * m,
            z + c * m,
            yz + b * z + c * y + b * c * m,
            zx + c * x + a * z + c * a * m,
            xy + a * y + b * x + a * b * m,
            xyz + a * yz + b * zx + c * xy + a * b * z + b * c * x + c * a * y + a * b * c * m,
        ];
        for (sum, value) in self.linear.iter_mut().zip(shifted) {
            *sum += value;
        }
        for (k, &at) in center.iter().enumerate() {
            let first = other.linear[1 + k];
            self.squares[k] += other.squares[k] + at * (2.0 * first + at * m);
        }
    }

    /// Returns the length of all scanlines [half cells].
    pub(crate) fn length(&self) -> f64 {
        self.linear[0]
    }

    /// Returns whether all numbers have the same bits.
    #[cfg(feature = "serde")]
    pub(crate) fn has_bits_of(&self, other: &Self) -> bool {
        let bits = |sums: &Self| {
            let squares = sums.squares.map(f64::to_bits);
            (sums.linear.map(f64::to_bits), squares)
        };
        bits(self) == bits(other)
    }

    /// Returns whether all numbers are finite.
    #[cfg(feature = "serde")]
    pub(crate) fn is_finite(&self) -> bool {
        let mut all = self.linear.iter().chain(&self.squares);
        all.all(|sum| sum.is_finite())
    }

    /// Returns whether a part of this size may belong to a neighbor.
    pub(crate) fn is_small(&self) -> bool {
        self.length() < MAX_SMALL_VOLUME * FULL
    }

    pub(crate) fn moments(&self) -> Moments {
        let length = self.length();
        let mean = |sum: f64| if length > 0.0 { sum / length } else { 0.0 };
        let center = [1, 2, 3].map(|i| mean(self.linear[i]));
        Moments {
            fraction: length / FULL,
            center,
            spread: [0, 1, 2].map(|k| 3.0 * (mean(self.squares[k]) - center[k] * center[k])),
        }
    }

    /// Returns the shares of the cell's corners in the volume \[m³\], by trilinear weights.
    pub(crate) fn corner_volumes(&self, cell_size: f64) -> [f64; 8] {
        let [m, x, y, z, yz, zx, xy, xyz] = self.linear;
        let unit = cell_size.powi(3) / FULL / 8.0;
        std::array::from_fn(|corner| {
            let [a, b, c] = [0, 1, 2].map(|k| if is_upper(corner, k) { 1.0 } else { -1.0 });
            let edges = b * c * yz + c * a * zx + a * b * xy;
            unit * (m + a * x + b * y + c * z + edges + a * b * c * xyz)
        })
    }
}
