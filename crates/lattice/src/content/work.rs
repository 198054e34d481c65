//! [`ContentWork`]: memory of updates of the triangles in cells and the crossings of scanlines.

use crate::grid::Grid;
use crate::lines::Lines;
use crate::set::Set;

/// Memory that updates of the content reuse.
#[derive(Debug, Default)]
pub(crate) struct ContentWork {
    /// By triangle slot, whether the edit removes it.
    pub(super) is_removed: Vec<bool>,
    /// Cells whose removed triangles are gone.
    pub(super) cleared: Set,
    /// By axis, the lines whose crossings may have changed.
    pub(super) changed: [Set; 3],
}

impl ContentWork {
    pub(super) fn prepare(&mut self, grid: &Grid, lines: &[Lines; 3], triangle_slots: usize) {
        self.cleared.reset(grid.cell_count());
        self.is_removed
            .resize(triangle_slots.max(self.is_removed.len()), false);
        for (changed, lines) in self.changed.iter_mut().zip(lines) {
            changed.reset(lines.count());
        }
    }
}
