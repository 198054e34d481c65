//! Checks the inside of a solid against its surface.

use super::Interior;
use crate::error::InvalidConstraints;
use incise_mesh::Surface;

/// Distance of a vertex at rest from where the lattice places it, beyond rounding [cells].
const TOLERANCE: f64 = 1e-4;

impl Interior {
    /// Checks that cells have nodes with masses, and that each vertex lies in a cell at its rest
    /// position.
    pub(crate) fn validate(&self, surface: &Surface) -> Result<(), InvalidConstraints> {
        let broken = |rule| Err(InvalidConstraints { rule, edge: None });
        let lattice = &self.lattice;
        let copies = (0..)
            .zip(&lattice.nodes)
            .filter(|&(copy, _)| lattice.is_copy(copy));
        for node in copies.flat_map(|(_, nodes)| nodes) {
            let mass = self.mass.get(*node as usize);
            if !lattice.is_node(*node) || mass.is_none_or(|&mass| mass <= 0.0) {
                return broken("nodes of cells have a mass");
            }
        }
        for v in surface.topology().vertices() {
            let copy = lattice.vertex_copies.get(v.index());
            if !copy.is_some_and(|&copy| lattice.is_copy(copy)) {
                return broken("vertices lie in cells");
            }
            let off =
                lattice.embedded(v.index(), &lattice.node_positions) - surface.rest_position(v);
            if off.norm() > TOLERANCE * lattice.grid.cell_size() {
                return broken("vertices at rest are where the lattice places them");
            }
        }
        Ok(())
    }
}
