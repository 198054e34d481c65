//! Files of a surface and its solver, and the completion of a loaded solver.

use super::Solver;
use crate::error::{InvalidSolver, LoadError};
use crate::particles::{Particles, Pin};
use incise_mesh::{ArchiveError, FileKind, Surface, VertexId, read_archive, write_archive};

impl Solver {
    /// Saves the solver and its surface as a file.
    ///
    /// # Errors
    /// [`ArchiveError`] if the surface is invalid, for example after a position became infinite.
    pub fn save(&self, surface: &Surface) -> Result<Vec<u8>, ArchiveError> {
        surface.check_save()?;
        write_archive(FileKind::Body, &(surface, self))
    }

    /// Loads a surface and its solver from a file of [`Solver::save`].
    ///
    /// Later steps and edits give the same bits as those of the saved solver. Loading takes time in
    /// proportion to the size of the body.
    ///
    /// # Errors
    /// [`LoadError`].
    pub fn load(bytes: &[u8]) -> Result<(Surface, Self), LoadError> {
        let archive = read_archive(FileKind::Body, bytes)?;
        let (mut surface, mut solver): (Surface, Self) = archive.content()?;
        surface.finish_load()?;
        solver.finish_load(&surface)?;
        Ok((surface, solver))
    }

    /// Completes and validates a solver that was read with serde, for its valid surface.
    ///
    /// # Errors
    /// [`InvalidSolver`] if it is not one of the surface.
    pub fn finish_load(&mut self, surface: &Surface) -> Result<(), InvalidSolver> {
        self.material.check()?;
        let slots = surface.topology().vertex_slots();
        if let Some(array) = self.particles.find_invalid(surface) {
            return Err(InvalidSolver::Array { array });
        }
        self.constraints.finish_load(surface, &self.material)?;
        self.step.finish_load(&self.constraints, slots)?;
        self.follow.validate(slots)?;
        let vertices = crate::constraints::batches::edit_reserve(slots);
        self.particles.reserve(vertices);
        self.constraints.reserve(vertices);
        self.follow.reserve(slots, vertices);
        Ok(())
    }
}

impl Particles {
    /// Returns the name of an array that does not fit a surface or has a number out of range.
    fn find_invalid(&self, surface: &Surface) -> Option<&'static str> {
        let slots = surface.topology().vertex_slots();
        let is_used = |v: VertexId| !surface.topology().outgoing(v).is_null();
        let is_mass = |(i, mass): (usize, &f32)| {
            mass.is_finite() && (*mass == 0.0 || *mass > 0.0 && is_used(VertexId::from_index(i)))
        };
        let is_vector = |v: &[f32; 4]| v[3] == 0.0 && v.iter().all(|c| c.is_finite());
        let is_pin = |pin: &Pin| is_used(pin.vertex) && pin.target.iter().all(|c| c.is_finite());
        if self.mass.len() != slots || !self.mass.iter().enumerate().all(is_mass) {
            return Some("masses");
        }
        for (name, vectors) in [
            ("velocities", &self.velocities),
            ("corrections", &self.corrections),
        ] {
            if vectors.len() != slots || !vectors.iter().all(is_vector) {
                return Some(name);
            }
        }
        let ascending = self.pins.is_sorted_by(|a, b| a.vertex < b.vertex);
        (!ascending || !self.pins.iter().all(is_pin)).then_some("pins")
    }
}
