//! Copies and weights of vertices.

use crate::body::Body;
use crate::cell::NONE;
use crate::change::LatticeChange;
use crate::lattice::Lattice;
use crate::work::Work;

impl Lattice {
    /// Finds copies and weights of the vertices in touched cells, and in cells with parts that got
    /// another carrier.
    pub(crate) fn embed(&mut self, body: &Body<'_>, work: &mut Work, change: &mut LatticeChange) {
        let state = &self.state;
        let moved = work.moved.iter().map(|&part| state.parts.get(part).cell);
        let mut cells: Vec<u32> = moved.filter(|&cell| !work.touched.contains(cell)).collect();
        cells.sort_unstable();
        cells.dedup();
        for cell in cells {
            if let Some(divided) = state.divided.get(&cell) {
                work.vertices.extend(&divided.vertices);
            } else if let Some(part) = state.parts.of_cell(cell).next() {
                work.solver.load(body, &state.content, cell);
                let own = work.solver.vertices.iter();
                work.vertices.extend(own.map(|&(v, _)| (v, part)));
            }
        }
        let slots = self.vertex_copies.len();
        // The part of the last vertex, its copy, and the cell of that.
        let mut known = (NONE, NONE, [0; 3]);
        for &(v, part) in work.vertices.iter().filter(|own| own.0.index() < slots) {
            if part != known.0 {
                let carrier = state.parts.get(state.parts.get(part).carrier);
                known = (part, carrier.copy, body.grid.cell(carrier.cell));
            }
            let (_, copy, cell) = known;
            let place = body.surface.rest_position(v);
            let weights = body.grid.weights(cell, place).map(to_weight);
            let own = &mut self.vertex_copies[v.index()];
            let own_weights = &mut self.vertex_weights[v.index()];
            if *own != copy || *own_weights != weights {
                *own = copy;
                *own_weights = weights;
                change.vertices_changed.push(v);
            }
        }
    }
}

/// Rounds a weight to storage.
#[expect(
    clippy::cast_possible_truncation,
    reason = "weights have storage precision"
)]
pub(crate) fn to_weight(weight: f64) -> f32 {
    weight as f32
}
