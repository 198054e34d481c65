//! The core of a cover: points of a triangular lattice that lie deep enough inside, and the
//! lattice's own triangles between them.
//!
//! Points are found by filling the inside triangles of the rings alone, row by row, as a screen is
//! filled: every point falls into one triangle, which gives its parents and weights as well. With a
//! clearance over L / sqrt(3) no point of a rim lies in the circle around three neighbors that are
//! kept, so their triangle is Delaunay and needs no test.

use super::cdt::id;
use super::mean::{Crossing, Side, mix};
use super::sheet::{INSIDE, Sheet};

/// Points nearer to a rim than this many L are not kept. More than 1 / sqrt(3).
const CLEARANCE: f64 = 0.6;

/// Lattice points of one row in one triangle of the rings.
#[derive(Debug, Clone, Copy)]
struct Run {
    row: i64,
    /// Columns, the last one excluded.
    columns: [i64; 2],
    /// The triangle's sides that the row crosses, left and right: ends and how far along.
    sides: [Side; 2],
}

/// Columns of one row that follow each other, and the number of the first.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    pub(crate) columns: [i64; 2],
    pub(crate) first: u32,
}

/// The lattice over one sheet.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lattice {
    pub(crate) length: f64,
    height: f64,
    base: [f64; 2],
    pub(crate) first_row: i64,
    runs: Vec<Run>,
    /// First column and number of each run, row after row.
    order: Vec<(i64, u32)>,
    buckets: Vec<u32>,
    /// All points, kept or not; then the kept ones.
    spans: Vec<Span>,
    rows: Vec<usize>,
    dropped: Vec<bool>,
    pub(crate) kept: Vec<Span>,
    /// Where each row's kept spans start, and the end.
    pub(crate) kept_rows: Vec<usize>,
    /// By kept point: 1 if there is a triangle above the edge to its right, 2 if below.
    pub(crate) sides: Vec<u8>,
    /// By kept point: whether a triangle of the core is at it.
    pub(crate) has_cell: Vec<bool>,
    /// Kept points.
    pub(crate) points: Vec<[f64; 2]>,
    /// Their parents among the sheet's vertices.
    pub(crate) parents: Vec<[u32; 3]>,
    pub(crate) weights: Vec<[f64; 3]>,
    /// Edges between the core and the band, the core on the left.
    pub(crate) boundary: Vec<[u32; 2]>,
    /// Whether a point belongs to the band too.
    pub(crate) in_band: Vec<bool>,
}

impl Lattice {
    pub(crate) fn clear(&mut self) {
        self.points.clear();
        self.parents.clear();
        self.weights.clear();
        self.boundary.clear();
        self.in_band.clear();
        self.has_cell.clear();
        self.kept.clear();
        self.kept_rows.clear();
    }

    /// Puts points of spacing `length` inside a sheet. Returns false where there would be more
    /// than `most`.
    pub(crate) fn fill(&mut self, sheet: &Sheet, length: f64, most: usize) -> bool {
        self.clear();
        self.length = length;
        self.height = length * 0.75f64.sqrt();
        let y = if sheet.creased { 0.0 } else { sheet.low[1] };
        self.base = [sheet.low[0], y];
        if !self.rasterize(sheet, most) {
            return false;
        }
        self.collect_spans();
        self.keep_clear(sheet);
        self.number_kept();
        true
    }

    fn y(&self, row: i64) -> f64 {
        self.base[1] + count(row) * self.height
    }

    fn x(&self, row: i64, column: i64) -> f64 {
        self.base[0] + (count(column) + 0.5 * count(row.rem_euclid(2))) * self.length
    }

    /// The first row at or above `y`.
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

    /// The first column of a row at or right of `x`.
    fn column_from(&self, row: i64, x: f64) -> i64 {
        let shift = 0.5 * count(row.rem_euclid(2));
        let mut column = whole((x - self.base[0]) / self.length - shift);
        while self.x(row, column) < x {
            column += 1;
        }
        while self.x(row, column - 1) >= x {
            column -= 1;
        }
        column
    }

    fn rasterize(&mut self, sheet: &Sheet, most: usize) -> bool {
        self.runs.clear();
        let cdt = &sheet.cdt;
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

    /// Puts the runs in the order of their rows and columns: into one bucket a row first.
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
        // What was a bucket's start is its end now.
        let mut start = 0;
        for &end in &self.buckets[..count] {
            self.order[start..end as usize].sort_unstable();
            start = end as usize;
        }
    }

    /// Joins runs to spans, row by row.
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
            number += id(usize::try_from(columns[1] - columns[0]).unwrap_or(0));
        }
        self.rows.push(self.spans.len());
        self.dropped.clear();
        self.dropped.resize(number as usize, false);
    }

    /// Drops points that are too near to an edge of a ring.
    fn keep_clear(&mut self, sheet: &Sheet) {
        let far = CLEARANCE * self.length;
        let rows = i64::try_from(self.rows.len()).unwrap_or(i64::MAX) - 1;
        for (&w, &p) in sheet.next.iter().zip(&sheet.cdt.points) {
            let q = sheet.cdt.point(w);
            let (p, q) = if p[1] <= q[1] { (p, q) } else { (q, p) };
            let d = [q[0] - p[0], q[1] - p[1]];
            let square = d[0] * d[0] + d[1] * d[1];
            let from = self.row_from(p[1] - far).max(self.first_row);
            let to = self.row_from(q[1] + far).min(self.first_row + rows);
            for row in from..to {
                let y = self.y(row);
                // The part of the edge that is near enough in y.
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
                    if self.x(row, span.columns[0]) > right
                        || self.x(row, span.columns[1] - 1) < left
                    {
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
                        if e[0] * e[0] + e[1] * e[1] < far * far {
                            let at = usize::try_from(column - span.columns[0]).unwrap_or(0);
                            self.dropped[span.first as usize + at] = true;
                        }
                    }
                }
            }
        }
    }

    /// Numbers what is left, with parents and weights.
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
            first += id(usize::try_from(span.columns[1] - span.columns[0]).unwrap_or(0));
        }
        let mut number = 0;
        for &(_, run) in &self.order {
            let run = self.runs[run as usize];
            for column in run.columns[0]..run.columns[1] {
                if !self.dropped[number] {
                    let x = self.x(run.row, column);
                    self.points.push([x, self.y(run.row)]);
                    let (parents, weights) = mix(&run.sides, x);
                    self.parents.push(parents);
                    self.weights.push(weights);
                }
                number += 1;
            }
        }
    }
}

#[expect(
    clippy::cast_precision_loss,
    reason = "rows and columns are at most 2^41 apart"
)]
fn count(i: i64) -> f64 {
    i as f64
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "rows and columns are at most 2^41 apart"
)]
fn whole(x: f64) -> i64 {
    // Toward zero; the callers step to the right one.
    x as i64
}
