//! The inside of a solid: elastic energy, lattice, and edits of its surface.

use super::Solver;
#[cfg(feature = "gpu")]
use crate::interior::Interior;
use crate::interior::SolidState;
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

    /// Returns the positions, velocities and forces of the inside of a solid; `None` for other
    /// bodies.
    #[must_use]
    pub fn solid_state(&self) -> Option<SolidState> {
        let interior = self.constraints.interior.as_ref()?;
        Some(interior.state())
    }

    /// Restores a state of the inside of a solid, and places its vertices.
    ///
    /// Returns false, and changes nothing, if the body has other cells than those of the state: it
    /// was cut since, and the cut was not undone.
    pub fn set_solid_state(&mut self, surface: &mut Surface, state: &SolidState) -> bool {
        let Some(interior) = &mut self.constraints.interior else {
            return false;
        };
        let velocities = &mut self.particles.velocities;
        let is_set = interior.set_state(surface, velocities, state);
        self.mark_all_changed();
        is_set
    }

    /// Moves the nodes of a solid after the caller has set positions or velocities of vertices, and
    /// embeds the vertices in them.
    ///
    /// A step does so by itself. Call it before an edit of the surface, which reads the nodes.
    pub fn adopt_edits(&mut self, surface: &mut Surface) {
        if self.adopt_motion(surface) {
            self.embed(surface);
            self.mark_all_changed();
        }
    }

    /// Moves the nodes of a solid after the caller has set positions or velocities of vertices.
    ///
    /// Returns whether positions were set. The vertices keep them until they are
    /// [embedded](Self::embed) again.
    pub(crate) fn adopt_motion(&mut self, surface: &Surface) -> bool {
        let Some(interior) = &mut self.constraints.interior else {
            return false;
        };
        let is_moved = interior.is_edited(surface);
        if is_moved {
            interior.adopt_positions(surface);
            interior.note_embedded(surface);
        }
        if interior.has_new_velocities {
            interior.adopt_velocities(&self.particles.velocities);
        }
        is_moved
    }

    /// Begins a frame of a solid, whose pins move from their last targets.
    pub(crate) fn begin_pins(&mut self) {
        if let Some(interior) = &mut self.constraints.interior {
            interior.begin_pins(&self.particles.pins);
        }
    }

    /// Returns the inside of a solid.
    #[cfg(feature = "gpu")]
    pub(crate) fn interior(&self) -> Option<&Interior> {
        self.constraints.interior.as_deref()
    }

    /// Returns the inside of a solid for the readback from a GPU, which the log does not record.
    #[cfg(feature = "gpu")]
    pub(crate) fn interior_mut(&mut self) -> Option<&mut Interior> {
        self.constraints.interior.as_deref_mut()
    }

    /// Writes the positions and velocities of the vertices of a solid.
    pub(crate) fn embed(&mut self, surface: &mut Surface) {
        if let Some(interior) = &mut self.constraints.interior {
            interior.embed(surface, &mut self.particles.velocities);
        }
    }
}
