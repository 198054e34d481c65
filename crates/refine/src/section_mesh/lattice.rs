//! The core of a section mesh: a triangular lattice clipped to the inside of the loops.
//!
//! The triangles inside the loops are rasterized row by row, as on a screen. Every lattice point
//! falls into one triangle, which gives its parents and weights. With a clearance above L / sqrt(3)
//! no point of a loop lies in the circumcircle of a lattice triangle. Lattice triangles are
//! therefore Delaunay without a test.
//!
//! Where targets differ, [`graded`] keeps the points of coarser lattices only.

mod graded;
mod triangles;

use super::barycentric::{Crossing, Side, weights_between};
use super::loop_triangulation::{INSIDE, LoopTriangulation};
use incise_mesh::index_u32;

/// Minimum distance of lattice points from loops, relative to L; above 1 / sqrt(3).
const CLEARANCE: f64 = 0.6;
/// Offset of each row from the row below, in columns, besides one half.
///
/// Four points of a lattice are then on no circle, and predicates need no exact arithmetic.
const SHEAR: f64 = 1e-7;

/// The lattice points of one row in one triangle of the loops.
#[derive(Debug, Clone, Copy)]
struct Run {
    row: i64,
    /// First column and end column.
    columns: [i64; 2],
    /// The triangle's left and right sides where the row crosses them.
    sides: [Side; 2],
}

/// Consecutive columns of one row, and the number of the first point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    pub(crate) columns: [i64; 2],
    pub(crate) first: u32,
}

/// A point near an edge of a loop.
#[derive(Debug, Clone, Copy)]
struct NearPoint {
    /// Number of the point among all points.
    point: usize,
    /// Squared distance from the edge.
    distance: f64,
    /// Nearest place along the edge, 0 to 1.
    along: f64,
}

/// The lattice over one group of loops.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lattice {
    /// Spacing L of the points, in the section's scale.
    pub(crate) length: f64,
    /// Distance between rows.
    height: f64,
    /// Position of row 0, column 0.
    base: [f64; 2],
    pub(crate) first_row: i64,
    runs: Vec<Run>,
    /// First column and number of each run, row after row.
    order: Vec<(i64, u32)>,
    buckets: Vec<u32>,
    /// Spans of all points, kept or not.
    spans: Vec<Span>,
    /// Start of each row in `spans`, and the end of the last.
    rows: Vec<usize>,
    /// Whether each point is left out.
    dropped: Vec<bool>,
    /// Target at each point far from the rim, and limited by the rim.
    far: Vec<f64>,
    sizes: Vec<f64>,
    /// Squared distance of each point from the loops; infinite beyond the clearance.
    distances: Vec<f64>,
    /// Spans of kept points.
    pub(crate) kept: Vec<Span>,
    /// Start of each row in `kept`, and the end of the last.
    pub(crate) kept_rows: Vec<usize>,
    /// Bit set of each kept point: 1 for a triangle above the edge to its right, 2 for one below.
    pub(crate) sides: Vec<u8>,
    /// Whether each kept point is the corner of a lattice triangle.
    pub(crate) in_core: Vec<bool>,
    /// Target of each kept point of a graded lattice.
    pub(crate) targets: Vec<f64>,
    /// Positions of kept points, then of points that refinement inserts.
    pub(crate) points: Vec<[f64; 2]>,
    /// Parents of each point among the triangulation's vertices.
    pub(crate) parents: Vec<[u32; 3]>,
    /// Weights of the parents.
    pub(crate) weights: Vec<[f64; 3]>,
    /// Edges between the core and the band, with the core on the left.
    pub(crate) boundary: Vec<[u32; 2]>,
    /// Whether each kept point belongs to the band.
    pub(crate) in_band: Vec<bool>,
}

impl Lattice {
    pub(crate) fn clear(&mut self) {
        self.targets.clear();
        self.points.clear();
        self.parents.clear();
        self.weights.clear();
        self.boundary.clear();
        self.in_band.clear();
        self.in_core.clear();
        self.kept.clear();
        self.kept_rows.clear();
    }

    /// Places points with spacing `length` inside the loops.
    ///
    /// Returns false if there would be more than `most` points.
    pub(crate) fn fill(
        &mut self,
        triangulation: &LoopTriangulation,
        length: f64,
        most: usize,
    ) -> bool {
        self.clear();
        self.length = length;
        self.height = length * 0.75f64.sqrt();
        self.base = triangulation.low;
        if !self.rasterize(triangulation, most) {
            return false;
        }
        self.collect_spans();
        self.drop_near_loops(triangulation);
        self.number_kept();
        true
    }

