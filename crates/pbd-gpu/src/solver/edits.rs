//! Updates of a solver after an edit of its surface, and the change log of the GPU backend.

use super::Solver;
use crate::error::ConstraintError;
use crate::follow::delta;
use incise_mesh::{Surface, TopologyDelta};
use std::num::NonZeroUsize;

#[cfg(any(test, feature = "gpu"))]
use crate::follow::changes::Changes;

impl Solver {
    /// Updates constraints, mass, velocities and pins after an edit of the surface.
    ///
    /// Deleted edges lose their constraints and new edges get theirs, with rest values from rest
    /// positions; other constraints and colors stay. New vertices interpolate their velocity from
    /// their [origin](incise_mesh::VertexOrigin). Contacts are removed. O(k log k) for k changed
    /// triangles.
    ///
    /// **Mass and momentum.** The corners of changed triangles share the mass that they and deleted
    /// vertices had, by rest area, within each new piece. The affected vertices of what was one
    /// piece before keep their mass, center of mass, momentum and angular momentum to rounding:
    /// shares are tilted, and unpinned vertices get a rigid motion in addition. Where new vertices
    /// do not surround the old center, for example after a corner is removed, angular momentum is
    /// preserved about the center of mass only. Vertices on a line take no spin about it. The
    /// correction of a velocity is bounded by four times the highest speed before the edit, along
    /// and about each of three axes.
    ///
    /// **Undo.** The delta of an undo is applied like any other. If nothing has moved since the
    /// edit, masses and velocities are restored bit for bit. Otherwise restored vertices get the
    /// velocities of their replacements; call [`Solver::join_after_undo`] to join pieces that have
    /// moved apart. Pins of deleted vertices return with the vertices, except for vertices that an
    /// edit created.
    ///
    /// Edges without rest length are accepted, unlike in [`Solver::new`], because a cut may pass
    /// through any point.
    ///
    /// # Errors
    /// [`ConstraintError`] if the delta does not match the solver or the surface, or a new vertex
    /// is not finite; nothing is changed then.
    pub fn apply_delta(
        &mut self,
        surface: &mut Surface,
        delta: &TopologyDelta,
    ) -> Result<(), ConstraintError> {
        self.follow_delta(surface, delta, Some(NonZeroUsize::MIN))?;
        self.finish_delta(surface, delta);
        Ok(())
    }

    /// Updates particles and constraints after an edit, without writing to the surface.
    ///
    /// [`Self::finish_delta`] must follow; both together are [`Self::apply_delta`]. The
    /// surface is only read, so that a BVH can be updated in parallel. `threads` limits the threads
    /// of a large edit: `None` allows the current rayon pool, and one uses no pool. Results do not
    /// depend on it.
    ///
    /// # Errors
    /// As [`Self::apply_delta`].
    pub fn follow_delta(
        &mut self,
        surface: &Surface,
        delta: &TopologyDelta,
        threads: Option<NonZeroUsize>,
    ) -> Result<(), ConstraintError> {
        let (particles, constraints) = (&mut self.particles, &mut self.constraints);
        match &constraints.interior {
            Some(_) => {
                delta::check_added(surface, delta)?;
                (self.follow).apply_solid_delta(particles, surface, delta);
                constraints.resize_vertices(surface.topology().vertex_slots());
            }
            None => {
                delta::check(&constraints.edges, surface, delta)?;
                (self.follow).apply_delta(particles, constraints, surface, delta, threads);
            }
        }
        self.constraints.update_volumes(surface, &self.material);
        self.constraints.pieces.invalidate();
        self.constraints.contacts.clear();
        self.constraints.attachments.invalidate();
        self.step.plan.invalidate();
        Ok(())
    }

    /// Writes to the surface what an edit changed: inverse masses, and in a solid the positions and
    /// rest positions of new vertices.
    ///
    /// The rest position of a new vertex of a solid becomes that from which its lattice places the
    /// vertex where it is.
    pub fn finish_delta(&mut self, surface: &mut Surface, delta: &TopologyDelta) {
        match &mut self.constraints.interior {
            Some(interior) => {
                interior.set_rest_positions(surface, delta);
                let density = interior.area_density();
                (self.follow).share_masses(&mut self.particles, surface, density);
                let velocities = &mut self.particles.velocities;
                self.follow.is_late_undo = interior.follow(surface, velocities, delta);
            }
            None => (self.follow).write_inverse_masses(&self.particles, surface),
        }
    }

    /// Declares that the caller has changed positions in the surface.
    ///
    /// The GPU backend uploads the whole body before its next frame. Calls on the solver itself do
    /// not need it.
    pub fn mark_all_changed(&mut self) {
        self.follow.log.mark_all();
    }

    /// Moves the changes since the last call into `into`; the first call starts the log.
    #[cfg(any(test, feature = "gpu"))]
    pub(crate) fn take_changes(&mut self, into: &mut Changes) {
        let slots = self.particles.len();
        (self.follow.log).take(&mut self.constraints, slots, into);
    }

    /// Returns true if changes are logged, which is not so in a new solver or a clone.
    #[cfg(test)]
    pub(crate) fn is_tracking(&self) -> bool {
        self.follow.log.is_on()
    }

    /// Returns the allocated size of the log of velocities.
    #[cfg(test)]
    pub(crate) fn logged_velocity_capacity(&self) -> usize {
        self.follow.log.velocity_capacity()
    }
}

#[cfg(feature = "gpu")]
impl Solver {
    /// Returns true if the change log is read by `follower`. A clone has none.
    pub(crate) fn is_followed_by(&self, follower: u64) -> bool {
        self.follow.log.follower == follower
    }

    /// Makes a nonzero `follower` the reader of the change log, starting with everything.
    pub(crate) fn set_follower(&mut self, follower: u64) {
        self.follow.log.follower = follower;
        self.mark_all_changed();
    }

    /// Returns true if nothing was changed since the last [`Solver::take_changes`].
    pub(crate) fn is_unchanged(&self) -> bool {
        self.follow.log.is_empty(&self.constraints)
    }

    /// Returns true if positions or constraints were changed since the last
    /// [`Solver::take_changes`].
    pub(crate) fn has_surface_changes(&self) -> bool {
        self.follow.log.has_surface_changes(&self.constraints)
    }

    /// Marks the pins as changed.
    pub(crate) fn mark_pins_changed(&mut self) {
        self.follow.log.mark_pins();
    }

    /// Returns the velocities that were set since the last [`Solver::take_changes`] [m/s].
    pub(crate) fn changed_velocities(&self) -> Vec<(usize, [f32; 4])> {
        let velocities = &self.particles.velocities;
        let vertices = self.follow.log.changed_velocities().iter();
        vertices
            .filter_map(|&v| Some((v as usize, *velocities.get(v as usize)?)))
            .collect()
    }
}
