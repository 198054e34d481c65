//! Spans: parts of scanlines inside of a body and in a cell.

use super::{CellSolver, Measure};
use crate::body::Body;
use crate::content::Content;
use crate::crossings::Interval;
use crate::grid::ROUNDING;
use crate::lines::{LINES, in_cell};
use crate::measures::Sums;
use incise_mesh::{TriangleId, index_u32};

/// Number of spans in a full cell.
const FULL_SPANS: usize = (3 * LINES * LINES) as usize;

/// A part of a scanline inside of a body and in the cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    pub(super) axis: usize,
    /// The numbers of its scanline along both axes across it.
    pub(super) numbers: [u32; 2],
    /// Its ends along the axis \[m\].
    pub(super) from: f64,
    pub(super) to: f64,
    /// The triangle at which its interval enters the body.
    pub(super) entry: TriangleId,
    /// The triangles at its ends, where these lie in the cell.
    pub(super) ends: [Option<TriangleId>; 2],
}

impl Span {
    /// Returns its place across its axis, and 0 along it, from the cell's center [half cells].
    pub(super) fn place_across(&self) -> [f64; 3] {
        let mut place = [0.0; 3];
        for (i, number) in (1..).zip(self.numbers) {
            let k = (self.axis + i) % 3;
            place[k] = in_cell(k, number);
        }
        place
    }
}

impl CellSolver {
    /// Finds the spans along the scanlines of a cell.
    pub(super) fn add_spans(&mut self, body: &Body<'_>, content: &Content, cell: [u32; 3]) {
        self.spans.clear();
        self.inside = [0; 6];
        for passing in &mut self.passing {
            passing.clear();
        }
        let grid = body.grid;
        let rounding = 4.0 * ROUNDING * grid.cell_size();
        let count = index_u32(self.triangles.len());
        for lines in &body.lines {
            let axis = lines.axis;
            let own = cell[axis];
            let [u, v] = lines.across.map(|k| LINES * cell[k]);
            let (low, high) = (grid.face(axis, own), grid.face(axis, own + 1));
            let range = [low - rounding, high + rounding];
            for number in 0..LINES * LINES {
                let numbers = [u + number % LINES, v + number / LINES];
                let line = lines.index(numbers[0], numbers[1]);
                let crossings = &content.crossings;
                crossings.intervals(body, axis, line, range, &mut self.intervals);
                for Interval { entry, exit } in &self.intervals {
                    let is_below = entry.at < range[0] || grid.cell_along(axis, entry.at) < own;
                    let is_above = exit.at > range[1] || grid.cell_along(axis, exit.at) > own;
                    let starts_above = entry.at >= high && grid.cell_along(axis, entry.at) > own;
                    let ends_below = exit.at <= low && grid.cell_along(axis, exit.at) < own;
                    if starts_above || ends_below {
                        continue;
                    }
                    let element = count + index_u32(self.spans.len());
                    if is_below {
                        self.passing[2 * axis].push(element);
                        self.inside[2 * axis] |= 1 << number;
                    }
                    if is_above {
                        self.passing[2 * axis + 1].push(element);
                        self.inside[2 * axis + 1] |= 1 << number;
                    }
                    // An end within rounding of the face bounds the part on its other side as well.
                    let has_entry = !is_below || low - entry.at < rounding;
                    let has_exit = !is_above || exit.at - high < rounding;
                    self.spans.push(Span {
                        axis,
                        numbers,
                        from: if is_below { low } else { entry.at },
                        to: if is_above { high } else { exit.at },
                        entry: entry.triangle(),
                        ends: [
                            has_entry.then(|| entry.triangle()),
                            has_exit.then(|| exit.triangle()),
                        ],
                    });
                }
            }
        }
    }

    /// Returns whether the cell lies inside of one piece.
    pub(super) fn is_full(&self, body: &Body<'_>) -> bool {
        let piece = |span: &Span| body.piece(span.entry);
        self.triangles.is_empty()
            && self.spans.len() == FULL_SPANS
            && self.inside == [u16::MAX; 6]
            && self
                .spans
                .iter()
                .all(|span| piece(span) == piece(&self.spans[0]))
    }

    /// Makes one part of a full cell.
    pub(super) fn take_full(&mut self) {
        let sums = *self.full.get_or_insert_with(Sums::full);
        let reaches = Measure::EMPTY.reaches;
        self.parts.clear();
        self.parts.push(Measure { sums, reaches });
        self.part_of.clear();
        self.part_of.resize(FULL_SPANS, 0);
        for passing in &mut self.passing {
            passing.fill(0);
        }
    }
}
