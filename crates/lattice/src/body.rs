//! [`Body`]: a surface at rest in the cells of a grid.

use crate::grid::Grid;
use crate::lines::Lines;
use incise_mesh::{Surface, TriangleId};

/// A surface at rest in the cells of a grid, with the scanlines along each axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Body<'a> {
    pub(crate) surface: &'a Surface,
    pub(crate) grid: &'a Grid,
    pub(crate) lines: [Lines; 3],
}

impl<'a> Body<'a> {
    pub(crate) fn new(surface: &'a Surface, grid: &'a Grid) -> Self {
        Self {
            surface,
            grid,
            lines: Lines::along_axes(grid),
        }
    }

    /// Returns the piece of a triangle; [`u32::MAX`] for one without a slot.
    pub(crate) fn piece(&self, t: TriangleId) -> u32 {
        // Crossings of a surface that was edited unseen may name triangles that are gone.
        if t.index() < self.surface.topology().triangle_slots() {
            self.surface.piece(t)
        } else {
            u32::MAX
        }
    }
}
