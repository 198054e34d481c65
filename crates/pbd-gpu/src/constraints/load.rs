//! Completes and validates loaded [`Constraints`].
//!
//! Attachments, the copies of constraints by patch, color masks and multipliers of a substep follow
//! from the saved ones.

use super::Constraints;
use super::coloring::LAYERS;
use super::interior_springs::is_inside;
use super::validate::{broken, check_layers};
use crate::error::{InvalidConstraints, InvalidSolver};
use crate::material::Material;
use incise_mesh::{Surface, VertexId};

impl Constraints {
    /// Completes constraints that were read with serde, of their surface.
    ///
    /// # Errors
    /// [`InvalidSolver`] with the first part that does not match the surface or the material.
    pub(crate) fn finish_load(
        &mut self,
        surface: &Surface,
        material: &Material,
    ) -> Result<(), InvalidSolver> {
        let topology = surface.topology();
        let slots = topology.vertex_slots();
        let layers = if self.patches.is_some() { LAYERS } else { 1 };
        self.stretch.finish_load(slots, layers)?;
        if let Some(bending) = &mut self.bending {
            bending.finish_load(slots, layers)?;
        }
        if let Some(springs) = &mut self.interior_springs {
            springs.finish_load(slots, 1)?;
        }
        let bending = self.bending.as_ref();
        if let Some(interior) = &mut self.interior {
            interior.finish_load(surface)?;
        } else {
            self.edges.finish_load(topology, &self.stretch, bending)?;
        }
        if let Some(patches) = &mut self.patches {
            let done = patches.finish_load(surface);
            done.map_err(|rule| InvalidConstraints { rule, edge: None })?;
        }
        check_layers(&self.stretch, self.patches.as_ref())?;
        if let Some(bending) = &self.bending {
            check_layers(bending, self.patches.as_ref())?;
        }
        self.volumes.finish_load(surface)?;
        let is_used = |v: VertexId| !topology.outgoing(v).is_null();
        self.contacts.finish_load(slots, is_used)?;
        self.colliders.finish_load()?;
        self.check_kinds(surface, material)?;
        Ok(())
    }

    /// Checks that the kinds of constraints are those of the material.
    fn check_kinds(&self, surface: &Surface, of: &Material) -> Result<(), InvalidConstraints> {
        if self.interior.is_some() != of.solid.is_some() {
            return broken("a solid has an inside", None);
        }
        if of.solid.is_some() {
            return self.check_surface_is_free();
        }
        if self.bending.is_some() != of.bending.is_some()
            || self.interior_springs.is_some() != of.interior_springs.is_some()
            || !(self.volumes.pieces.is_empty() || of.volume.is_some())
        {
            return broken("constraints are of the kinds of the material", None);
        }
        let mut springs = self.interior_springs.iter().flat_map(|set| set.all());
        let is_spring = |ends: &[VertexId; 2]| ends[0] != ends[1] && is_inside(surface, *ends);
        if springs.all(|batch| batch.vertices().iter().all(is_spring)) {
            Ok(())
        } else {
            broken("interior springs lie within a piece", None)
        }
    }
}