    /// Returns memory that the next filling overwrites.
    pub(crate) fn scratch(&mut self) -> &mut Vec<f64> {
        &mut self.sizes
    }

    fn y(&self, row: i64) -> f64 {
        self.base[1] + count(row) * self.height
    }

    fn x(&self, row: i64, column: i64) -> f64 {
        self.base[0] + (count(column) + shift(row)) * self.length
    }

    /// Returns the first row at or above `y`.
    fn row_from(&self, y: f64) -> i64 {
        let mut row = whole((y - self.base[1]) / self.height);
        while self.y(row) < y {
            row += 1;
        }
        while self.y(row - 1) >= y {
            row -= 1;
        }
        row
    }

    /// Returns the first column of a row at or right of `x`.
    fn column_from(&self, row: i64, x: f64) -> i64 {
        let mut column = whole((x - self.base[0]) / self.length - shift(row));
        while self.x(row, column) < x {
            column += 1;
        }
        while self.x(row, column - 1) >= x {
            column -= 1;
        }
        column
    }

    /// Collects the runs of all triangles; returns false above `most` points.
    fn rasterize(&mut self, triangulation: &LoopTriangulation, most: usize) -> bool {
        self.runs.clear();
        let cdt = &triangulation.cdt;
        let mut found = 0usize;
        for t in 0..cdt.triangles() {
            if cdt.region[t as usize] != INSIDE {
                continue;
            }
            let rows = Crossing::of(cdt, t);
            let (from, to) = (self.row_from(rows.ys[0]), self.row_from(rows.ys[2]));
            if usize::try_from(to - from).map_or(true, |rows| rows / 4 > most) {
                return false;
            }
            for row in from..to {
                let sides = rows.at(cdt, self.y(row));
                let columns = [
                    self.column_from(row, sides[0].x),
                    self.column_from(row, sides[1].x),
                ];
                if columns[0] < columns[1] {
                    found += usize::try_from(columns[1] - columns[0]).unwrap_or(usize::MAX / 2);
                    if found > most {
                        return false;
                    }
                    self.runs.push(Run {
                        row,
                        columns,
                        sides,
                    });
                }
            }
        }
        self.sort_runs();
        true
    }

    /// Sorts the runs by row and column, with one bucket for each row.
    fn sort_runs(&mut self) {
        let rows = self.runs.iter().map(|run| run.row);
        let (first, last) = (rows.clone().min().unwrap_or(0), rows.max().unwrap_or(-1));
        let count = usize::try_from(last - first + 1).unwrap_or(0);
        let bucket = |row: i64| usize::try_from(row - first).unwrap_or(0);
        self.first_row = first;
        self.buckets.clear();
        self.buckets.resize(count + 1, 0);
        for run in &self.runs {
            self.buckets[bucket(run.row) + 1] += 1;
        }
        for row in 0..count {
            self.buckets[row + 1] += self.buckets[row];
        }
        self.order.clear();
        self.order.resize(self.runs.len(), (0, 0));
        for (number, run) in (0u32..).zip(&self.runs) {
            let at = &mut self.buckets[bucket(run.row)];
            self.order[*at as usize] = (run.columns[0], number);
            *at += 1;
        }
        // The start of each bucket has advanced to its end.
        let mut start = 0;
        for &end in &self.buckets[..count] {
            self.order[start..end as usize].sort_unstable();
            start = end as usize;
        }
    }

    /// Merges adjacent runs of a row into spans.
    fn collect_spans(&mut self) {
        self.spans.clear();
        self.rows.clear();
        let mut number = 0u32;
        let mut row = self.first_row;
        self.rows.push(0);
        for &(_, run) in &self.order {
            let Run {
                row: here, columns, ..
            } = self.runs[run as usize];
            let mut new_row = self.spans.len() == self.rows[self.rows.len() - 1];
            while row < here {
                self.rows.push(self.spans.len());
                row += 1;
                new_row = true;
            }
            match self.spans.last_mut() {
                Some(span) if !new_row && span.columns[1] == columns[0] => {
                    span.columns[1] = columns[1];
                }
                _ => self.spans.push(Span {
                    columns,
                    first: number,
                }),
            }
            number += index_u32(usize::try_from(columns[1] - columns[0]).unwrap_or(0));
        }
        self.rows.push(self.spans.len());
        self.dropped.clear();
        self.dropped.resize(number as usize, false);
    }

    /// Drops points that are too close to an edge of a loop.
    fn drop_near_loops(&mut self, triangulation: &LoopTriangulation) {
        let clearance = CLEARANCE * self.length;
        for v in 0..index_u32(triangulation.next.len()) {
            self.near_edge(triangulation, v, clearance, |lattice, near| {
                lattice.dropped[near.point] = true;
            });
        }
    }

