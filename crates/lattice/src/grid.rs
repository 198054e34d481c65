//! [`Grid`]: a regular lattice of cubes in rest space.

use incise_mesh::{Aabb, Vec3};

/// How much longer than its cells a body may be, on both sides together [cells].
///
/// Positions have 24 bits, so that a body of a hundred cells is off by 1e-5 of one. A thousand
/// times that is still small beside a cell.
const SLACK: f64 = 0.01;

/// Rounding error of stored positions [cells], by which faces of a body may miss faces of cells.
///
/// Of a coordinate up to 16 cells from the origin, stored with 24 bits: 16 / 2^24.
pub(crate) const ROUNDING: f64 = 1e-6;

/// Margin of cells, within which parts of the surface count as theirs [cells].
pub(crate) const MARGIN: f64 = 3.0 * ROUNDING;

/// A regular lattice of cubes in rest space.
///
/// It stays where it is. Cuts only change which parts of a body its cells hold. With the feature
/// `serde`, the `finish_load` of its lattice validates it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "SavedGrid", into = "SavedGrid"))]
pub struct Grid {
    origin: Vec3,
    cell_size: f64,
    /// Number of cells in 1 m.
    density: f64,
    counts: [u32; 3],
}

/// A grid in files.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
struct SavedGrid {
    origin: [f64; 3],
    cell_size: f64,
    counts: [u32; 3],
}

#[cfg(feature = "serde")]
impl From<Grid> for SavedGrid {
    fn from(grid: Grid) -> Self {
        Self {
            origin: grid.origin.into(),
            cell_size: grid.cell_size,
            counts: grid.counts,
        }
    }
}

#[cfg(feature = "serde")]
impl From<SavedGrid> for Grid {
    fn from(saved: SavedGrid) -> Self {
        Self {
            origin: saved.origin.into(),
            cell_size: saved.cell_size,
            density: 1.0 / saved.cell_size,
            counts: saved.counts,
        }
    }
}

/// Low bits of a number of 64 bits that a cell size does not have, which leaves it ten.
const FREE_BITS: u32 = 43;

/// Parts of a cell between possible origins of grids.
///
/// With the ten bits of a cell size and eight of these, a corner up to 64 cells from the origin of
/// coordinates has 24 bits, and 32-bit storage does not round it: a lattice at rest is exactly
/// undeformed.
const PARTS_OF_CELL: f64 = 256.0;

impl Grid {
    /// Returns the cells around a box, and one more layer around them.
    ///
    /// The size of the cells \[m\] is rounded up to ten bits, by 0.2 % at most, and their corners
    /// to 1/256 of it. The box is in the middle up to that, and may exceed the cells by 1 % of one.
    #[must_use]
    pub fn around(bounds: &Aabb, cell_size: f64) -> Self {
        let mask = (1_u64 << FREE_BITS) - 1;
        let cell_size = f64::from_bits((cell_size.to_bits() + mask) & !mask);
        let [low, high] = [bounds.min, bounds.max].map(|p| Vec3::from(p.map(f64::from)));
        let extent = high - low;
        let counts = [0, 1, 2].map(|k| ceil_to_u32(extent[k] / cell_size - SLACK).max(1));
        let size = Vec3::from(counts.map(f64::from)) * cell_size;
        let origin = low + (extent - size) / 2.0 - Vec3::repeat(cell_size);
        let part = cell_size / PARTS_OF_CELL;
        Self {
            origin: origin.map(|c| (c / part).round() * part),
            cell_size,
            density: 1.0 / cell_size,
            counts: counts.map(|count| count + 2),
        }
    }

    /// Returns the corner of the first cell with the least coordinates \[m\].
    #[must_use]
    pub fn origin(&self) -> Vec3 {
        self.origin
    }

    /// Returns the length of the cells' edges \[m\].
    #[must_use]
    pub fn cell_size(&self) -> f64 {
        self.cell_size
    }

    /// Returns the numbers of cells along the axes.
    #[must_use]
    pub fn counts(&self) -> [u32; 3] {
        self.counts
    }

    /// Returns the index of a cell; those along the first axis follow each other.
    #[must_use]
    pub fn index(&self, cell: [u32; 3]) -> u32 {
        (cell[2] * self.counts[1] + cell[1]) * self.counts[0] + cell[0]
    }

