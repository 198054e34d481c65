//! Completes and validates the inside of a solid that was read with serde.

use super::Interior;
use crate::error::InvalidSolver;
use incise_mesh::{Surface, VertexId};

impl Interior {
    /// Completes the inside of a surface, and validates it.
    ///
    /// # Errors
    /// [`InvalidSolver`] with the first array that does not match.
    pub(crate) fn finish_load(&mut self, surface: &Surface) -> Result<(), InvalidSolver> {
        let invalid = |array| InvalidSolver::Array { array };
        (self.lattice.finish_load(surface)).map_err(|_| invalid("lattice"))?;
        let nodes = self.lattice.node_positions.len();
        let is_vector = |v: &[f32; 4]| v.iter().all(|c| c.is_finite());
        for (array, rows) in [
            ("positions of nodes", &self.positions),
            ("velocities of nodes", &self.velocities),
            ("forces at nodes", &self.node_forces),
        ] {
            if rows.len() != nodes || !rows.iter().all(is_vector) {
                return Err(invalid(array));
            }
        }
        let is_mass = |m: &f32| m.is_finite() && *m >= 0.0;
        if self.mass.len() != nodes || !self.mass.iter().all(is_mass) {
            return Err(invalid("masses of nodes"));
        }
        let scales = [self.area_density, self.least_mass, self.mean_rest_length];
        if !scales
            .iter()
            .all(|scale| scale.is_finite() && *scale >= 0.0)
        {
            return Err(invalid("scales of a solid"));
        }
        if !self.constants.is_valid() {
            return Err(invalid("coefficients of cells"));
        }
        if !self.edits.is_valid() {
            return Err(invalid("states before edits"));
        }
        let mut pins = self.last_pins.iter().flat_map(|pin| pin.target);
        let ascending = self.last_pins.is_sorted_by(|a, b| a.vertex < b.vertex);
        if !ascending || !pins.all(f32::is_finite) {
            return Err(invalid("last pins"));
        }
        self.cells.finish_load(&self.lattice)?;
        let positions = &self.positions;
        let inverse_mass = |node: VertexId| positions[node.index()][3];
        let size = self.lattice.grid.cell_size();
        self.mean_stiff = self.cells.set_weights(inverse_mass, |_| true, size);
        let slots = 0..surface.positions().len();
        self.inverse_masses = slots.map(|slot| self.point_inverse_mass(slot)).collect();
        Ok(())
    }
}
