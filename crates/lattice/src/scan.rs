//! [`Scan`]: the inside of a body along scanlines in three directions.

use crate::fragments::{Fragments, ROUNDING};
use crate::grid::{Grid, ceil_to_u32, floor_to_u32};
use crate::skin::Skin;
use incise_mesh::{Vec3, index_u32};

/// Number of scanlines across a cell, along each edge of a face.
pub(crate) const LINES: u32 = 4;

/// Distance of the first scanline from the lower faces, by axis [distances of scanlines].
///
/// Near the middle of their intervals, but off vertices and edges of regular meshes.
const OFFSETS: [f64; 3] = [0.513_717, 0.482_607, 0.507_911];

/// No span.
const NONE: u32 = u32::MAX;

/// A part of a scanline inside of a piece and in one cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    pub(crate) line: u32,
    pub(crate) cell: u32,
    /// Its ends along the axis \[m\].
    pub(crate) from: f64,
    pub(crate) to: f64,
}

impl Span {
    pub(crate) fn length(&self) -> f64 {
        self.to - self.from
    }
}

/// Two elements on both sides of a face of cells, in which parts of the body meet.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Join {
    pub(crate) low: u32,
    pub(crate) high: u32,
    pub(crate) axis: usize,
}

/// The scanlines along an axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lines<'a> {
    grid: &'a Grid,
    pub(crate) axis: usize,
}

impl<'a> Lines<'a> {
    pub(crate) fn new(grid: &'a Grid, axis: usize) -> Self {
        Self { grid, axis }
    }

    /// Returns the other axes.
    fn across(&self) -> [usize; 2] {
        [(self.axis + 1) % 3, (self.axis + 2) % 3]
    }

    /// Returns the distance of scanlines \[m\].
    pub(crate) fn distance(grid: &Grid) -> f64 {
        grid.cell_size() / f64::from(LINES)
    }

    /// Returns the number of scanlines along an axis across them.
    fn count(&self, axis: usize) -> u32 {
        self.grid.counts()[axis] * LINES
    }

    /// Returns the coordinate of a scanline along an axis across it \[m\].
    fn at(&self, axis: usize, number: u32) -> f64 {
        let offset = f64::from(number) + OFFSETS[axis];
        self.grid.origin()[axis] + Self::distance(self.grid) * offset
    }

    /// Returns the numbers of the scanlines along an axis between two coordinates \[m\].
    fn between(&self, axis: usize, low: f64, high: f64) -> std::ops::Range<u32> {
        let number =
            |at: f64| (at - self.grid.origin()[axis]) / Self::distance(self.grid) - OFFSETS[axis];
        let last = number(high);
        if last < 0.0 {
            return 0..0;
        }
        let end = floor_to_u32(last) + 1;
        ceil_to_u32(number(low))..end.min(self.count(axis))
    }

    /// Returns the numbers of a scanline along both axes across it.
    fn numbers(&self, line: u32) -> [u32; 2] {
        let row = self.count(self.across()[0]);
        [line % row, line / row]
    }

    /// Returns the point of a scanline at a coordinate \[m\].
    pub(crate) fn point(&self, line: u32, at: f64) -> Vec3 {
        let [u, v] = self.across();
        let [i, j] = self.numbers(line);
        let mut p = Vec3::zeros();
        p[self.axis] = at;
        p[u] = self.at(u, i);
        p[v] = self.at(v, j);
        p
    }

    /// Returns the cell of a scanline, given its number along the axis.
    fn cell(&self, line: u32, along: u32) -> u32 {
        let [u, v] = self.across();
        let [i, j] = self.numbers(line);
        let mut cell = [0; 3];
        cell[self.axis] = along;
        cell[u] = i / LINES;
        cell[v] = j / LINES;
        self.grid.index(cell)
    }
}

/// A crossing of a scanline with the surface.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    line: u32,
    piece: u32,
    /// Coordinate along the axis \[m\].
    at: f64,
    leaves: bool,
    triangle: u32,
}

