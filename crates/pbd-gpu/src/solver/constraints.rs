//! Constraints of a solver: access, stiffness, interior springs, contacts, colliders and volumes.

use super::Solver;
use crate::constraints::Constraints;
use crate::constraints::attachments::LongRangeAttachment;
use crate::constraints::batches::{BendingSet, StretchSet};
use crate::constraints::colliders::MovingCollider;
use crate::constraints::contacts::{Contact, ContactSet};
use crate::constraints::volumes::VolumeSet;
use crate::error::{ConstraintError, InvalidConstraints};
use crate::material::{InteriorSprings, Material, Stiffness, Volume};
use crate::parallel::passes::CELL_WORK;
use crate::step::guard::EnergyBudget;
use crate::step::pass::Pass;
use incise_mesh::{Surface, VertexId};

impl Solver {
    /// Returns the stretch constraints.
    #[must_use]
    pub fn stretch(&self) -> &StretchSet {
        &self.constraints.stretch
    }

    /// Returns the bending constraints, if the material has bending.
    #[must_use]
    pub fn bending(&self) -> Option<&BendingSet> {
        self.constraints.bending.as_ref()
    }

    /// Returns the interior springs, if the material has them.
    ///
    /// The first vertex of a spring is the one that [`Solver::add_interior_springs`] was given
    /// first.
    #[must_use]
    pub fn interior_springs(&self) -> Option<&StretchSet> {
        self.constraints.interior_springs.as_ref()
    }

    /// Returns the number of edges, hinges and interior springs that a sweep projects.
    ///
    /// A cell of a solid counts as 16, whose work it takes.
    #[must_use]
    pub fn constraint_count(&self) -> usize {
        let bending = self.bending().map_or(0, |set| set.len());
        let springs = self.interior_springs().map_or(0, |set| set.len());
        let interior = self.constraints.interior.as_ref();
        let cells = interior.map_or(0, |interior| interior.cells.len());
        self.stretch().len() + bending + springs + CELL_WORK * cells
    }

    /// Returns the volume constraints; the set is empty unless the material has volume.
    #[must_use]
    pub fn volumes(&self) -> &VolumeSet {
        &self.constraints.volumes
    }

    /// Returns the long range attachments of the last step.
    ///
    /// The list is empty unless [`SolverParams::attachments`](crate::SolverParams::attachments) was
    /// set, edges are rigid and there are pins.
    #[must_use]
    pub fn attachments(&self) -> &[LongRangeAttachment] {
        if self.step.plan.iteration().first() == Some(&Pass::LongRangeAttachments) {
            self.constraints.attachments.list()
        } else {
            &[]
        }
    }

    /// Returns the contacts for the results of a GPU.
    #[cfg(feature = "gpu")]
    pub(crate) fn contacts_mut(&mut self) -> &mut ContactSet {
        &mut self.constraints.contacts
    }

    /// Returns the contacts of the next frame.
    #[must_use]
    pub fn contacts(&self) -> &ContactSet {
        &self.constraints.contacts
    }

    /// Returns the colliders of the next frame.
    #[must_use]
    pub fn colliders(&self) -> &[MovingCollider] {
        self.constraints.colliders.list()
    }

