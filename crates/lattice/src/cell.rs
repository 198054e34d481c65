//! [`CellSolver`]: the connected parts of a body in one cell.
//!
//! They depend only on the triangles in the cell and on the scanlines through it. A cell that holds
//! the same gets the same parts in the same order, after any edits.

mod measure;
mod spans;

pub(crate) use measure::Measure;

use crate::body::Body;
use crate::content::Content;
use crate::crossings::Interval;
use crate::grid::MARGIN;
use crate::lines::LINES;
use crate::measures::Sums;
use crate::overlap::{edge_meets_box, is_in_box};
use crate::thin::join_thin;
use incise_mesh::{HalfEdge, Partition, TriangleId, Vec3, VertexId, index_u32};
use spans::Span;

/// No number.
pub(crate) const NONE: u32 = u32::MAX;

/// Number of sample points in a cell, where scanlines along three axes meet.
const SAMPLES: usize = (LINES * LINES * LINES) as usize;

/// Finds the parts of cells, one after the other.
#[derive(Debug)]
pub(crate) struct CellSolver {
    /// The cell.
    pub(crate) cell: [u32; 3],
    /// The triangles of the cell.
    pub(crate) triangles: Vec<TriangleId>,
    /// By element, its part: of triangles, then of spans.
    pub(crate) part_of: Vec<u32>,
    /// By part, its measures.
    pub(crate) parts: Vec<Measure>,
    /// By face, the parts of the spans that pass it, by line.
    pub(crate) passing: [Vec<u32>; 6],
    /// By face, the lines with spans that pass it.
    pub(crate) inside: [u16; 6],
    /// A triangle of each connected group in the cell, the first one, if parts depend on pieces.
    pub(crate) witnesses: Vec<TriangleId>,
    /// The vertices in the cell, each with its first triangle.
    pub(crate) vertices: Vec<(VertexId, u32)>,
    pub(crate) corners: Vec<[Vec3; 3]>,
    /// By triangle, whether it lies in no other cell.
    pub(crate) is_inner: Vec<bool>,
    ids: Vec<[VertexId; 3]>,
    /// By triangle, the half-edges on the other side of its own.
    beside: Vec<[HalfEdge; 3]>,
    /// By triangle slot, its number in the cell if that holds it.
    numbers: Vec<u32>,
    /// By vertex slot, its number among the vertices if it is one.
    vertex_numbers: Vec<u32>,
    sets: Partition,
    spans: Vec<Span>,
    intervals: Vec<Interval>,
    /// The moments of a full cell, once known.
    full: Option<Sums>,
}

impl Default for CellSolver {
    fn default() -> Self {
        Self {
            cell: [0; 3],
            triangles: Vec::new(),
            part_of: Vec::new(),
            parts: Vec::new(),
            passing: [const { Vec::new() }; 6],
            inside: [0; 6],
            witnesses: Vec::new(),
            vertices: Vec::new(),
            corners: Vec::new(),
            is_inner: Vec::new(),
            ids: Vec::new(),
            beside: Vec::new(),
            numbers: Vec::new(),
            vertex_numbers: Vec::new(),
            sets: Partition::new(0),
            spans: Vec::new(),
            intervals: Vec::new(),
            full: None,
        }
    }
}

impl CellSolver {
    /// Finds the parts of a cell.
    pub(crate) fn solve(&mut self, body: &Body<'_>, content: &Content, index: u32) {
        let cell = body.grid.cell(index);
        self.load(body, content, index);
        self.add_spans(body, content, cell);
        self.witnesses.clear();
        if self.is_full(body) {
            self.take_full();
            return;
        }
        let count = index_u32(self.triangles.len());
        self.sets.reset(count as usize + self.spans.len());
        self.join_along_edges(body, cell);
        for (i, &t) in (0..).zip(&self.triangles) {
            if self.sets.find(i) == i {
                self.witnesses.push(t);
            }
        }
        self.join_ends();
        let mut depends = self.join_samples(body);
        let (triangles, corners) = (&self.triangles, &self.corners);
        // A single surface without spans stays one part.
        if self.witnesses.len() > 1 || !self.spans.is_empty() {
            depends |= join_thin(body, cell, triangles, corners, &mut self.sets);
        }
        if !depends || self.witnesses.len() < 2 {
            self.witnesses.clear();
        }
        self.number_parts();
        self.measure(body.grid, cell);
    }

    /// Returns the number of a triangle in the cell.
    fn number(&self, t: TriangleId) -> Option<u32> {
        let number = *self.numbers.get(t.index())?;
        (self.triangles.get(number as usize) == Some(&t)).then_some(number)
    }

