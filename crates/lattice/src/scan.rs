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

    fn line_count(&self) -> u32 {
        let [u, v] = self.across();
        self.count(u) * self.count(v)
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
        for (axis, crossings) in crossings(grid, skin).into_iter().enumerate() {
            let lines = Lines::new(grid, axis);
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

/// Returns the crossings of all lines along each axis with a surface, by line, piece and place.
///
/// At one place exits come before entries, so that coincident walls end and begin spans.
fn crossings(grid: &Grid, skin: &Skin) -> [Vec<Crossing>; 3] {
    let axes = [0, 1, 2].map(|axis| Lines::new(grid, axis));
    let mut found = [const { Vec::new() }; 3];
    for ((triangle, corners), &piece) in (0..).zip(&skin.corners).zip(&skin.pieces) {
        let [a, b, c] = corners;
        let (low, high) = (a.inf(b).inf(c), a.sup(b).sup(c));
        let ranges = [0, 1, 2].map(|axis| axes[axis].between(axis, low[axis], high[axis]));
        for (lines, found) in axes.iter().zip(&mut found) {
            let [u, v] = lines.across();
            if ranges[u].is_empty() || ranges[v].is_empty() {
                continue;
            }
            let projection = Projection::new(corners, lines.axis, [u, v]);
            for j in ranges[v].clone() {
                for i in ranges[u].clone() {
                    let place = [lines.at(u, i), lines.at(v, j)];
                    if let Some((at, leaves)) = projection.crossing(place) {
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
    }
    let mut axes = axes.iter();
    found.map(|found| {
        let count = axes.next().map_or(0, Lines::line_count);
        sorted_by_line(&found, count)
    })
}

/// Sorts the crossings of lines: by counting, then the few of each line.
fn sorted_by_line(found: &[Crossing], line_count: u32) -> Vec<Crossing> {
    let mut ends = vec![0u32; line_count as usize + 1];
    for crossing in found {
        ends[crossing.line as usize + 1] += 1;
    }
    for line in 1..ends.len() {
        ends[line] += ends[line - 1];
    }
    let mut sorted = found.to_vec();
    for crossing in found {
        let end = &mut ends[crossing.line as usize];
        sorted[*end as usize] = *crossing;
        *end += 1;
    }
    for line in sorted.chunk_by_mut(|a, b| a.line == b.line) {
        line.sort_unstable_by(|a, b| {
            let order = a.piece.cmp(&b.piece).then(a.at.total_cmp(&b.at));
            order
                .then(b.leaves.cmp(&a.leaves))
                .then(a.triangle.cmp(&b.triangle))
        });
    }
    sorted
}

/// A triangle seen along an axis.
struct Projection {
    /// Its corners in lexicographic order.
    corners: [Vec3; 3],
    /// Whether the corners go around in the triangle's direction.
    is_even: bool,
    /// The other corners from the first one.
    sides: [Vec3; 2],
    determinant: f64,
    axis: usize,
    across: [usize; 2],
}

impl Projection {
    fn new(corners: &[Vec3; 3], axis: usize, [u, v]: [usize; 2]) -> Self {
        let mut sorted = *corners;
        let mut is_even = true;
        for (a, b) in [(0, 1), (1, 2), (0, 1)] {
            if sorted[b].as_slice() < sorted[a].as_slice() {
                sorted.swap(a, b);
                is_even = !is_even;
            }
        }
        let sides = [1, 2].map(|i| sorted[i] - sorted[0]);
        Self {
            corners: sorted,
            is_even,
            sides,
            determinant: sides[0][u] * sides[1][v] - sides[0][v] * sides[1][u],
            axis,
            across: [u, v],
        }
    }

    /// Returns where a line along the axis crosses the triangle, and whether it leaves the body
    /// there.
    ///
    /// An edge gives both of its triangles the same answer, so that no line slips between them.
    fn crossing(&self, place: [f64; 2]) -> Option<(f64, bool)> {
        let [u, v] = self.across;
        let [a, b, c] = &self.corners;
        let is_left = |a: &Vec3, b: &Vec3| {
            let cross = (b[u] - a[u]) * (place[1] - a[v]) - (b[v] - a[v]) * (place[0] - a[u]);
            cross >= 0.0
        };
        let is_left_of_all = is_left(a, b);
        if is_left(b, c) != is_left_of_all || is_left(a, c) == is_left_of_all {
            return None;
        }
        let [first, second] = &self.sides;
        let (x, y) = (place[0] - a[u], place[1] - a[v]);
        let parts = [
            (x * second[v] - y * second[u]) / self.determinant,
            (first[u] * y - first[v] * x) / self.determinant,
        ];
        let at = a[self.axis] + parts[0] * first[self.axis] + parts[1] * second[self.axis];
        (self.determinant != 0.0).then_some((at, is_left_of_all == self.is_even))
    }
}
