//! [`Fragments`]: the parts of triangles in cells.

use crate::grid::Grid;
use crate::overlap::{edge_meets_box, triangle_meets_box};
use crate::skin::Skin;
use incise_mesh::{Vec3, index_u32};
use std::ops::Range;

/// Rounding error of stored positions [cells], by which faces of a body may miss faces of cells.
///
/// Of a coordinate up to 16 cells from the origin, stored with 24 bits: 16 / 2^24.
pub(crate) const ROUNDING: f64 = 1e-6;

/// The parts of triangles in cells, by triangle and then by cell.
#[derive(Debug)]
pub(crate) struct Fragments {
    starts: Vec<u32>,
    cells: Vec<u32>,
    triangles: Vec<u32>,
}

impl Fragments {
    /// Collects the fragments of all triangles.
    pub(crate) fn new(grid: &Grid, skin: &Skin) -> Self {
        let size = grid.cell_size();
        let half = Vec3::repeat(size * (0.5 + ROUNDING));
        let mut fragments = Self {
            starts: vec![0],
            cells: Vec::new(),
            triangles: Vec::new(),
        };
        for (t, corners) in (0..).zip(&skin.corners) {
            let [a, b, c] = corners;
            let margin = Vec3::repeat(ROUNDING * size);
            let low = grid.cell_at(a.inf(b).inf(c) - margin);
            let high = grid.cell_at(a.sup(b).sup(c) + margin);
            if low == high {
                fragments.cells.push(grid.index(low));
                fragments.triangles.push(t);
                fragments.starts.push(index_u32(fragments.cells.len()));
                continue;
            }
            for z in low[2]..=high[2] {
                for y in low[1]..=high[1] {
                    for x in low[0]..=high[0] {
                        let center = grid.corner([x, y, z], 0) + Vec3::repeat(size / 2.0);
                        if triangle_meets_box(corners, center, half) {
                            fragments.cells.push(grid.index([x, y, z]));
                            fragments.triangles.push(t);
                        }
                    }
                }
            }
            fragments.starts.push(index_u32(fragments.cells.len()));
        }
        fragments
    }

    pub(crate) fn len(&self) -> u32 {
        index_u32(self.cells.len())
    }

    pub(crate) fn cell(&self, fragment: u32) -> u32 {
        self.cells[fragment as usize]
    }

    pub(crate) fn triangle(&self, fragment: u32) -> u32 {
        self.triangles[fragment as usize]
    }

    /// Returns the fragments of a triangle.
    pub(crate) fn of(&self, triangle: u32) -> Range<u32> {
        self.starts[triangle as usize]..self.starts[triangle as usize + 1]
    }

    /// Returns the fragment of a triangle in a cell.
    pub(crate) fn find(&self, triangle: u32, cell: u32) -> Option<u32> {
        let own = self.of(triangle);
        let cells = &self.cells[own.start as usize..own.end as usize];
        let found = cells.binary_search(&cell).ok()?;
        Some(own.start + index_u32(found))
    }

    /// Calls `join` with the fragments of neighboring triangles that share a part of their edge in
    /// a cell.
    pub(crate) fn join_along_edges(
        &self,
        grid: &Grid,
        skin: &Skin,
        mut join: impl FnMut(u32, u32),
    ) {
        let size = grid.cell_size();
        let margin = Vec3::repeat(3.0 * ROUNDING * size);
        for edge in &skin.edges {
            for fragment in self.of(edge.triangles[0]) {
                let cell = self.cell(fragment);
                let Some(other) = self.find(edge.triangles[1], cell) else {
                    continue;
                };
                // Triangles in one cell have their edges there.
                if edge.triangles.iter().all(|&t| self.of(t).len() == 1) {
                    join(fragment, other);
                    continue;
                }
                let low = grid.corner(grid.cell(cell), 0);
                let high = low + Vec3::repeat(size);
                if edge_meets_box(edge.ends, low - margin, high + margin) {
                    join(fragment, other);
                }
            }
        }
    }

    /// Calls `join` with the fragments of a triangle on both sides of the faces that it crosses,
    /// the lower one first, and the axis.
    pub(crate) fn join_across_faces(
        &self,
        grid: &Grid,
        skin: &Skin,
        mut join: impl FnMut(u32, u32, usize),
    ) {
        let size = grid.cell_size();
        for (t, corners) in (0..).zip(&skin.corners) {
            let own = self.of(t);
            if own.len() < 2 {
                continue;
            }
            for low in own {
                let cell = grid.cell(self.cell(low));
                for axis in 0..3 {
                    let mut above = cell;
                    above[axis] += 1;
                    let is_cell = above[axis] < grid.counts()[axis];
                    let high = is_cell.then(|| self.find(t, grid.index(above))).flatten();
                    let Some(high) = high else { continue };
                    let mut center = grid.corner(above, 0) + Vec3::repeat(size / 2.0);
                    center[axis] -= size / 2.0;
                    let mut half = Vec3::repeat(size * (0.5 + ROUNDING));
                    half[axis] = ROUNDING * size;
                    if triangle_meets_box(corners, center, half) {
                        join(low, high, axis);
                    }
                }
            }
        }
    }
}