    /// Calls `visit` for each point closer than `far` to the edge of a loop that begins at `v`.
    fn near_edge(
        &mut self,
        triangulation: &LoopTriangulation,
        v: u32,
        far: f64,
        mut visit: impl FnMut(&mut Self, NearPoint),
    ) {
        let rows = i64::try_from(self.rows.len()).unwrap_or(i64::MAX) - 1;
        let (p, q) = (
            triangulation.cdt.point(v),
            triangulation.cdt.point(triangulation.next[v as usize]),
        );
        let is_upward = p[1] <= q[1];
        let (p, q) = if is_upward { (p, q) } else { (q, p) };
        let d = [q[0] - p[0], q[1] - p[1]];
        let square = d[0] * d[0] + d[1] * d[1];
        let from = self.row_from(p[1] - far).max(self.first_row);
        let to = self.row_from(q[1] + far).min(self.first_row + rows);
        for row in from..to {
            let y = self.y(row);
            // The part of the edge within the clearance in y.
            let clip = |y: f64| {
                if d[1] > 0.0 {
                    p[0] + ((y - p[1]) / d[1]).clamp(0.0, 1.0) * d[0]
                } else if y < p[1] {
                    p[0]
                } else {
                    q[0]
                }
            };
            let (x0, x1) = (clip(y - far), clip(y + far));
            let (left, right) = (x0.min(x1) - far, x0.max(x1) + far);
            let row_at = usize::try_from(row - self.first_row).unwrap_or(0);
            for i in self.rows[row_at]..self.rows[row_at + 1] {
                let span = self.spans[i];
                if self.x(row, span.columns[0]) > right || self.x(row, span.columns[1] - 1) < left {
                    continue;
                }
                let start = self.column_from(row, left).max(span.columns[0]);
                let end = self.column_from(row, right).min(span.columns[1]);
                for column in start..end {
                    let r = [self.x(row, column) - p[0], y - p[1]];
                    let along = if square > 0.0 {
                        ((r[0] * d[0] + r[1] * d[1]) / square).clamp(0.0, 1.0)
                    } else {
                        0.0
                    };
                    let e = [r[0] - along * d[0], r[1] - along * d[1]];
                    let distance = e[0] * e[0] + e[1] * e[1];
                    if distance < far * far {
                        let at = usize::try_from(column - span.columns[0]).unwrap_or(0);
                        let near = NearPoint {
                            point: span.first as usize + at,
                            distance,
                            along: if is_upward { along } else { 1.0 - along },
                        };
                        visit(self, near);
                    }
                }
            }
        }
    }

    /// Numbers the kept points and stores their parents and weights.
    fn number_kept(&mut self) {
        for row in 0..self.rows.len() - 1 {
            self.kept_rows.push(self.kept.len());
            for span in &self.spans[self.rows[row]..self.rows[row + 1]] {
                let mut open = false;
                let columns = span.columns[0]..span.columns[1];
                for (number, column) in (span.first as usize..).zip(columns) {
                    let keep = !self.dropped[number];
                    if keep && !open {
                        self.kept.push(Span {
                            columns: [column; 2],
                            first: 0,
                        });
                    }
                    open = keep;
                    if keep && let Some(last) = self.kept.last_mut() {
                        last.columns[1] = column + 1;
                    }
                }
            }
        }
        self.kept_rows.push(self.kept.len());
        let mut first = 0;
        for span in &mut self.kept {
            span.first = first;
            first += index_u32(usize::try_from(span.columns[1] - span.columns[0]).unwrap_or(0));
        }
        let mut number = 0;
        for &(_, run) in &self.order {
            let run = self.runs[run as usize];
            for column in run.columns[0]..run.columns[1] {
                if !self.dropped[number] {
                    let x = self.x(run.row, column);
                    self.points.push([x, self.y(run.row)]);
                    let (parents, weights) = weights_between(&run.sides, x);
                    self.parents.push(parents);
                    self.weights.push(weights);
                }
                number += 1;
            }
        }
    }
}

/// Returns the offset of a row, in columns.
#[inline]
fn shift(row: i64) -> f64 {
    0.5 * count(row.rem_euclid(2)) + SHEAR * count(row)
}

#[expect(
    clippy::cast_precision_loss,
    reason = "rows and columns are at most 2^41 apart"
)]
#[inline]
fn count(i: i64) -> f64 {
    i as f64
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "rows and columns are at most 2^41 apart"
)]
#[inline]
fn whole(x: f64) -> i64 {
    // Truncates; the callers step to the exact row or column.
    x as i64
}
