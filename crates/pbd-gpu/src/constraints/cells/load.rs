//! Saved cells: their copies and states by color. The lattice has the rest.

use super::unused_block;
use super::{CELLS_PER_BLOCK, CellBatch, CellSet, CellState, at, set_shape, set_state, state};
use crate::constraints::batches::{OVERFLOW, Slot};
use crate::error::InvalidSolver;
use incise_lattice::Lattice;
use incise_mesh::VertexId;
use serde::{Deserialize, Serialize};

/// A cell in a file.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct SavedCell {
    copy: u32,
    rotation: [f32; 4],
    stress: [f32; 6],
    hourglass: [f32; 12],
}

/// The cells of a file by color, and those without one.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct SavedCells {
    colors: Vec<Vec<SavedCell>>,
    overflow: Vec<SavedCell>,
}

impl From<CellSet> for SavedCells {
    fn from(set: CellSet) -> Self {
        let saved = |batch: &CellBatch| {
            let cell = |index: usize| {
                let (block, lane) = (index / CELLS_PER_BLOCK, index % CELLS_PER_BLOCK);
                let block = &batch.blocks[block];
                let state = state(block, lane);
                SavedCell {
                    copy: block.copies[lane],
                    rotation: state.rotation,
                    stress: state.stress,
                    hourglass: state.hourglass,
                }
            };
            (0..batch.len).map(cell).collect()
        };
        Self {
            colors: set.batches.iter().map(saved).collect(),
            overflow: saved(&set.overflow),
        }
    }
}

impl From<SavedCells> for CellSet {
    /// Returns cells without nodes, which [`CellSet::finish_load`] completes.
    fn from(saved: SavedCells) -> Self {
        let batch = |cells: &Vec<SavedCell>| {
            let mut batch = CellBatch::default();
            for cell in cells {
                if batch.len.is_multiple_of(CELLS_PER_BLOCK) {
                    batch.blocks.push(unused_block());
                }
                batch.len += 1;
                let last = batch.len - 1;
                let (block, lane) = at(&mut batch, last);
                block.copies[lane] = cell.copy;
                let state = CellState {
                    rotation: cell.rotation,
                    stress: cell.stress,
                    hourglass: cell.hourglass,
                };
                set_state(block, lane, &state);
            }
            batch
        };
        Self {
            batches: saved.colors.iter().map(batch).collect(),
            overflow: batch(&saved.overflow),
            ..Self::new()
        }
    }
}

impl CellSet {
    /// Completes and validates cells that were read with serde, of a valid lattice.
    ///
    /// # Errors
    /// [`InvalidSolver::Array`] unless every copy has one cell, with a finite state and a color of
    /// its own.
    pub(crate) fn finish_load(&mut self, lattice: &Lattice) -> Result<(), InvalidSolver> {
        const NONE: Slot = Slot {
            color: usize::MAX,
            index: 0,
        };
        let error = InvalidSolver::Array { array: "cells" };
        self.resize_nodes(lattice.node_positions.len());
        let mut slots = vec![NONE; lattice.cells.len()];
        if self.batches.len() > crate::constraints::coloring::MAX_COLORS {
            return Err(error);
        }
        let Self {
            batches,
            overflow,
            colors,
            ..
        } = self;
        for (color, batch) in batches.iter_mut().enumerate().chain([(OVERFLOW, overflow)]) {
            for index in 0..batch.len {
                let (block, lane) = at(batch, index);
                let copy = block.copies[lane];
                let is_new = slots.get(copy as usize) == Some(&NONE) && lattice.is_copy(copy);
                let state = state(block, lane);
                let mut numbers = state
                    .rotation
                    .iter()
                    .chain(&state.stress)
                    .chain(&state.hourglass);
                if !is_new || !numbers.all(|c| c.is_finite()) {
                    return Err(error);
                }
                slots[copy as usize] = Slot { color, index };
                let nodes = lattice.nodes[copy as usize].map(VertexId);
                block.nodes[lane] = nodes;
                set_shape(block, lane, &lattice.moments[copy as usize]);
                if color != OVERFLOW && !colors.claim_color(color, &nodes) {
                    return Err(error);
                }
            }
        }
        let copies = (0..).zip(&slots);
        let is_complete = |(copy, slot): (u32, &Slot)| lattice.is_copy(copy) == (*slot != NONE);
        self.slots = copies.clone().map(|(_, slot)| *slot).collect();
        (0..)
            .zip(&slots)
            .all(is_complete)
            .then_some(())
            .ok_or(error)
    }
}
