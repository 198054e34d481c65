//! [`Content`]: the triangles in each cell, and the crossings of each scanline.

#[cfg(feature = "serde")]
mod load;
mod work;

pub(crate) use work::ContentWork;

use crate::body::Body;
use crate::crossings::Crossings;
use crate::grid::{Grid, ROUNDING};
use crate::lines::{LINES, Lines};
use crate::overlap::{bounds, is_in_box, triangle_meets_box};
use crate::projection::{Passage, Projection, Sorted};
use crate::set::Set;
use incise_mesh::{TopologyDelta, TriangleId, Vec3, VertexId};
use std::collections::BTreeMap;

/// The cells around a triangle, from the lowest to the highest one along each axis.
#[derive(Debug, Clone, Copy, PartialEq)]
struct CellBox {
    low: [u16; 3],
    high: [u16; 3],
}

impl CellBox {
    const EMPTY: Self = Self {
        low: [1; 3],
        high: [0; 3],
    };

    fn cells(self) -> impl Iterator<Item = [u32; 3]> {
        let range = move |k: usize| u32::from(self.low[k])..=u32::from(self.high[k]);
        range(2).flat_map(move |z| range(1).flat_map(move |y| range(0).map(move |x| [x, y, z])))
    }

    fn is_empty(self) -> bool {
        self.low[0] > self.high[0]
    }
}

/// The triangles in each cell, and the crossings of each scanline.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Content {
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) crossings: Crossings,
    /// By cell, the triangles that meet it, ascending.
    #[cfg_attr(feature = "serde", serde(skip))]
    triangles: Vec<Vec<u32>>,
    /// By triangle slot, the cells around it.
    #[cfg_attr(feature = "serde", serde(skip))]
    boxes: Vec<CellBox>,
    /// By cell and axis, the scanlines that pass its lower face inside of the body.
    pub(crate) inside: Vec<[u16; 3]>,
    /// Cells whose parts depend on which of their triangles belong to one piece.
    ///
    /// Of triangles that are connected in the cell, the first one, and its piece when the cell was
    /// solved.
    #[cfg_attr(feature = "serde", serde(with = "crate::pairs"))]
    pub(crate) witnesses: BTreeMap<u32, Vec<(TriangleId, u32)>>,
}

impl Content {
    pub(crate) fn new(grid: &Grid) -> Self {
        let count = grid.cell_count();
        Self {
            crossings: Crossings::new(&Lines::along_axes(grid)),
            triangles: vec![Vec::new(); count],
            boxes: Vec::new(),
            inside: vec![[0; 3]; count],
            witnesses: BTreeMap::new(),
        }
    }

    /// Returns the triangles that meet a cell, ascending.
    pub(crate) fn triangles(&self, cell: u32) -> &[u32] {
        &self.triangles[cell as usize]
    }

    /// Returns the faces of a cell with cells behind them that a triangle in it may lie in, one bit
    /// each.
    pub(crate) fn faces_before(&self, t: TriangleId, cell: [u32; 3]) -> u8 {
        let Some(own) = self.boxes.get(t.index()) else {
            return 0;
        };
        (0..3).fold(0, |faces, k| {
            let is_below = u32::from(own.low[k]) < cell[k];
            let is_above = u32::from(own.high[k]) > cell[k];
            faces | u8::from(is_below) << (2 * k) | u8::from(is_above) << (2 * k + 1)
        })
    }

    /// Returns whether a triangle that meets one of two neighboring cells, the lower one first,
    /// meets the face between them.
    pub(crate) fn meets_face(
        &self,
        body: &Body<'_>,
        t: TriangleId,
        cells: [u32; 2],
        axis: usize,
    ) -> bool {
        let lower = body.grid.cell(cells[0])[axis];
        let own = self.boxes.get(t.index());
        let is_on_both = own.is_some_and(|own| {
            u32::from(own.low[axis]) <= lower && lower < u32::from(own.high[axis])
        });
        if !is_on_both || cells.iter().any(|&cell| !self.holds(cell, t)) {
            return false;
        }
        let topology = body.surface.topology();
        if t.index() >= topology.triangle_slots() || !topology.is_triangle(t) {
            return false;
        }
        let corners = topology.triangle(t).map(|v| body.surface.rest_position(v));
        let size = body.grid.cell_size();
        let upper = body.grid.cell(cells[1]);
        let mut center = body.grid.corner(upper, 0) + Vec3::repeat(size / 2.0);
        center[axis] -= size / 2.0;
        let mut half = Vec3::repeat(size * (0.5 + ROUNDING));
        half[axis] = ROUNDING * size;
        triangle_meets_box(&corners, center, half)
    }