/// The inside of a body along scanlines. Elements are fragments, then spans.
#[derive(Debug, Default)]
pub(crate) struct Scan {
    /// By axis, ascending by line and by place within a piece.
    pub(crate) spans: [Vec<Span>; 3],
    /// Elements of the same part of the body in a cell.
    pub(crate) pairs: Vec<[u32; 2]>,
    /// Elements whose parts meet in faces.
    pub(crate) joins: Vec<Join>,
    /// Lines with more entries than exits of a piece, or fewer.
    pub(crate) open_lines: usize,
    /// The piece of each span.
    pieces: Vec<u32>,
    /// By sample point, a span that holds it.
    owners: Vec<u32>,
}

impl Scan {
    /// Scans a surface along all axes.
    ///
    /// The spans of each piece are found alone, so that nothing joins two pieces.
    pub(crate) fn new(grid: &Grid, skin: &Skin, fragments: &Fragments) -> Self {
        let counts = grid.counts().map(|count| (count * LINES) as usize);
        let mut scan = Self {
            owners: vec![NONE; counts[0] * counts[1] * counts[2]],
            ..Self::default()
        };
        for axis in 0..3 {
            let lines = Lines::new(grid, axis);
            let crossings = crossings(&lines, skin);
            let mut from = 0;
            let is_new = |a: &Crossing, b: &Crossing| (a.line, a.piece) != (b.line, b.piece);
            for i in 1..=crossings.len() {
                if i == crossings.len() || is_new(&crossings[i - 1], &crossings[i]) {
                    scan.add_line(&lines, fragments, &crossings[from..i]);
                    from = i;
                }
            }
        }
        scan
    }

    /// Adds the spans of a line in one piece.
    fn add_line(&mut self, lines: &Lines<'_>, fragments: &Fragments, crossings: &[Crossing]) {
        let mut winding = 0;
        let mut entry = crossings[0];
        for crossing in crossings {
            if !crossing.leaves {
                winding += 1;
                if winding == 1 {
                    entry = *crossing;
                }
                continue;
            }
            winding -= 1;
            if winding == 0 {
                self.add_interval(lines, fragments, [&entry, crossing]);
            }
        }
        self.open_lines += usize::from(winding != 0);
    }

    /// Adds the spans between an entry and an exit.
    fn add_interval(
        &mut self,
        lines: &Lines<'_>,
        fragments: &Fragments,
        [entry, exit]: [&Crossing; 2],
    ) {
        let (grid, axis) = (lines.grid, lines.axis);
        let rounding = 4.0 * ROUNDING * grid.cell_size();
        let [first, last] = [entry, exit].map(|crossing| grid.cell_along(axis, crossing.at));
        for along in first..=last {
            let cell = lines.cell(entry.line, along);
            let span = Span {
                line: entry.line,
                cell,
                from: if along == first {
                    entry.at
                } else {
                    grid.face(axis, along)
                },
                to: if along == last {
                    exit.at
                } else {
                    grid.face(axis, along + 1)
                },
            };
            let element = fragments.len() + index_u32(self.pieces.len());
            self.spans[axis].push(span);
            self.pieces.push(entry.piece);
            let mut pair = |element: u32, crossing: &Crossing, cell: u32| {
                let fragment = fragments.find(crossing.triangle, cell);
                self.pairs
                    .extend(fragment.map(|fragment| [element, fragment]));
            };
            if along == first {
                pair(element, entry, cell);
            }
            if along == last {
                pair(element, exit, cell);
            }
            if along > first {
                let below = element - 1;
                // An end within rounding of the face bounds the part on its other side as well.
                if along == last && span.length() < rounding {
                    pair(below, exit, lines.cell(entry.line, along - 1));
                }
                if along == first + 1 && span.from - entry.at < rounding {
                    pair(element, entry, cell);
                }
                self.joins.push(Join {
                    low: below,
                    high: element,
                    axis,
                });
            }
            self.add_samples(lines, fragments.len(), element, &span);
        }
    }