    /// Returns the cell of an index.
    #[must_use]
    pub fn cell(&self, index: u32) -> [u32; 3] {
        let row = index / self.counts[0];
        [
            index % self.counts[0],
            row % self.counts[1],
            row / self.counts[1],
        ]
    }

    /// Returns the number of cells.
    pub(crate) fn cell_count(&self) -> usize {
        self.counts.iter().map(|&count| count as usize).product()
    }

    /// Returns the cell beside a face of a cell; faces are numbered by twice their axis, plus 1 for
    /// the upper one.
    pub(crate) fn beside(&self, index: u32, face: usize) -> Option<u32> {
        let axis = face / 2;
        let mut cell = self.cell(index);
        cell[axis] = if face % 2 == 1 {
            cell[axis] + 1
        } else {
            cell[axis].checked_sub(1)?
        };
        (cell[axis] < self.counts[axis]).then(|| self.index(cell))
    }

    /// Returns the coordinate of a cell's lower face along an axis \[m\].
    #[must_use]
    pub fn face(&self, axis: usize, cell: u32) -> f64 {
        self.origin[axis] + self.cell_size * f64::from(cell)
    }

    /// Returns the cell along an axis that holds a coordinate \[m\], or the nearest one.
    #[must_use]
    pub fn cell_along(&self, axis: usize, at: f64) -> u32 {
        let cell = floor_to_u32((at - self.origin[axis]) * self.density);
        cell.min(self.counts[axis] - 1)
    }

    /// Returns the cell that holds a point \[m\], or the nearest one.
    #[must_use]
    pub fn cell_at(&self, p: Vec3) -> [u32; 3] {
        [0, 1, 2].map(|k| self.cell_along(k, p[k]))
    }

    /// Returns a corner of a cell \[m\]; bit k of its number is set at the upper face of axis k.
    #[must_use]
    pub fn corner(&self, cell: [u32; 3], number: usize) -> Vec3 {
        Vec3::from_fn(|k, _| {
            self.face(k, cell[k])
                + if is_upper(number, k) {
                    self.cell_size
                } else {
                    0.0
                }
        })
    }

    /// Returns a box of all points that may be in a cell, or for which it is the nearest one.
    pub(crate) fn around_cell(&self, cell: [u32; 3]) -> [Vec3; 2] {
        let margin = Vec3::repeat(self.cell_size * ROUNDING);
        let mut low = self.corner(cell, 0) - margin;
        let mut high = self.corner(cell, 7) + margin;
        for k in 0..3 {
            if cell[k] == 0 {
                low[k] = f64::NEG_INFINITY;
            }
            if cell[k] + 1 == self.counts[k] {
                high[k] = f64::INFINITY;
            }
        }
        [low, high]
    }

    /// Returns a box of points that are in a cell, and not near others.
    pub(crate) fn inside_cell(&self, cell: [u32; 3]) -> [Vec3; 2] {
        let margin = Vec3::repeat(2.0 * self.cell_size * ROUNDING);
        [self.corner(cell, 0) + margin, self.corner(cell, 7) - margin]
    }

    /// Returns the trilinear weights of a cell's corners at a point \[m\].
    ///
    /// They add up to 1, and extrapolate outside of the cell.
    #[must_use]
    pub fn weights(&self, cell: [u32; 3], p: Vec3) -> [f64; 8] {
        let low = self.corner(cell, 0);
        let parts = [0, 1, 2].map(|k| (p[k] - low[k]) * self.density);
        std::array::from_fn(|number| {
            let part = |k: usize| match is_upper(number, k) {
                true => parts[k],
                false => 1.0 - parts[k],
            };
            part(0) * part(1) * part(2)
        })
    }
}

/// Returns whether a corner is at the upper face of an axis.
pub(crate) const fn is_upper(corner: usize, axis: usize) -> bool {
    corner >> axis & 1 == 1
}

/// Returns the largest whole number up to a value, 0 for negative ones and NaN.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "saturates"
)]
pub(crate) const fn floor_to_u32(x: f64) -> u32 {
    x as u32
}

/// Returns the least whole number from a value on, 0 for negative ones and NaN.
pub(crate) fn ceil_to_u32(x: f64) -> u32 {
    let floor = floor_to_u32(x);
    floor.saturating_add(u32::from(f64::from(floor) < x))
}