    /// Returns whether a triangle meets a cell.
    fn holds(&self, cell: u32, t: TriangleId) -> bool {
        self.triangles(cell).binary_search(&t.0).is_ok()
    }

    /// Removes and adds triangles. Collects the cells whose content that changes.
    pub(crate) fn update(
        &mut self,
        body: &Body<'_>,
        removed: &[(TriangleId, [VertexId; 3])],
        added: &[TriangleId],
        work: &mut ContentWork,
        touched: &mut Set,
    ) {
        let &Body {
            surface,
            grid,
            lines,
        } = body;
        self.boxes.resize(
            surface.topology().triangle_slots().max(self.boxes.len()),
            CellBox::EMPTY,
        );
        work.prepare(grid, &lines, self.boxes.len());
        self.remove(grid, &lines, removed, work, touched);
        for &t in added {
            if surface.topology().is_triangle(t) {
                self.add(body, t, work, touched);
            }
        }
        // An undo takes slots away.
        let slots = surface.topology().triangle_slots();
        while self.boxes.len() > slots && self.boxes.last().is_some_and(|own| own.is_empty()) {
            self.boxes.pop();
        }
        for &cell in &touched.members {
            let own = &mut self.triangles[cell as usize];
            own.sort_unstable();
            own.dedup();
        }
        for (axis, lines) in lines.iter().enumerate() {
            for &line in &work.changed[axis].members {
                if self.crossings.update_regularity(body, axis, line) {
                    touch_line(grid, lines, line, touched);
                }
            }
        }
    }

    /// Touches the cells whose parts change because pieces are split or joined.
    pub(crate) fn touch_pieces(
        &mut self,
        body: &Body<'_>,
        delta: &TopologyDelta,
        touched: &mut Set,
    ) {
        let is_split = delta.pieces_added.iter().any(|added| added.0 != added.1);
        if !is_split && delta.pieces_removed.is_empty() {
            return;
        }
        let mut irregular = Vec::new();
        self.crossings.update_pieces(body, &mut irregular);
        for (axis, line) in irregular {
            touch_line(body.grid, &body.lines[axis], line, touched);
        }
        let topology = body.surface.topology();
        for (&cell, own) in &self.witnesses {
            let is_live = own.iter().all(|own| {
                own.0.index() < topology.triangle_slots() && topology.is_triangle(own.0)
            });
            let piece = |i: usize| body.piece(own[i].0);
            let is_changed = |i: usize, j: usize| (own[i].1 == own[j].1) != (piece(i) == piece(j));
            let mut pairs = (0..own.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
            // Touched cells may name triangles that are gone.
            if !is_live || pairs.any(|(i, j)| is_changed(i, j)) {
                touched.insert(cell);
            }
        }
    }

    /// Removes triangles and their crossings.
    fn remove(
        &mut self,
        grid: &Grid,
        lines: &[Lines; 3],
        removed: &[(TriangleId, [VertexId; 3])],
        work: &mut ContentWork,
        touched: &mut Set,
    ) {
        let count = self.boxes.len();
        let slots = removed.iter().map(|removed| removed.0.index());
        let slots = slots.filter(|&slot| slot < count);
        for slot in slots.clone() {
            work.is_removed[slot] = true;
        }
        for slot in slots.clone() {
            for cell in self.boxes[slot].cells() {
                let index = grid.index(cell);
                if work.cleared.insert(index) {
                    let own = &mut self.triangles[index as usize];
                    let count = own.len();
                    own.retain(|&t| !work.is_removed[t as usize]);
                    if own.len() < count {
                        touched.insert(index);
                    }
                    for (axis, lines) in lines.iter().enumerate() {
                        self.clear_lines(grid, lines, axis, cell, work, touched);
                    }
                }
            }
        }
        for slot in slots {
            self.boxes[slot] = CellBox::EMPTY;
            work.is_removed[slot] = false;
        }
        work.cleared.clear();
    }

    /// Removes the crossings of removed triangles along the lines of a cell.
    fn clear_lines(
        &mut self,
        grid: &Grid,
        lines: &Lines,
        axis: usize,
        cell: [u32; 3],
        work: &mut ContentWork,
        touched: &mut Set,
    ) {
        let [u, v] = lines.across;
        for j in LINES * cell[v]..LINES * (cell[v] + 1) {
            for i in LINES * cell[u]..LINES * (cell[u] + 1) {
                let line = lines.index(i, j);
                if !work.changed[axis].insert(line) {
                    continue;
                }
                let is_removed = &work.is_removed;
                let is_removed = |t: TriangleId| is_removed.get(t.index()) == Some(&true);
                self.crossings.remove(axis, line, is_removed, |at| {
                    let mut place = cell;
                    place[axis] = grid.cell_along(axis, at);
                    touched.insert(grid.index(place));
                });
            }
        }
    }

    /// Adds a triangle and its crossings.
    fn add(&mut self, body: &Body<'_>, t: TriangleId, work: &mut ContentWork, touched: &mut Set) {
        let (surface, grid, lines) = (body.surface, body.grid, &body.lines);
        if !self.boxes[t.index()].is_empty() {
            return;
        }
        let corners = surface
            .topology()
            .triangle(t)
            .map(|v| surface.rest_position(v));
        self.add_to_cells(grid, t, &corners, |cell| {
            touched.insert(cell);
        });
        find_crossings(body, &corners, |axis, numbers, passage| {
            let lines = &lines[axis];
            let [u, v] = lines.across;
            let line = lines.index(numbers[0], numbers[1]);
            self.crossings.insert(axis, line, t, passage);
            work.changed[axis].insert(line);
            let mut cell = [0; 3];
            cell[axis] = grid.cell_along(axis, passage.at);
            cell[u] = numbers[0] / LINES;
            cell[v] = numbers[1] / LINES;
            touched.insert(grid.index(cell));
        });
    }

    /// Adds a triangle to the cells that it meets, and calls `added` with these.
    fn add_to_cells(
        &mut self,
        grid: &Grid,
        t: TriangleId,
        corners: &[Vec3; 3],
        mut added: impl FnMut(u32),
    ) {
        let size = grid.cell_size();
        let [low, high] = cells_around(grid, corners);
        self.boxes[t.index()] = CellBox {
            low: low.map(to_u16),
            high: high.map(to_u16),
        };
        let half = Vec3::repeat(size * (0.5 + ROUNDING));
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    let cell = [x, y, z];
                    if low != high {
                        let own = [grid.corner(cell, 0), grid.corner(cell, 7)];
                        let center = own[0] + Vec3::repeat(size / 2.0);
                        let meets = corners.iter().any(|p| is_in_box(p, &own))
                            || triangle_meets_box(corners, center, half);
                        if !meets {
                            continue;
                        }
                    }
                    let index = grid.index(cell);
                    self.triangles[index as usize].push(t.0);
                    added(index);
                }
            }
        }
    }
}

