//! The inside of a solid: elastic energy, lattice, and edits of its surface.

use super::Solver;
use incise_lattice::Lattice;
use incise_mesh::Surface;

impl Solver {
    /// Returns whether the body has an inside, whose nodes are its particles.
    #[must_use]
    pub fn is_solid(&self) -> bool {
        self.constraints.interior.is_some()
    }

    /// Returns the lattice of a solid.
    #[must_use]
    pub fn lattice(&self) -> Option<&Lattice> {
        let interior = self.constraints.interior.as_ref()?;
        Some(&interior.lattice)
    }

    /// Returns the positions of the nodes of a solid \[m\] and their inverse masses [1/kg], shape
    /// \[nodes\]; empty for other bodies.
    #[must_use]
    pub fn nodes(&self) -> &[[f32; 4]] {
        let interior = self.constraints.interior.as_ref();
        interior.map_or(&[], |interior| &interior.positions)
    }

    /// Returns the elastic energy of a solid at the end of the last step \[J\], 0 for other bodies.
    #[must_use]
    pub fn elastic_energy(&self) -> f64 {
        match (&self.constraints.interior, &self.material.solid) {
            (Some(interior), Some(solid)) => interior.elastic_energy(solid),
            _ => 0.0,
        }
    }

    /// Moves the nodes of a solid after the caller has set positions or velocities of vertices.
    pub(crate) fn adopt_edits(&mut self, surface: &mut Surface) {
        let Some(interior) = &mut self.constraints.interior else {
            return;
        };
        let is_moved = interior.is_edited(surface);
        if is_moved {
            interior.adopt_positions(surface);
        }
        let velocities = &mut self.particles.velocities;
        if interior.has_new_velocities {
            interior.adopt_velocities(velocities);
        }
        if is_moved {
            interior.embed(surface, velocities);
        }
        interior.begin_pins(&self.particles.pins);
    }

    /// Writes the positions and velocities of the vertices of a solid.
    pub(crate) fn embed(&mut self, surface: &mut Surface) {
        if let Some(interior) = &mut self.constraints.interior {
            interior.embed(surface, &mut self.particles.velocities);
        }
    }
}
