//! [`Lines`]: the scanlines along an axis.

use crate::grid::{Grid, ceil_to_u32, floor_to_u32};
use incise_mesh::Vec3;
use std::ops::Range;

/// Number of scanlines across a cell, along each edge of a face.
pub(crate) const LINES: u32 = 4;

/// Distance of the first scanline from the lower faces, by axis [distances of scanlines].
///
/// Near the middle of their intervals, but off vertices and edges of regular meshes.
const OFFSETS: [f64; 3] = [0.513_717, 0.482_607, 0.507_911];

/// The scanlines along an axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lines {
    pub(crate) axis: usize,
    /// The other axes.
    pub(crate) across: [usize; 2],
    origin: Vec3,
    distance: f64,
    /// Number of scanlines in 1 m.
    density: f64,
    /// Numbers of scanlines along each axis.
    counts: [u32; 3],
}

impl Lines {
    /// Returns the scanlines along all axes.
    pub(crate) fn along_axes(grid: &Grid) -> [Self; 3] {
        [0, 1, 2].map(|axis| Self {
            axis,
            across: [(axis + 1) % 3, (axis + 2) % 3],
            origin: grid.origin(),
            distance: grid.cell_size() / f64::from(LINES),
            density: f64::from(LINES) / grid.cell_size(),
            counts: grid.counts().map(|count| count * LINES),
        })
    }

    /// Returns the number of scanlines along the axis.
    pub(crate) fn count(&self) -> usize {
        let [u, v] = self.across;
        self.counts[u] as usize * self.counts[v] as usize
    }

    /// Returns the index of a scanline, given its numbers along both axes across it.
    pub(crate) fn index(&self, i: u32, j: u32) -> u32 {
        j * self.counts[self.across[0]] + i
    }

    /// Returns the numbers of a scanline along both axes across it.
    pub(crate) fn numbers(&self, line: u32) -> [u32; 2] {
        let row = self.counts[self.across[0]];
        [line % row, line / row]
    }

    /// Returns the coordinate of a scanline along an axis across it \[m\].
    pub(crate) fn at(&self, axis: usize, number: u32) -> f64 {
        let offset = f64::from(number) + OFFSETS[axis];
        self.origin[axis] + self.distance * offset
    }

    /// Returns the numbers of the scanlines along an axis between two coordinates \[m\].
    pub(crate) fn between(&self, axis: usize, low: f64, high: f64) -> Range<u32> {
        let number = |at: f64| (at - self.origin[axis]) * self.density - OFFSETS[axis];
        let last = number(high);
        if last < 0.0 || last.is_nan() {
            return 0..0;
        }
        let end = floor_to_u32(last).saturating_add(1);
        ceil_to_u32(number(low))..end.min(self.counts[axis])
    }
}

/// Returns the coordinate of a scanline in its cell, from the center [half cells].
pub(crate) fn in_cell(axis: usize, number: u32) -> f64 {
    (f64::from(number % LINES) + OFFSETS[axis]) * (2.0 / f64::from(LINES)) - 1.0
}