/// Returns the lowest and the highest cell around a triangle.
fn cells_around(grid: &Grid, corners: &[Vec3; 3]) -> [[u32; 3]; 2] {
    let [min, max] = bounds(corners);
    let margin = Vec3::repeat(ROUNDING * grid.cell_size());
    [grid.cell_at(min - margin), grid.cell_at(max + margin)]
}

/// Distance by which scanlines enter a body late [cells].
///
/// The walls of an incision in a deformed body coincide at rest up to the rounding of positions and
/// of rest positions, each [`ROUNDING`]. A line that entered one wall before it has left the other
/// would join both sides.
const WALL_GAP: f64 = 3.0 * ROUNDING;

/// Calls `found` with each crossing of a triangle: axis, numbers of the scanline, and crossing.
fn find_crossings(
    body: &Body<'_>,
    corners: &[Vec3; 3],
    mut found: impl FnMut(usize, [u32; 2], Passage),
) {
    let lines = &body.lines;
    let [min, max] = bounds(corners);
    let ranges: [_; 3] =
        std::array::from_fn(|axis| lines[axis].between(axis, min[axis], max[axis]));
    if ranges.iter().filter(|range| range.is_empty()).count() > 1 {
        return;
    }
    let sorted = Sorted::new(corners);
    let gap = WALL_GAP * body.grid.cell_size();
    for (axis, lines) in lines.iter().enumerate() {
        let [u, v] = lines.across;
        if ranges[u].is_empty() || ranges[v].is_empty() {
            continue;
        }
        let projection = Projection::new(&sorted, axis, [u, v]);
        for j in ranges[v].clone() {
            for i in ranges[u].clone() {
                let place = [lines.at(u, i), lines.at(v, j)];
                if let Some(mut passage) = projection.crossing(place) {
                    if !passage.leaves {
                        passage.at += gap;
                    }
                    found(axis, [i, j], passage);
                }
            }
        }
    }
}

/// Touches all cells along a line.
fn touch_line(grid: &Grid, lines: &Lines, line: u32, touched: &mut Set) {
    let [u, v] = lines.across;
    let [i, j] = lines.numbers(line);
    let mut cell = [0; 3];
    cell[u] = i / LINES;
    cell[v] = j / LINES;
    for along in 0..grid.counts()[lines.axis] {
        cell[lines.axis] = along;
        touched.insert(grid.index(cell));
    }
}

/// Returns a coordinate of a cell in storage.
fn to_u16(cell: u32) -> u16 {
    u16::try_from(cell).unwrap_or(u16::MAX)
}
