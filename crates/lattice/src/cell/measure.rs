//! Measures of the parts in a cell.

use super::CellSolver;
use crate::grid::{Grid, MARGIN};
use crate::measures::Sums;
use crate::overlap::clip_triangle;
use incise_mesh::Vec3;

/// A part of a body in a cell, as measured.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Measure {
    pub(crate) sums: Sums,
    /// By face, the reach of a small part from there into its cell [cells].
    pub(crate) reaches: [f32; 6],
}

impl Measure {
    pub(crate) const EMPTY: Self = Self {
        sums: Sums::EMPTY,
        reaches: [f32::NEG_INFINITY; 6],
    };
}

impl CellSolver {
    /// Measures the parts along the scanlines, and the reaches of small ones.
    pub(super) fn measure(&mut self, grid: &Grid, cell: [u32; 3]) {
        let size = grid.cell_size();
        let low = grid.corner(cell, 0);
        let count = self.triangles.len();
        for (span, &part) in self.spans.iter().zip(&self.part_of[count..]) {
            let axis = span.axis;
            let mut middle = span.place_across();
            let place = (span.from + span.to) / 2.0 - low[axis];
            middle[axis] = place * (2.0 / size) - 1.0;
            let length = (span.to - span.from) * (2.0 / size);
            self.parts[part as usize]
                .sums
                .add_span(axis, middle, length);
        }
        if self.parts.iter().all(|part| !part.sums.is_small()) {
            return;
        }
        let margin = Vec3::repeat(MARGIN * size);
        let (from, to) = (low - margin, low + Vec3::repeat(size) + margin);
        for (corners, &part) in self.corners.iter().zip(&self.part_of) {
            let part = &mut self.parts[part as usize];
            if part.sums.is_small() {
                clip_triangle(corners, from, to, |p| {
                    let at = (p - low) / size;
                    for k in 0..3 {
                        let reaches = &mut part.reaches;
                        reaches[2 * k] = reaches[2 * k].max(round_to_f32(at[k]));
                        reaches[2 * k + 1] = reaches[2 * k + 1].max(round_to_f32(1.0 - at[k]));
                    }
                });
            }
        }
    }
}

/// Rounds to storage.
#[expect(clippy::cast_possible_truncation, reason = "reaches are only compared")]
fn round_to_f32(x: f64) -> f32 {
    x as f32
}
