//! [`SavedSolver`]: the state of a solver as plain data, and files of a surface and its solver.

use super::Solver;
use crate::constraints::Constraints;
use crate::constraints::saved::SavedConstraints;
use crate::error::{InvalidSolver, LoadError};
use crate::follow::FollowState;
use crate::follow::saved::SavedFollowState;
use crate::material::Material;
use crate::particles::{Particles, Pin};
use crate::step::StepState;
use crate::step::island::Island;
use crate::step::saved::SavedStep;
use incise_mesh::{
    ArchiveError, FileKind, SavedSurface, Surface, VertexId, read_archive, write_archive,
};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// The state of a [`Solver`], as it is saved beside its surface.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SavedSolver<'a> {
    material: Material,
    mass: Cow<'a, [f32]>,
    velocities: Cow<'a, [[f32; 4]]>,
    pins: Cow<'a, [Pin]>,
    constraints: SavedConstraints<'a>,
    step: SavedStep<'a>,
    follow: SavedFollowState<'a>,
}

impl Solver {
    /// Saves the solver and its surface as a file.
    ///
    /// # Errors
    /// [`ArchiveError`] if the surface is invalid, for example after a position became infinite.
    pub fn save(&self, surface: &Surface) -> Result<Vec<u8>, ArchiveError> {
        write_archive(FileKind::Body, &(surface.to_saved()?, self.to_saved()))
    }

    /// Loads a surface and its solver from a file of [`Solver::save`].
    ///
    /// Later steps and edits give the same bits as those of the saved solver. Loading takes time in
    /// proportion to the size of the body, and with a global step that of its factorization.
    ///
    /// # Errors
    /// [`LoadError`].
    pub fn load(bytes: &[u8]) -> Result<(Surface, Self), LoadError> {
        let archive = read_archive(FileKind::Body, bytes)?;
        let (surface, solver): (SavedSurface<'_>, SavedSolver<'_>) = archive.content()?;
        let surface = surface.into_surface()?;
        let solver = Self::from_saved(solver, &surface)?;
        Ok((surface, solver))
    }

    /// Returns the state as plain data for a file.
    #[must_use]
    pub fn to_saved(&self) -> SavedSolver<'_> {
        SavedSolver {
            material: self.material,
            mass: (&self.particles.mass).into(),
            velocities: (&self.particles.velocities).into(),
            pins: (&self.particles.pins).into(),
            constraints: self.constraints.to_saved(),
            step: self.step.to_saved(),
            follow: self.follow.to_saved(),
        }
    }

    /// Returns a saved solver for its surface, which must be valid.
    ///
    /// # Errors
    /// [`InvalidSolver`] if it is not one of the surface.
    pub fn from_saved(saved: SavedSolver<'_>, surface: &Surface) -> Result<Self, InvalidSolver> {
        saved.material.check()?;
        let slots = surface.topology().vertex_slots();
        let invalid = |array| InvalidSolver::Array { array };
        let mut particles = Particles {
            mass: saved.mass.into_owned(),
            velocities: saved.velocities.into_owned(),
            pins: saved.pins.into_owned(),
        };
        if let Some(array) = particles.find_invalid(surface) {
            return Err(invalid(array));
        }
        let mut constraints = Constraints::from_saved(saved.constraints, surface, &saved.material)?;
        let step = StepState::from_saved(saved.step, &constraints, slots)?;
        let follow = FollowState::from_saved(saved.follow, slots);
        let mut follow = follow.ok_or(invalid("states before edits"))?;
        let vertices = crate::constraints::batches::edit_reserve(slots);
        particles.reserve(vertices);
        constraints.reserve(vertices);
        follow.reserve(slots, vertices);
        Ok(Self {
            material: saved.material,
            particles,
            constraints,
            step,
            follow,
            island: Island::default(),
        })
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
        let is_velocity = |v: &[f32; 4]| v[3] == 0.0 && v.iter().all(|c| c.is_finite());
        let is_pin = |pin: &Pin| is_used(pin.vertex) && pin.target.iter().all(|c| c.is_finite());
        if self.mass.len() != slots || !self.mass.iter().enumerate().all(is_mass) {
            return Some("masses");
        }
        if self.velocities.len() != slots || !self.velocities.iter().all(is_velocity) {
            return Some("velocities");
        }
        let ascending = self.pins.is_sorted_by(|a, b| a.vertex < b.vertex);
        (!ascending || !self.pins.iter().all(is_pin)).then_some("pins")
    }
}
