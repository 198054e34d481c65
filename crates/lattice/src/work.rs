//! [`Work`]: the solved cells of an edit, and memory that edits reuse.

use crate::absorb::Clusters;
use crate::body::Body;
use crate::cell::CellSolver;
use crate::content::ContentWork;
use crate::divided::Divided;
use crate::lattice::State;
use crate::set::Set;
use incise_mesh::VertexId;
use std::ops::Range;

/// The parts of a solved cell, and its vertices.
#[derive(Debug, Clone)]
pub(crate) struct Solved {
    pub(crate) cell: u32,
    /// Its parts, in [`Work::parts`].
    pub(crate) parts: Range<usize>,
    /// Its parts before, in [`Work::old_parts`].
    pub(crate) old_parts: Range<usize>,
    /// Its vertices, in [`Work::vertices`].
    pub(crate) vertices: Range<usize>,
}

/// The solved cells of an edit, and memory that edits reuse.
#[derive(Debug, Default)]
pub(crate) struct Work {
    pub(crate) content: ContentWork,
    /// Cells whose content the edit changed.
    pub(crate) touched: Set,
    pub(crate) solver: CellSolver,
    /// The touched cells, ascending once all are solved.
    pub(crate) solved: Vec<Solved>,
    pub(crate) parts: Vec<u32>,
    pub(crate) old_parts: Vec<u32>,
    /// Vertices with their parts.
    pub(crate) vertices: Vec<(VertexId, u32)>,
    pub(crate) clusters: Clusters,
    /// Parts that carry, or carried, others than before.
    pub(crate) carriers: Vec<u32>,
    /// Parts whose carrier changed.
    pub(crate) moved: Vec<u32>,
    /// Cells beside touched ones, and these.
    pub(crate) near: Set,
}

impl Work {
    pub(crate) fn prepare(&mut self, body: &Body<'_>) {
        let count = body.grid.cell_count();
        self.touched.reset(count);
        self.near.reset(count);
        self.solved.clear();
        self.parts.clear();
        self.old_parts.clear();
        self.vertices.clear();
        self.carriers.clear();
        self.moved.clear();
    }

    /// Finds the new parts of a touched cell.
    pub(crate) fn solve_touched(&mut self, body: &Body<'_>, state: &mut State, cell: u32) {
        let first_old = self.old_parts.len();
        state.parts.remove(cell, &mut self.old_parts);
        self.solver.solve(body, &state.content, cell);
        if self.solver.witnesses.is_empty() {
            state.content.witnesses.remove(&cell);
        } else {
            let own = self.solver.witnesses.iter();
            let own = own.map(|&t| (t, body.surface.piece(t)));
            state.content.witnesses.insert(cell, own.collect());
        }
        let first = self.parts.len();
        state.parts.add(cell, &self.solver.parts, &mut self.parts);
        let (solver, parts) = (&self.solver, &self.parts[first..]);
        if parts.len() > 1 {
            let divided = Divided::new(solver, &state.content, parts);
            state.divided.insert(cell, divided);
        } else {
            state.divided.remove(&cell);
        }
        let first_vertex = self.vertices.len();
        let own = solver.vertices.iter();
        let part_of = |triangle: u32| parts[solver.part_of[triangle as usize] as usize];
        self.vertices
            .extend(own.map(|&(v, triangle)| (v, part_of(triangle))));
        self.solved.push(Solved {
            cell,
            parts: first..self.parts.len(),
            old_parts: first_old..self.old_parts.len(),
            vertices: first_vertex..self.vertices.len(),
        });
    }

    /// Sorts the touched cells, so that numbers do not depend on the order in which they are found.
    pub(crate) fn sort(&mut self) {
        self.solved.sort_unstable_by_key(|solved| solved.cell);
    }
}
