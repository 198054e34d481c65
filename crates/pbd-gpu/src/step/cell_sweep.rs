//! Projects the cells of a batch in SIMD blocks.

use crate::constraints::cells::{CELLS_PER_BLOCK, CellBlock};
use crate::kernels::block::{Gather, WithGather};
use crate::kernels::cells::{CellConstants, Lane, project};
use crate::kernels::particle_state::ParticleStates;
use std::cell::Cell;

/// The projection of blocks of cells, compiled for the instruction set that is detected at run
/// time.
pub(crate) struct CellSweep<'a> {
    pub(crate) particles: ParticleStates<'a>,
    /// Displacements that the next prediction repeats, shape \[nodes\].
    pub(crate) node_forces: &'a [Cell<[f32; 4]>],
    pub(crate) blocks: &'a mut [CellBlock],
    /// Number of cells of the blocks.
    pub(crate) count: usize,
    pub(crate) constants: &'a CellConstants,
}

impl WithGather for CellSweep<'_> {
    type Output = ();

    #[inline(always)]
    fn with<G: Gather<L>, const L: usize>(self, gather: G) {
        let Self {
            particles,
            node_forces,
            blocks,
            count,
            constants,
        } = self;
        for first in (0..count).step_by(L) {
            let lanes = Lane {
                block: &mut blocks[first / CELLS_PER_BLOCK],
                first: first % CELLS_PER_BLOCK,
                count: (count - first).min(L),
            };
            project(gather, particles, node_forces, lanes, constants);
        }
    }
}
