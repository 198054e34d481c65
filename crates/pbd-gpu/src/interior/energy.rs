//! Elastic energy and momenta of a solid.

use super::{Interior, stiffness};
use crate::constraints::cells::{CELLS_PER_BLOCK, CellBlock};
use crate::material::Solid;

impl Interior {
    /// Returns the elastic energy that the forces of the last substep hold \[J\].
    pub(crate) fn elastic_energy(&self, solid: &Solid) -> f64 {
        let stiffness = stiffness(solid, self.lattice.grid.cell_size());
        let cells = self.cells.iter();
        cells
            .map(|(block, lane)| cell_energy(block, lane, stiffness))
            .sum()
    }
}

/// Returns the energy of a cell \[J\].
fn cell_energy(block: &CellBlock, lane: usize, [shape, volume, bending]: [f64; 3]) -> f64 {
    let number = |row: &[f32; CELLS_PER_BLOCK]| f64::from(row[lane]);
    let fraction = number(&block.fraction);
    let stress = block.stress.each_ref().map(number);
    let trace: f64 = stress[..3].iter().sum();
    let squares: f64 = stress[..3].iter().map(|s| s * s).sum();
    let shears: f64 = stress[3..].iter().map(|s| s * s).sum();
    let squares = squares + 2.0 * shears;
    let mean = trace * trace / 3.0;
    let of_strain = (squares - mean).max(0.0) / shape + mean / volume;
    let of_bending: f64 = block
        .hourglass
        .chunks_exact(3)
        .zip(&block.bending)
        .map(|(force, bending)| {
            let square: f64 = force.iter().map(|row| number(row) * number(row)).sum();
            square / number(bending)
        })
        .sum();
    0.5 * (of_strain + of_bending / bending) / fraction
}