    /// Takes the triangles and vertices of a cell.
    pub(crate) fn load(&mut self, body: &Body<'_>, content: &Content, index: u32) {
        let topology = body.surface.topology();
        let slots = topology.triangle_slots();
        self.numbers.resize(slots.max(self.numbers.len()), 0);
        let vertices = topology.vertex_slots().max(self.vertex_numbers.len());
        self.vertex_numbers.resize(vertices, 0);
        // In passes of one kind of access each, which wait for memory at the same time.
        let own = content.triangles(index).iter().map(|&t| TriangleId(t));
        self.triangles.clear();
        self.triangles
            .extend(own.filter(|&t| t.index() < slots && topology.is_triangle(t)));
        self.ids.clear();
        self.ids
            .extend(self.triangles.iter().map(|&t| topology.triangle(t)));
        self.beside.clear();
        for (number, &t) in (0..).zip(&self.triangles) {
            self.numbers[t.index()] = number;
            let twin = |h| topology.twin(h);
            self.beside.push(t.half_edges().map(twin));
        }
        self.corners.clear();
        let place = |v: VertexId| body.surface.rest_position(v);
        self.corners.extend(
            self.ids
                .iter()
                .map(|&[a, b, c]| [place(a), place(b), place(c)]),
        );
        let cell = body.grid.cell(index);
        self.cell = cell;
        let near = body.grid.around_cell(cell);
        let inner = body.grid.inside_cell(cell);
        self.is_inner.clear();
        self.vertices.clear();
        for (number, (corners, ids)) in (0..).zip(self.corners.iter().zip(&self.ids)) {
            let mut inner_count = 0;
            for (corner, &v) in corners.iter().zip(ids) {
                let is_inner = is_in_box(corner, &inner);
                inner_count += u32::from(is_inner);
                let is_own =
                    is_inner || (is_in_box(corner, &near) && body.grid.cell_at(*corner) == cell);
                if !is_own {
                    continue;
                }
                let known = &mut self.vertex_numbers[v.index()];
                if self
                    .vertices
                    .get(*known as usize)
                    .is_none_or(|own| own.0 != v)
                {
                    *known = index_u32(self.vertices.len());
                    self.vertices.push((v, number));
                }
            }
            self.is_inner.push(inner_count == 3);
        }
    }

    /// Joins neighboring triangles that share a part of their edge in the cell.
    fn join_along_edges(&mut self, body: &Body<'_>, cell: [u32; 3]) {
        let margin = Vec3::repeat(MARGIN * body.grid.cell_size());
        let low = body.grid.corner(cell, 0);
        let high = body.grid.corner(cell, 7);
        let own = [low, high];
        let (low_margin, high_margin) = (low - margin, high + margin);
        for (i, &t) in (0..).zip(&self.triangles) {
            for (k, twin) in self.beside[i as usize].into_iter().enumerate() {
                if twin.is_null() || twin.triangle() < t {
                    continue;
                }
                let Some(other) = self.number(twin.triangle()) else {
                    continue;
                };
                let corners = &self.corners[i as usize];
                let ends = [corners[k], corners[(k + 1) % 3]];
                if is_in_box(&ends[0], &own) || edge_meets_box(ends, low_margin, high_margin) {
                    self.sets.join(i, other);
                }
            }
        }
    }

    /// Joins spans with the triangles at their ends.
    fn join_ends(&mut self) {
        let count = index_u32(self.triangles.len());
        for i in 0..self.spans.len() {
            for t in self.spans[i].ends.into_iter().flatten() {
                if let Some(number) = self.number(t) {
                    self.sets.join(count + index_u32(i), number);
                }
            }
        }
    }

    /// Joins spans along different axes through the same sample points.
    ///
    /// Returns whether that depends on the pieces of triangles.
    fn join_samples(&mut self, body: &Body<'_>) -> bool {
        let count = index_u32(self.triangles.len());
        let counts = LINES as usize;
        let mut owners = [NONE; SAMPLES];
        let mut depends = false;
        for (i, span) in (0..).zip(&self.spans) {
            let lines = &body.lines[span.axis];
            let mut at = [0; 3];
            for (k, number) in lines.across.into_iter().zip(span.numbers) {
                at[k] = (number % LINES) as usize;
            }
            for number in lines.between(span.axis, span.from, span.to) {
                at[span.axis] = (number % LINES) as usize;
                let owner = &mut owners[(at[2] * counts + at[1]) * counts + at[0]];
                if *owner == NONE {
                    *owner = i;
                    continue;
                }
                let (a, b) = (self.sets.find(count + i), self.sets.find(count + *owner));
                if a == b {
                    continue;
                }
                depends = true;
                let other = self.spans[*owner as usize].entry;
                if body.piece(span.entry) == body.piece(other) {
                    self.sets.join(a, b);
                }
            }
        }
        depends
    }

    /// Numbers the parts in the order of their first elements.
    fn number_parts(&mut self) {
        let count = index_u32(self.sets.len());
        self.parts.clear();
        self.part_of.clear();
        for element in 0..count {
            // The smallest member of a set names it, and has a number already.
            let root = self.sets.find(element);
            let part = if root == element {
                self.parts.push(Measure::EMPTY);
                index_u32(self.parts.len() - 1)
            } else {
                self.part_of[root as usize]
            };
            self.part_of.push(part);
        }
        for passing in self.passing.iter_mut().flatten() {
            *passing = self.part_of[*passing as usize];
        }
    }
}