    /// Pairs a span with spans along other axes through the same sample points.
    fn add_samples(&mut self, lines: &Lines<'_>, first: u32, element: u32, span: &Span) {
        let axis = lines.axis;
        let [u, v] = lines.across();
        let [i, j] = lines.numbers(span.line);
        let counts = lines.grid.counts().map(|count| (count * LINES) as usize);
        for number in lines.between(axis, span.from, span.to) {
            let mut at = [0; 3];
            at[axis] = number as usize;
            at[u] = i as usize;
            at[v] = j as usize;
            let owner = &mut self.owners[(at[2] * counts[1] + at[1]) * counts[0] + at[0]];
            let piece = |element: u32| self.pieces[(element - first) as usize];
            if *owner == NONE {
                *owner = element;
            } else if piece(*owner) == piece(element) {
                self.pairs.push([element, *owner]);
            }
        }
    }
}

/// Returns the crossings of all lines along an axis with a surface, by line, piece and place.
///
/// At one place exits come before entries, so that coincident walls end and begin spans.
fn crossings(lines: &Lines<'_>, skin: &Skin) -> Vec<Crossing> {
    let [u, v] = lines.across();
    let mut found = Vec::new();
    for ((triangle, corners), &piece) in (0..).zip(&skin.corners).zip(&skin.pieces) {
        let range = |axis: usize| {
            let at = corners.map(|p| p[axis]);
            let low = at[0].min(at[1]).min(at[2]);
            lines.between(axis, low, at[0].max(at[1]).max(at[2]))
        };
        let (columns, rows) = (range(u), range(v));
        for j in rows {
            for i in columns.clone() {
                let place = [lines.at(u, i), lines.at(v, j)];
                if let Some((at, leaves)) = crossing(corners, lines.axis, [u, v], place) {
                    found.push(Crossing {
                        line: j * lines.count(u) + i,
                        piece,
                        at,
                        leaves,
                        triangle,
                    });
                }
            }
        }
    }
    found.sort_unstable_by(|a, b| {
        let order = (a.line, a.piece).cmp(&(b.line, b.piece));
        order
            .then(a.at.total_cmp(&b.at))
            .then(b.leaves.cmp(&a.leaves))
            .then(a.triangle.cmp(&b.triangle))
    });
    found
}

/// Returns where a line along an axis crosses a triangle, and whether it leaves the body there.
///
/// An edge gives both of its triangles the same answer, so that no line slips between them.
fn crossing(
    corners: &[Vec3; 3],
    axis: usize,
    [u, v]: [usize; 2],
    place: [f64; 2],
) -> Option<(f64, bool)> {
    let is_left = |from: &Vec3, to: &Vec3| {
        let is_ordered = from.as_slice() < to.as_slice();
        let (a, b) = if is_ordered { (from, to) } else { (to, from) };
        let cross = (b[u] - a[u]) * (place[1] - a[v]) - (b[v] - a[v]) * (place[0] - a[u]);
        (cross >= 0.0) == is_ordered
    };
    let [a, b, c] = corners;
    let leaves = is_left(a, b);
    if is_left(b, c) != leaves || is_left(c, a) != leaves {
        return None;
    }
    let mut sorted = *corners;
    sorted.sort_by(|a, b| {
        a.as_slice()
            .partial_cmp(b.as_slice())
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    let [first, second] = [1, 2].map(|i| sorted[i] - sorted[0]);
    let determinant = first[u] * second[v] - first[v] * second[u];
    let (x, y) = (place[0] - sorted[0][u], place[1] - sorted[0][v]);
    let parts = [
        (x * second[v] - y * second[u]) / determinant,
        (first[u] * y - first[v] * x) / determinant,
    ];
    let at = sorted[0][axis] + parts[0] * first[axis] + parts[1] * second[axis];
    (determinant != 0.0).then_some((at, leaves))
}
