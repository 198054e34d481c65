//! Forces of cells, and the numbers of cells in the lanes.

use super::modes::{Matrix, Vector};
use crate::constraints::cells::{CellBlock, Row};
use crate::kernels::block::Gather;
use crate::kernels::lanes::Lanes;
use pulp::Simd;

/// Forces of the rows of cells in their frames: stress times volume by xx, yy, zz, xy, yz and zx,
/// and those of the hourglass modes.
#[derive(Clone, Copy)]
pub(super) struct Forces<S: Simd> {
    pub(super) stress: [Lanes<S>; 6],
    pub(super) hourglass: [Vector<S>; 4],
}

impl<S: Simd> Forces<S> {
    #[inline(always)]
    pub(super) fn load<G: Gather<L, S = S>, const L: usize>(
        gather: G,
        block: &CellBlock,
        first: usize,
    ) -> Self {
        let h: [Lanes<S>; 12] = load_all(gather, &block.hourglass, first);
        Self {
            stress: load_all(gather, &block.stress, first),
            hourglass: [
                [h[0], h[1], h[2]],
                [h[3], h[4], h[5]],
                [h[6], h[7], h[8]],
                [h[9], h[10], h[11]],
            ],
        }
    }

    #[inline(always)]
    pub(super) fn store<const L: usize>(&self, block: &mut CellBlock, first: usize, count: usize) {
        store_all::<S, L, 6>(&mut block.stress, first, count, self.stress);
        for h in 0..4 {
            for k in 0..3 {
                let force = self.hourglass[h][k];
                store::<S, L>(&mut block.hourglass[3 * h + k], first, count, force);
            }
        }
    }

    #[inline(always)]
    pub(super) fn scale(&mut self, by: Lanes<S>) {
        for force in &mut self.stress {
            *force = by * *force;
        }
        for force in self.hourglass.as_flattened_mut() {
            *force = by * *force;
        }
    }
}

/// Returns a symmetric matrix, given its xx, yy, zz, xy, yz and zx.
#[inline(always)]
pub(super) fn symmetric<S: Simd>(&[xx, yy, zz, xy, yz, zx]: &[Lanes<S>; 6]) -> Matrix<S> {
    [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]
}

/// Returns a number of the cells in the lanes.
#[inline(always)]
pub(super) fn load<G: Gather<L>, const L: usize>(
    gather: G,
    row: &Row,
    first: usize,
) -> Lanes<G::S> {
    let mut numbers = [0.0; L];
    numbers.copy_from_slice(&row[first..first + L]);
    Lanes::from_array(gather.simd(), numbers)
}

/// Returns several numbers of the cells in the lanes.
#[inline(always)]
pub(super) fn load_all<G: Gather<L>, const L: usize, const N: usize>(
    gather: G,
    rows: &[Row; N],
    first: usize,
) -> [Lanes<G::S>; N] {
    let mut lanes = [Lanes::splat(gather.simd(), 0.0); N];
    for i in 0..N {
        lanes[i] = load(gather, &rows[i], first);
    }
    lanes
}

/// Stores a number of the first `count` cells in the lanes.
#[inline(always)]
fn store<S: Simd, const L: usize>(row: &mut Row, first: usize, count: usize, lanes: Lanes<S>) {
    let lanes: [f32; L] = lanes.to_array();
    row[first..first + count].copy_from_slice(&lanes[..count]);
}

/// Stores several numbers of the first `count` cells in the lanes.
#[inline(always)]
pub(super) fn store_all<S: Simd, const L: usize, const N: usize>(
    rows: &mut [Row; N],
    first: usize,
    count: usize,
    lanes: [Lanes<S>; N],
) {
    for i in 0..N {
        store::<S, L>(&mut rows[i], first, count, lanes[i]);
    }
}