    /// Returns all constraints.
    #[cfg_attr(
        not(any(test, feature = "gpu")),
        expect(dead_code, reason = "read by the GPU backend")
    )]
    pub(crate) fn constraints(&self) -> &Constraints {
        &self.constraints
    }

    /// Changes the stiffness of edges from the next frame on.
    ///
    /// # Errors
    /// [`ConstraintError`] if the number is out of range; nothing is changed then.
    pub fn set_stretch(&mut self, stiffness: Stiffness) -> Result<(), ConstraintError> {
        self.replace_material(Material {
            stretch: stiffness,
            ..self.material
        })
    }

    /// Changes [`Material::damping`] [1/s] from the next frame on.
    ///
    /// # Errors
    /// [`ConstraintError`] if the number is out of range; nothing is changed then.
    pub fn set_damping(&mut self, damping: f32) -> Result<(), ConstraintError> {
        self.replace_material(Material {
            damping,
            ..self.material
        })
    }

    /// Changes the stiffness of interior springs from the next frame on.
    ///
    /// # Errors
    /// [`ConstraintError`] if a number is out of range or the material has no interior springs;
    /// nothing is changed then.
    pub fn set_interior_springs(
        &mut self,
        interior_springs: InteriorSprings,
    ) -> Result<(), ConstraintError> {
        let material = Material {
            interior_springs: Some(interior_springs),
            ..self.material
        };
        material.check()?;
        if self.constraints.interior_springs.is_none() {
            return Err(ConstraintError::NoInteriorSprings);
        }
        self.material = material;
        Ok(())
    }

    /// Changes, adds or removes the resistance to volume changes from the next frame on.
    ///
    /// # Errors
    /// [`ConstraintError`] if a number is out of range; nothing is changed then.
    pub fn set_volume(
        &mut self,
        surface: &Surface,
        volume: Option<Volume>,
    ) -> Result<(), ConstraintError> {
        self.check_surface(surface)?;
        let before = self.material.volume;
        self.replace_material(Material {
            volume,
            ..self.material
        })?;
        if before.is_some() != volume.is_some() {
            self.constraints.update_volumes(surface, &self.material);
            self.step.plan.invalidate();
            self.follow.log.mark_all();
        }
        Ok(())
    }

    /// Changes the material from the next frame on.
    ///
    /// The density is fixed. Volume constraints can be added and removed; bending and interior
    /// springs cannot, because their constraints are created with the body.
    ///
    /// # Errors
    /// [`ConstraintError`] if a number is out of range, and [`ConstraintError::FixedMaterial`];
    /// nothing is changed then.
    pub fn set_material(
        &mut self,
        surface: &Surface,
        material: &Material,
    ) -> Result<(), ConstraintError> {
        let old = self.material;
        let kinds = |of: &Material| (of.bending.is_some(), of.interior_springs.is_some());
        let ((bends, springs), (bent, sprung)) = (kinds(material), kinds(&old));
        let cells = |of: &Material| of.solid.map(|solid| (solid.cell_size, solid.cells_across));
        for (name, is_kept) in [
            ("density", material.density == old.density),
            ("bending", bends == bent),
            ("interior springs", springs == sprung),
            ("cells of a solid", cells(material) == cells(&old)),
        ] {
            if !is_kept {
                return Err(ConstraintError::FixedMaterial { name });
            }
        }
        material.check()?;
        self.set_volume(surface, material.volume)?;
        self.replace_material(*material)
    }

    fn replace_material(&mut self, material: Material) -> Result<(), ConstraintError> {
        material.check()?;
        if self.material != material {
            self.material = material;
            // Constraints hold another energy.
            self.step.budget = EnergyBudget::default();
        }
        Ok(())
    }

    /// Sets the contacts of the next frames in place of the current ones. An edit removes all.
    ///
    /// # Errors
    /// [`ConstraintError::UnknownVertex`]; [`ConstraintError::BadContact`] for repeated vertices, a
    /// normal that is not of length 1, or numbers out of range. Nothing is changed then.
    pub fn set_contacts(&mut self, contacts: &[Contact]) -> Result<(), ConstraintError> {
        for contact in contacts {
            contact.check(|v| self.particles.is_used(v))?;
        }
        let set = &mut self.constraints.contacts;
        if !(contacts.is_empty() && set.is_empty()) {
            set.set(contacts, self.particles.len());
        }
        Ok(())
    }

    /// Sets the colliders of the next frames in place of the current ones.
    ///
    /// They cost one pass over the vertices per iteration, and nothing if there are none. Every
    /// frame starts with them at their start: set moving ones in every frame.
    ///
    /// # Errors
    /// [`ConstraintError::BadCollider`] with the index of an invalid one; nothing is changed then.
    pub fn set_colliders(&mut self, colliders: &[MovingCollider]) -> Result<(), ConstraintError> {
        self.constraints.colliders.set(colliders)
    }

    /// Adds interior springs from the first to the second vertex; returns the number added.
    ///
    /// Springs between pieces, from a vertex to itself, or without rest length are skipped.
    ///
    /// # Errors
    /// [`ConstraintError::NoInteriorSprings`] if the material has none,
    /// [`ConstraintError::UnknownVertex`]; nothing is changed then.
    pub fn add_interior_springs(
        &mut self,
        surface: &Surface,
        ends: &[[VertexId; 2]],
    ) -> Result<usize, ConstraintError> {
        self.check_surface(surface)?;
        let mut vertices = ends.iter().flatten().copied();
        if let Some(vertex) = vertices.find(|&v| !self.particles.is_used(v)) {
            return Err(ConstraintError::UnknownVertex { vertex });
        }
        let added = self.constraints.add_interior_springs(surface, ends)?;
        self.step.plan.invalidate();
        Ok(added)
    }

    /// Removes the interior springs with the given ends, for example after a cut.
    ///
    /// Appends the first vertex of every removed spring to `removed_from`.
    pub fn remove_interior_springs(
        &mut self,
        is_removed: impl FnMut([VertexId; 2]) -> bool,
        removed_from: &mut Vec<VertexId>,
    ) {
        if (self.constraints).remove_interior_springs(is_removed, removed_from) {
            self.step.plan.invalidate();
        }
    }

    /// Returns the surviving first vertices of the interior springs that the last edit removed.
    ///
    /// A vertex appears once for each of its springs.
    #[must_use]
    pub fn lost_interior_springs(&self) -> &[VertexId] {
        self.follow.lost_interior_springs()
    }

    /// Compares all constraints with those of a solver built from scratch. O(n log n).
    ///
    /// Tests call it after every edit. It checks vertices, rest values and slots of constraints,
    /// the coloring, volumes, interior springs and patches.
    ///
    /// # Errors
    /// The first broken rule and its edge.
    pub fn validate(&self, surface: &Surface) -> Result<(), InvalidConstraints> {
        let has_volumes = self.material.volume.is_some();
        self.constraints.validate(surface, has_volumes)
    }
}
